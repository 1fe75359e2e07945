// Where edges are found.
#include "curbline/borders/border_finder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::small_limits;
using test::small_settings;
using test::Stages;

/// Borders between two planes, and at ends of ground, as the laser sees the map from x = 0.
struct FoundBorders {
  int between_planes = 0, one_sided = 0;
};
FoundBorders found_borders(Stages<small_limits>& stages) {
  const CurbSettings settings{};
  auto& borders = stages.work.curbs().borders;
  borders.clear();
  BorderFinder<small_limits>({stages.dem, stages.mixture, stages.field, stages.view, stages.latency, settings})
      .find(borders, stages.counters);
  FoundBorders found;
  for (int b = 0; b < borders.size(); ++b) {
    if (borders.chained(b)) continue;
    const int length = borders.chain(stages.dem, b, settings.link_reach);
    for (int k = 0; k < length; ++k) ++(borders.at(k).other == no_label ? found.one_sided : found.between_planes);
  }
  return found;
}

/// The only curb of ground that falls by `drop` from x = `from` to `to`, seen from x = 0 one metre up. Between them
/// there are points only if face_seen; `mixed` readings of both, half as high, lie 3 cm beyond `from`.
Curb curb_of(double drop, double from, double to, bool face_seen, int mixed = 0) {
  auto stages = std::make_unique<Stages<small_limits>>(small_settings());
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) {
      for (const double at : {0.01, 0.03, 0.05, 0.07, 0.09}) {
        const double x = 0.1 * i + at, y = 0.1 * j + at;
        if (x > from && x < to && !face_seen) continue;
        const double fallen = x < from ? 0 : x >= to ? 1 : (x - from) / (to - from);
        stages->dem.add({static_cast<float>(x), static_cast<float>(y), static_cast<float>(drop * (1 - fallen)), 1e-4f});
      }
    }
  }
  for (int reading = 0; reading < 24 * mixed; ++reading) {
    const double y = (reading + 0.5) / (10.0 * mixed);
    stages->dem.add({static_cast<float>(from + 0.03), static_cast<float>(y), static_cast<float>(0.5 * drop), 1e-4f});
  }
  stages->settle();
  stages->trace(0.0f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb curb = stages->tracer.curbs()[0];
  CHECK(curb.kind == CurbKind::step_down);
  CHECK(curb.x1_m == Approx(curb.x0_m).margin(0.01));
  return curb;
}

//  ______________
//                |               seen from a laser 1 m above: the step is 12 cm high, the shadow 14 % of the distance
//                |  shadow
//                '.......________
TEST_CASE("border finder: a step down lies before its shadow, wherever cells part it") {
  for (const double edge : {1.2, 1.24, 1.26, 1.3}) {
    const Curb curb = curb_of(0.12, edge, edge + 0.12 * edge / 0.88, false);
    CHECK(curb.x0_m == Approx(edge).margin(0.012));
    CHECK(curb.face_width_m < 0.05f);
  }
}

TEST_CASE("border finder: readings that mix the edge of a step down with what is behind it are no face") {
  for (const double edge : {1.26, 2.02}) {
    for (const int mixed : {2, 4})
      CHECK(curb_of(0.12, edge, edge + 0.12 * edge / 0.88, false, mixed).x0_m == Approx(edge).margin(0.03));
  }
}

TEST_CASE("border finder: a sloped face that is seen is told half its shadow before its middle, on the face") {
  for (const double from : {0.55, 0.57, 0.60}) {
    const Curb curb = curb_of(0.06, from, from + 0.1, true);
    CHECK(curb.x0_m == Approx(from + 0.05 - 0.5 * 0.06 * 0.6 / 0.94).margin(0.012));
    CHECK(curb.x0_m > from);
  }
}

/// A street up to the start of a face that rises by `slope` a metre; nothing is seen beyond `to`. It runs along x, away
/// from the laser, unless it is turned to run along y, from the window's other end.
struct Street {
  double slope = 0.4, from = 1.2, to = 1.5, top = 9.0;  ///< level again from `top` on
  bool turned = false;
  float laser_x_m = 0.0f, laser_z_m = 1.0f;
  double waver = 0.0;        ///< every other half metre ends earlier by this much
  double unseen_from = 9.0;  ///< a cell that begins there shows nothing

  double height(double x) const { return slope * (std::clamp(x, from, top) - from); }
  std::unique_ptr<Stages<small_limits>> traced() const {
    auto stages = std::make_unique<Stages<small_limits>>(small_settings());
    for (int i = 0; i < 24; ++i) {
      for (int j = 0; j < 24; ++j) {
        for (const double at : {0.01, 0.03, 0.05, 0.07, 0.09}) {
          const double x = 0.1 * i + at, y = 0.1 * j + at, along = turned ? 2.4 - y : x;
          const bool early = std::fmod(turned ? x : y, 1.0) < 0.5;
          if (along > (early ? to - waver : to) || (along > unseen_from && along < unseen_from + 0.1)) continue;
          stages->dem.add({static_cast<float>(x), static_cast<float>(y), static_cast<float>(height(along)), 1e-4f});
        }
      }
    }
    stages->view = turned ? Viewpoint{1.2f, 2.4f - laser_x_m, laser_z_m} : Viewpoint{laser_x_m, 1.2f, laser_z_m};
    stages->settle();
    stages->trace(stages->view.x_m, stages->view.y_m);
    return stages;
  }
  /// A curb across the street, and its distance along the street.
  struct Across {
    double at;
    Curb curb;
  };
  /// The curbs with no ground in view beyond them.
  std::vector<Across> one_sided() const {
    const auto stages = traced();
    std::vector<Across> found;
    for (const Curb& curb : stages->tracer.curbs()) {
      constexpr auto unseen = no_label;
      if (curb.far_label != unseen && curb.near_label != unseen) continue;
      CHECK(curb.face_width_m == 0.0f);
      CHECK(curb.probability > 0.9f);
      CHECK(std::hypot(curb.x1_m - curb.x0_m, curb.y1_m - curb.y0_m) == Approx(2.4).margin(0.02));
      const double at = turned ? 2.4 - static_cast<double>(curb.y0_m) : static_cast<double>(curb.x0_m);
      const int before = static_cast<int>(10 * at - 0.5);
      CHECK(curb.near_label == (turned ? stages->label_at(0, 23 - before) : stages->label_at(before, 0)));
      found.push_back({at, curb});
    }
    return found;
  }
  /// The places where faces end.
  std::vector<double> ends() const {
    std::vector<double> found;
    for (const Across& end : one_sided()) {
      CHECK(end.curb.kind == CurbKind::crease);
      CHECK(end.curb.height_m == 0.0f);
      found.push_back(end.at);
    }
    return found;
  }
};

//            /
//           /         the face of a curb; nothing beyond it is seen
//  ________/
TEST_CASE("border finder: a face beyond which nothing is seen ends at an edge, in any direction") {
  const bool turned = GENERATE(false, true);
  for (const double to : {1.4, 1.44, 1.5, 1.56}) {
    const std::vector<double> ends = Street{.to = to, .turned = turned}.ends();
    REQUIRE(ends.size() == 1);
    CHECK(ends[0] == Approx(to).margin(0.015));
  }
}

TEST_CASE("border finder: a face of which a row of cells is not seen ends where it does all the same") {
  const std::vector<double> ends = Street{.to = 1.5, .turned = GENERATE(false, true), .unseen_from = 1.3}.ends();
  REQUIRE(ends.size() == 1);
  CHECK(ends[0] == Approx(1.5).margin(0.015));
}

TEST_CASE("border finder: a ramp, an embankment, ground that falls away and what goes on do not end as faces do") {
  CHECK(Street{.slope = 0.1}.ends().empty());
  CHECK(Street{.to = 1.8}.ends().empty());
  CHECK(Street{.slope = -0.4}.ends().empty());
  CHECK(Street{.laser_x_m = 2.3f}.ends().empty());
  CHECK(Street{.to = 9.0, .top = 1.5}.ends().empty());
}

TEST_CASE("border finder: the end of a face that wavers by a cell, as far as it is open, is one line") {
  const std::vector<double> ends = Street{.to = 1.5, .waver = 0.1}.ends();
  REQUIRE(ends.size() == 1);
  CHECK(ends[0] == Approx(1.45).margin(0.03));
}

TEST_CASE("border finder: a face that the window cuts has no end") {
  CHECK(Street{.from = 2.1, .to = 9.0}.ends().empty());
  CHECK(Street{.from = 2.0, .to = 2.3}.ends().size() == 1);
}

//  o
//  ________
//          \\           readings that mix the edge and what is behind it, along the rays or less steep; no more is seen
TEST_CASE("border finder: where a veil follows the ground and nothing is seen behind it, a step goes down as far") {
  const bool turned = GENERATE(false, true);
  for (const double slope : {-1 / 1.4, -0.5}) {  // at 1.4 m the laser's rays fall by 1 in 1.4
    const auto brinks = Street{.slope = slope, .from = 1.4, .to = 1.7, .turned = turned}.one_sided();
    REQUIRE(brinks.size() == 1);
    const Curb& curb = brinks[0].curb;
    CHECK(curb.kind == CurbKind::step_down);
    CHECK(brinks[0].at == Approx(1.4).margin(0.03));
    CHECK(curb.height_m == Approx(0.3 * slope).margin(0.02));
    CHECK(curb.height_sd_m > 0.3f * -curb.height_m);  // more may be hidden
  }
}

//  o
//  _________   ____
//           .           the same veil with only three cells in the middle; or a drain with ground seen behind it
TEST_CASE("border finder: a veil of too few cells for a plane hides a step too, a drain and a single reading do not") {
  const auto curbs = [](double to_m, double width_m) {
    Stages<small_limits> stages(small_settings());
    test::Noise noise;
    const auto in_drain = [=](double x, double y) { return x >= 1.4 && x < 1.5 && y >= 1.0 && y < 1.0 + width_m; };
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.05, 0.0, noise,
                                       [&](double x, double y) { return in_drain(x, y) ? -0.1 : 0.0; })) {
      const double x = static_cast<double>(p.x_m), y = static_cast<double>(p.y_m);
      if (x < 1.4 || x > to_m || in_drain(x, y)) stages.dem.add(p);
    }
    stages.view.y_m = 1.2f;
    stages.settle();
    stages.trace(0.0f, 1.2f);
    return std::vector<Curb>(stages.tracer.curbs().begin(), stages.tracer.curbs().end());
  };
  const std::vector<Curb> brinks = curbs(9.0, 0.3);
  REQUIRE(brinks.size() == 1);
  CHECK(brinks[0].kind == CurbKind::step_down);
  CHECK(brinks[0].far_label == no_label);
  CHECK(brinks[0].x0_m == Approx(1.4).margin(0.03));
  CHECK(brinks[0].height_m == Approx(-0.2).margin(0.03));  // to the far side of a cell whose middle is seen
  CHECK(curbs(1.4, 0.3).empty());
  CHECK(curbs(9.0, 0.1).empty());  // one row of cells makes no line
}

//  o             |
//  ________      |       a car; before it the edge and one row of the road are seen
//          \\    |
//            \\__|
TEST_CASE("border finder: a veil before an obstacle hides a step as one beside it does") {
  Stages<small_limits> stages(small_settings());
  // The road, lower and seen to its end beside the car, is the largest plane. The mixed readings lie above it.
  test::fill(stages.dem, [](double x, double y) {
    if (x < 0.8) return 0.0;
    if (y < 1.6) return -0.2;
    if (x < 1.0) return -0.05 - 1.2 * (x - 0.85);
    return 0.5 + (static_cast<int>(y * 100) % 10 < 5 ? -0.5 : 0.5);
  });
  stages.view.y_m = 1.2f;
  stages.settle();
  stages.trace(0.0f, 1.2f);
  for (const double y : {1.75, 2.0, 2.25}) {
    CHECK(std::any_of(stages.tracer.curbs().begin(), stages.tracer.curbs().end(), [&](const Curb& curb) {
      const auto [low, high] = std::minmax(curb.y0_m, curb.y1_m);
      return curb.kind == CurbKind::step_down && static_cast<double>(low) < y && y < static_cast<double>(high) &&
             std::abs(curb.x0_m - 0.8f) < 0.05f;
    }));
  }
}

//  o             |
//  ________      |       a car on a road that is not seen; its wheels and the edge share the cells between them
//          \\    |
//            \\  |
TEST_CASE("border finder: a step down right before an obstacle is told by what lies below the ground") {
  const auto curbs = [](double drop_m) {
    Stages<small_limits> stages(small_settings());
    test::fill(stages.dem, [&](double x, double y) {  // four points a cell
      const auto second_half = [](double at) { return std::lround(at * 100) % 10 > 5; };
      if (x < 1.2) return 0.0;
      return second_half(y) && (x > 1.4 || second_half(x)) ? 0.4 : -drop_m;
    });
    stages.view.y_m = 1.2f;
    stages.settle();
    stages.trace(0.0f, 1.2f);
    return std::vector<Curb>(stages.tracer.curbs().begin(), stages.tracer.curbs().end());
  };
  const std::vector<Curb> found = curbs(0.25);
  REQUIRE(found.size() == 1);
  CHECK(found[0].kind == CurbKind::step_down);
  CHECK(found[0].far_label == no_label);
  CHECK(found[0].x0_m == Approx(1.2).margin(0.05));
  CHECK(curbs(0.0).empty());
}

//             _______
//   o  ->    :       o   what remains of a step that a robot has climbed: its upper side, and a row that mixes both
TEST_CASE("border finder: the face of a step up is no step down for a robot that has climbed it") {
  Stages<small_limits> stages(small_settings());
  test::Noise noise;
  stages.dem.look_from(-0.8f, 1.2f);
  for (const Point& p :
       test::sample({1.2, 2.4, 0.0, 2.4}, 0.02, 0.005, noise, [](double x, double) { return x < 1.25 ? -0.3 : 0.0; })) {
    stages.dem.add(p);
  }
  stages.settle();
  stages.dem.look_from(2.3f, 1.2f);
  stages.trace(2.3f, 1.2f);
  CHECK(stages.tracer.curbs().empty());
}

TEST_CASE("border finder: a veil at the window's end hides a step all the same") {
  CHECK(Street{.slope = -0.5, .from = 2.1, .to = 9.0}.one_sided().size() == 1);
}

//  .............       seen from above: the rays cross the edge obliquely and fall along it, not across it, and their
//  _____________       spots are wider than the two rows of mixed readings in the window; from near by the spot is
//  o                   small, and a bank is a bank
TEST_CASE("border finder: an edge that the spots of rays askew blur is a step down, from near by a bank") {
  const auto steps_down = [](const Viewpoint& view) {
    Stages<small_limits> stages(small_settings());
    test::fill(stages.dem, [](double, double y) { return y < 2.2 ? 0.0 : -0.3 * (y - 2.2); });
    stages.view = view;
    stages.settle();
    stages.trace(view.x_m, view.y_m);
    return std::count_if(stages.tracer.curbs().begin(), stages.tracer.curbs().end(), [](const Curb& curb) {
      return curb.kind == CurbKind::step_down && std::abs(curb.y0_m - 2.2f) < 0.05f && curb.x1_m - curb.x0_m > 2.0f;
    });
  };
  CHECK(steps_down({-2.0f, 1.2f, 1.0f}) == 1);
  CHECK(steps_down({1.2f, 1.2f, 1.0f}) == 0);
}

TEST_CASE("border finder: ground that ends, a ramp down, and a veil behind which there is ground, are no brinks") {
  CHECK(Street{.slope = 0.0}.one_sided().empty());
  CHECK(Street{.slope = -0.12, .from = 1.4, .to = 1.7}.one_sided().empty());
  const Street seen_from_low{.slope = -0.12, .from = 1.4, .to = 9.0, .laser_z_m = 0.31f};  // half as steep as the rays
  CHECK(seen_from_low.one_sided().empty());
  CHECK(Street{.slope = -0.5, .from = 1.4, .to = 9.0, .top = 1.7}.one_sided().empty());
  CHECK(Street{.slope = -0.5, .from = 1.4, .to = 1.7, .laser_x_m = 2.3f}.one_sided().empty());  // seen from beyond
}

//  o
//  ________
//          '.                a flight down of which no tread is made out: readings fall along its edges for more than
//            '.              the reach of links, and the floor is not hidden by the first edge but by the last
//              '._______
TEST_CASE("border finder: a veil behind which there is ground out of reach is a step down, as deep as the veil falls") {
  const bool turned = GENERATE(false, true);
  const auto brinks = Street{.slope = -1.5, .from = 0.6, .to = 9.0, .top = 1.4, .turned = turned}.one_sided();
  REQUIRE(brinks.size() == 1);
  CHECK(brinks[0].curb.kind == CurbKind::step_down);
  CHECK(brinks[0].at == Approx(0.6).margin(0.03));
  CHECK(brinks[0].curb.height_m == Approx(-1.2).margin(0.04));
}

// A bank that is seen from above may be a veil: its slope is known, and it is no step.
TEST_CASE("border finder: a bank that leads to ground out of reach is no brink") {
  for (const double slope : {-0.4, -0.5, -0.7}) {
    CHECK(Street{.slope = slope, .from = 0.6, .to = 9.0, .top = 1.6, .laser_x_m = -2.0f}.one_sided().empty());
  }
  for (const double slope : {-0.4, -0.5, -0.6}) {  // all of it in view
    CHECK(Street{.slope = slope, .from = 0.6, .to = 9.0, .top = 1.3, .laser_x_m = -0.5f}.one_sided().empty());
  }
}

// The face of a step up that leans against the grid by 1 in 20: from the step along a row, away from the laser, cells
// fall down the face to the ground for more than the reach of links.
TEST_CASE("border finder: the face of a step up, met from behind along a row, is no brink") {
  Stages<small_limits> stages(small_settings());
  test::fill(stages.dem, [](double x, double y) { return x < 1.0 + y / 20 ? 0.0 : 0.055; });
  stages.settle();
  stages.trace();
  const FoundBorders found = found_borders(stages);
  CHECK(found.between_planes >= 24);
  CHECK(found.one_sided == 0);
}

//  y        /              a step up of 12 cm askew to the grid, seen from its foot at x = 0, y = 1.2: on every second
//  12 cm   /  0 m          row scan lines have met its face, but not the ground before it
//         /   <- o
TEST_CASE("border finder: the face of a step up is no brink, though along a row nothing is seen beyond it") {
  Stages<small_limits> stages(small_settings());
  stages.view = {0.0f, 1.2f, 1.0f};
  const auto edge_m = [](double x) {
    return 1.1 - 1.5 * (x - 1.6);
  };  // y of it: the ground is higher where that is more
  const auto add = [&](double x, double y, double z) {
    stages.dem.add({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), 1e-4f});
  };
  for (int i = 0; i < 24; ++i) {
    const bool missed = i == 15 || i == 17 || i == 19;
    for (int k = 0; k < 3 * 24 * 3; ++k) {
      const double x = (i + (k % 3 + 0.5) / 3) / 10, y = (k / 3 + 0.5) / 30;
      const double before_m = edge_m(x) - y;
      if (before_m < 0.02 || !missed) add(x, y, before_m > 0 ? 0.0 : 0.12);
    }
    for (int k = 0; k < 10; ++k) {
      const double x = (i + (k + 0.5) / 10) / 10;
      for (const double z : {0.03, 0.09}) add(x, edge_m(x) - 0.001, z);
    }
  }
  stages.settle();
  stages.trace(0.0f, 1.2f);
  const FoundBorders found = found_borders(stages);
  CHECK(found.between_planes > 20);
  CHECK(found.one_sided == 0);
}

/// The curbs of a platform up to `edge` and ground `drop` below it, which begins where the laser sees it, or `gap`
/// beyond the edge, along x or turned.
std::vector<Curb> curbs_of_platform(double edge, double drop, double gap, bool turned) {
  Stages<small_limits> stages(small_settings());
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) {
      for (const double at : {0.01, 0.03, 0.05, 0.07, 0.09}) {
        const double x = 0.1 * i + at, y = 0.1 * j + at, along = turned ? 2.4 - y : x;
        if (along > edge && along < edge + gap) continue;
        stages.dem.add(
            {static_cast<float>(x), static_cast<float>(y), along > edge ? static_cast<float>(-drop) : 0.0f, 1e-4f});
      }
    }
  }
  stages.view = turned ? Viewpoint{1.2f, 2.4f, 1.0f} : Viewpoint{0.0f, 1.2f, 1.0f};
  stages.settle();
  stages.trace(stages.view.x_m, stages.view.y_m);
  return {stages.tracer.curbs().begin(), stages.tracer.curbs().end()};
}

//  o
//  _______
//         ' .
//             ' ._____    the edge of a platform, 0.5 m high, hides 0.6 m, which is more than the reach of links
TEST_CASE("border finder: a step down is told, however wide what it hides") {
  const bool turned = GENERATE(false, true);
  const double edge = GENERATE(1.2, 1.25);
  const auto curbs = curbs_of_platform(edge, 0.5, 0.5 * edge, turned);
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].kind == CurbKind::step_down);
  CHECK(curbs[0].height_m == Approx(-0.5).margin(0.01));
  CHECK((turned ? 2.4f - curbs[0].y0_m : curbs[0].x0_m) == Approx(edge).margin(0.05));
}

TEST_CASE("border finder: a step down is told, though the first cells that it does not hide have not been seen") {
  const bool turned = GENERATE(false, true);
  const double edge = GENERATE(1.2, 1.25), unseen = GENERATE(0.1, 0.15);
  const auto curbs = curbs_of_platform(edge, 0.5, 0.5 * edge + unseen, turned);
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].kind == CurbKind::step_down);
  CHECK(curbs[0].height_m == Approx(-0.5).margin(0.01));
}

TEST_CASE("border finder: planes farther apart than a step can hide make no step") {
  const bool turned = GENERATE(false, true);
  CHECK(curbs_of_platform(1.2, 0.05, 0.6, turned).empty());
  CHECK(curbs_of_platform(1.2, -0.05, 0.6, turned).empty());
}

TEST_CASE("border finder: a face that the window cuts has no end on any side, of one that is longer than wide, too") {
  CHECK(Street{.from = 2.1, .to = 9.0, .turned = true}.ends().empty());
  const auto one_sided = [](int rows, int cols) {  // the window's end cuts the face, along its shorter side
    Stages<small_limits> stages(small_settings(rows, cols));
    test::fill(stages.dem, [=](double x, double y) { return 0.4 * std::max((rows < cols ? x : y) - 1.3, 0.0); });
    stages.settle();
    stages.trace(0.0f, 0.0f);
    REQUIRE(!stages.tracer.curbs().empty());  // its foot
    return std::count_if(stages.tracer.curbs().begin(), stages.tracer.curbs().end(),
                         [](const Curb& curb) { return curb.far_label == no_label || curb.near_label == no_label; });
  };
  CHECK(one_sided(16, 24) == 0);
  CHECK(one_sided(24, 16) == 0);
}

TEST_CASE("border finder: a veil hides a step on whichever half of the window it lies") {
  for (const double from : {0.9, 1.6}) {
    const Street street{.slope = -0.7 / from, .from = from, .to = from + 0.3, .turned = GENERATE(false, true)};
    CHECK(street.one_sided().size() == 1);
  }
}

/// The curbs of a window 1 m below a laser at (0, 1.2).
template <typename Height>
std::unique_ptr<Stages<small_limits>> traced(Height&& height_m) {
  auto stages = std::make_unique<Stages<small_limits>>(small_settings());
  stages->view = {0.0f, 1.2f, 1.0f};
  test::fill(stages->dem, height_m);
  stages->settle();
  stages->trace(0.0f, 1.2f);
  return stages;
}

//  o
//  _________
//           .            two rows, of two cells and of one cell: too few for a plane
TEST_CASE("border finder: a few readings below the end of what is seen hide a step, above it they do not") {
  const auto ground = [](double off_m) {
    return [=](double x, double y) {
      if (x < 1.4) return 0.0;
      if (y < 1.0 || y > 1.2 || x > (y < 1.1 ? 1.6 : 1.5)) return std::nan("");
      return off_m;
    };
  };
  const auto below = traced(ground(-0.1)), above = traced(ground(0.1));
  REQUIRE(below->tracer.curbs().size() == 1);
  CHECK(below->tracer.curbs()[0].kind == CurbKind::step_down);
  CHECK(below->tracer.curbs()[0].far_label == no_label);
  CHECK(above->tracer.curbs().empty());
}

//  o
//  _________    ________     the foot of a ramp, with the ground around it not seen
TEST_CASE("border finder: planes that meet in unseen ground have their border in its middle") {
  const auto stages =
      traced([](double x, double) { return x > 1.1 && x < 1.5 ? std::nan("") : 0.2 * std::max(x - 1.3, 0.0); });
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].kind == CurbKind::ramp_edge);
  CHECK(stages->tracer.curbs()[0].x0_m == Approx(1.3).margin(0.01));
  CHECK(stages->tracer.curbs()[0].x1_m == Approx(1.3).margin(0.01));
}

/// Number of open borders; REQUIREs that the window's only chain has `of` borders.
int open_borders(const Stages<small_limits>& stages, int of) {
  const auto& borders = const_cast<Stages<small_limits>&>(stages).work.curbs().borders;
  REQUIRE(borders.size() == of);
  int open = 0;
  for (int k = 0; k < of; ++k) open += borders.at(k).open;
  return open;
}

TEST_CASE("border finder: a hedge two cells wide on an edge leaves it open where it lies, one of a cell does not") {
  const auto hedge = [](double wide_m) {
    return [=](double x, double y) {
      if (x > 1.3 && x < 1.3 + wide_m && y > 0.8 && y < 1.6) return static_cast<int>(y * 100) % 10 < 5 ? 0.2 : 1.2;
      return x < 1.4 ? 0.0 : 0.12;
    };
  };
  CHECK(open_borders(*traced(hedge(0.2)), 24) == 8);
  CHECK(open_borders(*traced(hedge(0.1)), 24) == 0);
}

//  o
//  ____
//      -                 readings that mix the edge and the road
//        ____
TEST_CASE("border finder: what is mixed at the edge of a step down is no obstacle before what the edge hides") {
  const auto stages = traced([](double x, double) {
    return x < 1.4 ? 0.0 : x < 1.5 ? -0.06 : x < 1.6 ? std::nan("") : -0.12;
  });
  CHECK(open_borders(*stages, 24) == 0);
}

//  o
//  __-___                    a bump that has the ground's label
//        ____
TEST_CASE("border finder: a bump on the ground is no obstacle before what an edge hides") {
  const auto stages = traced([](double x, double y) {
    const bool bump = x > 0.9 && x < 1.0 && y > 1.1 && y < 1.3;
    return bump ? 0.05 : x < 1.4 ? 0.0 : x < 1.6 ? std::nan("") : -0.12;
  });
  CHECK(stages->label_at(9, 11) == stages->label_at(0, 11));
  CHECK(open_borders(*stages, 24) == 0);
}

//  o
//  _______  | |  ____
TEST_CASE("border finder: a wall leaves open an edge that it hides, on either side of the robot") {
  const bool mirrored = GENERATE(false, true);
  const auto height_m = [=](double, double y) {
    const double along = mirrored ? 2.4 - y : y;
    const bool unseen = along > 1.0 && along < 1.4;
    return unseen ? std::nan("") : along < 1.2 ? 0.0 : 0.12;
  };
  Stages<small_limits> stages(small_settings());
  test::fill(stages.dem, height_m);
  for (int i = 0; i < 24; ++i) {
    for (int k = 0; k < 10; ++k) {  // the wall
      const float x_m = 0.1f * static_cast<float>(i) + 0.03f + 0.004f * static_cast<float>(k);
      stages.dem.add({x_m, mirrored ? 1.25f : 1.15f, 0.08f * static_cast<float>(k) + 0.1f, 1e-4f});
    }
  }
  stages.settle();
  stages.trace(1.2f, mirrored ? 2.35f : 0.05f);
  CHECK(open_borders(stages, 24) == 24);
}

/// What a robot at (0, 1.2) has seen, traced after it has driven on.
template <typename Height>
std::unique_ptr<Stages<small_limits>> seen_before(float robot_x_m, Height&& height_m) {
  auto stages = std::make_unique<Stages<small_limits>>(small_settings());
  stages->view = {0.0f, 1.2f, 1.0f};
  stages->dem.look_from(0.0f, 1.2f);
  test::fill(stages->dem, height_m);
  stages->settle();
  stages->dem.look_from(robot_x_m, 1.2f);
  stages->view.x_m = robot_x_m;
  stages->trace(robot_x_m, 1.2f);
  return stages;
}

TEST_CASE("border finder: what a step down hid when it was seen it hides for a robot that has driven up to it") {
  for (const float robot_x_m : {0.0f, 1.1f, 1.5f}) {
    const auto stages = seen_before(robot_x_m, [](double x, double) {
      return x > 1.2 && x < 1.8 ? std::nan("") : x < 1.2 ? 0.0 : -0.5;
    });
    REQUIRE(stages->tracer.curbs().size() == 1);
    CHECK(stages->tracer.curbs()[0].kind == CurbKind::step_down);
    CHECK(stages->tracer.curbs()[0].height_m == Approx(-0.5).margin(0.01));
  }
}

TEST_CASE("border finder: an edge behind what hid it is open for a robot that has driven around that, too") {
  for (const float robot_x_m : {0.0f, 2.3f}) {
    const auto stages = seen_before(robot_x_m, [](double x, double y) {
      if (y > 1.6 && x > 1.1 && x < 1.2) return 0.4;
      return y > 1.6 && x > 1.1 && x < 1.5 ? std::nan("") : x < 1.4 ? 0.0 : 0.12;
    });
    CHECK(open_borders(*stages, 24) == 7);  // toward the first row behind it, the rays pass beside it
  }
}

TEST_CASE("border finder: a step down is told, however much it hides and however high its ground lies in the map") {
  const auto platform = [](double map_m, double post_m) {
    Stages<small_limits> stages(small_settings());
    stages.view = {0.0f, 1.2f, static_cast<float>(map_m + 1.0)};
    test::fill(stages.dem, [=](double x, double y) {
      const bool post = x > 1.4 && x < 1.5 && y > 1.0 && y < 1.3;
      if (post && post_m > 0.0) return map_m - 0.4 + (static_cast<int>(y * 100) % 10 < 5 ? 0.0 : post_m);
      return x > 1.2 && x < 1.8 ? std::nan("") : x < 1.2 ? map_m : map_m - 0.5;
    });
    stages.settle();
    stages.trace(0.0f, 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    CHECK(stages.tracer.curbs()[0].kind == CurbKind::step_down);
    CHECK(stages.tracer.curbs()[0].height_m == Approx(-0.5).margin(0.01));
    return found_borders(stages).between_planes;
  };
  CHECK(platform(0.0, 0.0) == 24);
  CHECK(platform(7.0, 0.0) == 24);
  CHECK(platform(0.0, 0.3) == 21);  // what stands in the gap, not the edge, may hide the rest of it
}

//  y     -0.1 m  |  not seen           | -0.5 m
//  2.1 __________|___________          |
//        0 m                 |         |          hides from the laser what is behind both
TEST_CASE("border finder: what the edge of another plane hides tells no step between those on both sides of it") {
  const auto stages = traced([](double x, double y) {
    if (x > 1.8) return -0.5;
    return y > 2.1 ? (x < 0.8 ? -0.1 : std::nan("")) : x < 1.2 ? 0.0 : std::nan("");
  });
  const auto beside = stages->label_at(2, 22), platform = stages->label_at(2, 2), road = stages->label_at(20, 22);
  int of_platform = 0;
  for (const Curb& curb : stages->tracer.curbs()) {
    CHECK_FALSE((curb.near_label == beside && curb.far_label == road));
    of_platform += curb.near_label == platform && curb.far_label == road;
  }
  CHECK(of_platform == 1);
}

//  y  0 m ______________________ 0.9         seen from x = 0, y = 1.2: a step down of 12 cm along x, which hides less
//     -0.12 m                                than a cell; of the ground above it cells next to each other have not
//                                            been seen, on a row or up to the end of what is seen
TEST_CASE("border finder: a step down lies where it is, whatever ground before it no scan line has met") {
  const bool at_end = GENERATE(false, true), turned = GENERATE(false, true);
  Stages<small_limits> stages(small_settings());
  stages.view = turned ? Viewpoint{1.2f, 2.4f, 1.0f} : Viewpoint{0.0f, 1.2f, 1.0f};
  test::fill(stages.dem, [=](double x, double y) {
    const double ahead = turned ? 2.4 - y : x, aside = turned ? x : y;
    const bool unseen = ahead > 1.6 && (at_end || ahead < 1.7);
    if (aside > 0.9) return aside < 1.8 && unseen ? std::nan("") : 0.0;
    return aside < 0.86 && (!at_end || ahead < 1.8) ? -0.12 : std::nan("");
  });
  stages.settle();
  stages.trace(stages.view.x_m, stages.view.y_m);
  REQUIRE_FALSE(stages.tracer.curbs().empty());
  for (const Curb& curb : stages.tracer.curbs()) {
    CHECK((turned ? curb.x0_m : curb.y0_m) == Approx(0.9).margin(0.05));
    CHECK((turned ? curb.x1_m : curb.y1_m) == Approx(0.9).margin(0.05));
  }
}

TEST_CASE("border finder: readings spread unevenly in a cell still locate its edge") {
  for (const bool turned : {false, true}) {
    Stages<small_limits> stages(small_settings());
    for (int i = 0; i < 24; ++i) {
      for (int j = 0; j < 24; ++j) {
        for (const double at : {0.01, 0.03, 0.05, 0.07, 0.09}) {  // spread across the edge; along it all to one side
          const double across = 0.1 * i + at, along = 0.1 * j + 0.01 + 0.1 * at;
          const auto x = static_cast<float>(turned ? along : across), y = static_cast<float>(turned ? across : along);
          stages.dem.add({x, y, across < 1.26 ? 0.0f : 0.12f, 1e-4f});
        }
      }
    }
    stages.settle();
    stages.trace(turned ? 1.2f : 0.0f, turned ? 0.0f : 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    const Curb& curb = stages.tracer.curbs()[0];
    CHECK((turned ? curb.y0_m : curb.x0_m) == Approx(1.26).margin(0.006));
  }
}

//                     x ______x_________x___
//                       x
//                       x  face          x: where scan lines cross it, the same in all cells beside it
//  ___x_________x_______x
//       empty
struct Face {
  static constexpr double edge_m = 1.26, step_m = 0.12;
  double line_m;  ///< where each cell is crossed
  int empty;      ///< cells before the one with the face
};

/// Where the curb is found; `turned`, along x instead of y.
double found_m(const Face& face, bool turned) {
  Stages<small_limits> stages(small_settings());
  const auto add = [&](double across, double along, double height) {
    const auto x = static_cast<float>(turned ? along : across), y = static_cast<float>(turned ? across : along);
    stages.dem.add({x, y, static_cast<float>(height), 1e-4f});
  };
  for (int j = 0; j < 24; ++j) {
    for (const double at : {0.01, 0.03, 0.05, 0.07, 0.09}) {
      const double along = 0.1 * j + at;
      for (int i = 0; i < 24; ++i) {
        const double across = 0.1 * i + face.line_m;
        if (i < 12 - face.empty || i >= 12) add(across, along, across < Face::edge_m ? 0.0 : Face::step_m);
      }
      for (const double share : {0.25, 0.5, 0.75}) add(Face::edge_m, along, share * Face::step_m);
    }
  }
  stages.settle();
  stages.trace(turned ? 1.2f : 0.0f, turned ? 0.0f : 1.2f);
  REQUIRE(stages.tracer.curbs().size() == 1);
  const Curb& curb = stages.tracer.curbs()[0];
  return static_cast<double>(turned ? curb.y0_m : curb.x0_m);
}

TEST_CASE("border finder: where few scan lines cross the cells beside a face it lies where it is seen") {
  for (const double line_m : {0.03, 0.09}) {
    for (const bool turned : {false, true}) CHECK(found_m({line_m, 0}, turned) == Approx(Face::edge_m).margin(0.012));
  }
}

TEST_CASE("border finder: a face lies where it is seen, however many cells before it no scan line has met") {
  for (const int empty : {1, 2, 3}) {
    for (const bool turned : {false, true}) CHECK(found_m({0.03, empty}, turned) == Approx(Face::edge_m).margin(0.012));
  }
}

//               x____x____x____x____      the cell that the edge crosses lies beside one that a single line has crossed
//  ______x____x_
TEST_CASE("border finder: an edge lies where it is in its cell, wherever a scan line has crossed the cell before it") {
  for (const double line_m : {0.01, 0.09}) {
    for (const bool turned : {false, true}) {
      Stages<small_limits> stages(small_settings());
      test::Noise noise;
      const auto add = [&](double across, double along) {
        const auto x = static_cast<float>(turned ? along : across), y = static_cast<float>(turned ? across : along);
        const double height = (across < 1.205 ? 0.0 : 0.12) + 0.01 * noise.normal();
        stages.dem.add({x, y, static_cast<float>(height), 1e-4f});
      };
      for (double along = 0.01; along < 2.4; along += 0.02) {
        for (int i = 0; i < 24; ++i) {
          if (i != 12) add(0.1 * i + line_m, along);
        }
        for (double at = 0.0025; at < 0.1; at += 0.005) add(1.2 + at, along);
      }
      stages.settle();
      stages.trace(turned ? 1.2f : 0.0f, turned ? 0.0f : 1.2f);
      REQUIRE(stages.tracer.curbs().size() == 1);
      const Curb& curb = stages.tracer.curbs()[0];
      CHECK(0.5f * (turned ? curb.y0_m + curb.y1_m : curb.x0_m + curb.x1_m) == Approx(1.205).margin(0.006));
    }
  }
}

}  // namespace
}  // namespace curbline
