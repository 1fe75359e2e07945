// How far a straight piece of borders reaches, how well its place is known, and what lies beyond its ends. What becomes
// of pieces: curb_tracer_test.cpp.
#include "curbline/curbs/curb_piece.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "curbline/borders/border_finder.hpp"
#include "curbline/curbs/step_height.hpp"
#include "support/traced_curbs.hpp"

namespace curbline {
namespace {

using test::fill;
using test::length_m;
using test::Noise;
using test::small_limits;
using test::small_settings;
using test::Stages;
using test::traced;
using test::up;

struct Flank {
  double lower_m;             ///< than the pavement, where it reaches the road
  double unseen_cells = 0.0;  ///< between the two, along the road
  bool mirrored = false;      ///< the pavement lies at high y
};

//  flank   |        a road at x < 1.2 m; beside it a pavement, 12 cm higher, up to the middle of the window, and beyond
//  --------+ road   a flank that rises away from the road; seen from above
//  pavement|
/// By how much the step up to the pavement may be lower, as both ends of its piece tell it, at the flank and away from
/// it.
struct Lower {
  float at_flank_m, elsewhere_m;
};
Lower lower(const Flank& flank) {
  const auto stages = std::make_unique<Stages<small_limits>>(small_settings());
  fill(stages->dem, [&](double x, double y) {
    const double along = (flank.mirrored ? 2.4 - y : y) - 1.2;
    if (along > 0.0 && along < 0.1 * flank.unseen_cells) return std::nan("");
    return x < 1.2 ? 0.0 : along < 0.0 ? 0.12 : 0.12 - flank.lower_m + 0.2 * (x - 1.2);
  });
  stages->settle();
  const CurbSettings settings{};
  const CurbStages<small_limits> curb_stages{stages->dem,  stages->mixture, stages->field,
                                             stages->view, stages->latency, settings};
  auto& borders = stages->work.curbs().borders;
  borders.clear();
  BorderFinder<small_limits>(curb_stages).find(borders, stages->counters);
  const Label road = stages->label_at(3, flank.mirrored ? 21 : 2),
              pavement = stages->label_at(20, flank.mirrored ? 21 : 2);
  REQUIRE(pavement != stages->label_at(20, flank.mirrored ? 2 : 21));
  for (int b = 0; b < borders.size(); ++b) {
    if (borders.chained(b)) continue;
    const int length = borders.chain(stages->dem, b, settings.link_reach);
    const ChainPart whole = borders.part(0, length - 1);
    const CurbPiece<small_limits> piece(curb_stages, whole);
    if (piece.first.one != std::min(road, pavement) || piece.first.other != std::max(road, pavement)) continue;
    const bool first_at_flank = std::abs(piece.line.y0_m - 1.2f) < std::abs(piece.line.y1_m - 1.2f);
    const auto variance_m2 = [&](bool first, bool second) {
      auto part = borders.part(0, length - 1);
      part.ends = {first, second};
      CurbPiece<small_limits> anew(curb_stages, part);
      StepHeight<small_limits> height(anew);
      height.refine(true);
      return height.variance_m2();
    };
    const auto lower_m = [&](bool first) {  // uniformly by up to as much
      return std::sqrt(3.0f * (variance_m2(first, !first) - variance_m2(false, false)));
    };
    return {lower_m(first_at_flank), lower_m(!first_at_flank)};
  }
  FAIL("no border between road and pavement");
  return {};
}

TEST_CASE("curb piece: beside a flank that labels do not tell from the pavement the step may be as much lower") {
  const bool mirrored = GENERATE(false, true);
  for (const double unseen_cells : {0.0, 1.0}) {  // a scan line may be missing between the two
    const auto [at_flank_m, elsewhere_m] = lower({0.005, unseen_cells, mirrored});
    CHECK(at_flank_m == Approx(0.005).margin(0.001));
    CHECK(elsewhere_m < 1e-4f);
  }
  CHECK(lower({0.005, 2.0, mirrored}).at_flank_m < 1e-4f);
}

TEST_CASE("curb piece: a flank that is clearly lower, or higher, where it begins makes a step no lower") {
  CHECK(lower({0.05}).at_flank_m < 1e-4f);
  CHECK(lower({-0.005}).at_flank_m < 1e-4f);
}

//  A A A B B
//  A . . . B   on one row the border lies aside, and the chain comes back to it last
//  A A A B B
TEST_CASE("curb piece: a curb reaches its outermost borders, in whatever order they were chained") {
  for (const int row : {3, 4, 5}) {
    INFO("row " << row);
    const auto stages = traced([&](double x, double y) {
      const bool hidden = static_cast<int>(y * 10) == row && x > 0.8 && x < 1.2;
      return hidden ? std::nan("") : x < 1.2 ? 0.0 : 0.12;
    });
    REQUIRE(stages->tracer.curbs().size() == 1);
    CHECK(length_m(stages->tracer.curbs()[0]) == Approx(2.4).margin(0.02));
  }
}

//  . . B B     the corners of a road and of a pavement meet at a cell that nobody has seen: along its row and its
//  A . o B     column they border in the same place
//  A A A .
TEST_CASE("curb piece: where two surfaces meet at a single cell the curb is as long as that") {
  auto stages = std::make_unique<Stages<>>(small_settings());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  fill(stages->dem, [&](double x, double y) {
    const bool low = std::max(x, y)<1.3, high = std::min(x, y)> 1.2;
    return low == high ? nan : low ? 0.0 : 0.12;
  });
  stages->settle();
  stages->trace();
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(curb.kind == CurbKind::step_up);
  CHECK(curb.height_m == Approx(0.12).margin(4 * curb.height_sd_m));
  CHECK(length_m(curb) == Approx(0.1).margin(0.001));
  CHECK(0.5f * (curb.x0_m + curb.x1_m) == Approx(1.25).margin(0.001));
  CHECK(0.5f * (curb.y0_m + curb.y1_m) == Approx(1.25).margin(0.001));
  CHECK(to_far_side_m(curb, 1.2f, 1.25f) < 0.0f);
  CHECK(to_far_side_m(curb, 1.25f, 1.2f) < 0.0f);
  CHECK(curb.face_width_m == Approx(0.1 * std::sqrt(0.5)).margin(0.001));  // of the cell, measured across the curb
}

/// Variance of a step's position, with 24 borders between cells of 10 cm that hold one side each, without the part due
/// to the uncertainty of its height: the edge may be anywhere between two scan lines, one a cell, as the four points of
/// a cell are fewer than the beams that fit into it. Each border deviates by a cell's own error relative to the step.
double place_variance_m2(const Stages<>& stages, const Curb& curb, double lines) {
  const double cells_m2 = 0.5 * static_cast<double>(stages.mixture.plane(curb.near_label).fit_variance_m2 +
                                                    stages.mixture.plane(curb.far_label).fit_variance_m2);
  const double step_m2 = static_cast<double>(curb.height_m * curb.height_m);
  return 0.1 * 0.1 / (12.0 * lines) + 0.2 * 0.1 * cells_m2 / step_m2 / 24.0;
}

TEST_CASE("curb piece: a curb's place is known to what parts two scan lines, over the root of those that cross it") {
  const auto along = traced(up), across = traced([](double x, double y) { return up(y, x); });
  for (const auto* stages : {&along, &across}) {
    INFO((stages == &along ? "along" : "across"));
    REQUIRE((*stages)->tracer.curbs().size() == 1);
    const Curb& curb = (*stages)->tracer.curbs()[0];
    const double lines = stages == &along ? 1.0 : 25.0;  // of 24 cells, with what is between their ends
    CHECK(curb.position_sd_m == Approx(std::sqrt(place_variance_m2(**stages, curb, lines))).epsilon(0.02));
  }
}

//      ________      scan lines run along the edge, three empty cells apart: no border shows where it lies between them
//  ____  ?
TEST_CASE("curb piece: a step between the same two scan lines is known to all that lies between them") {
  const auto stages = traced([](double x, double y) { return x > 1.2 && x < 1.5 ? std::nan("") : up(x, y); });
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  REQUIRE(curb.kind == CurbKind::step_up);
  CHECK(curb.position_sd_m == Approx(0.3 / std::sqrt(12.0)).epsilon(0.02));  // regardless of the number of borders
}

//      x  x |x  x        on every row the same scan lines, at the same places: all rows are wrong by as much
//  x  x     |
TEST_CASE("curb piece: a step that scan lines run along lies between two of them, anywhere in what parts them") {
  const double pitch_m = GENERATE(0.1, 0.05);
  double errors_m2 = 0.0, told_m2 = 0.0;
  const double beam_m = 0.025;  // from beam to beam, 1.6 m from the laser
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    Noise noise(seed);
    const double first_m = pitch_m * noise.uniform(), edge_m = 1.15 + 0.1 * noise.uniform();
    Stages<> stages(small_settings());
    for (double x = first_m; x < 2.4; x += pitch_m) {
      for (double y = 0.5 * beam_m; y < 2.4; y += beam_m)
        stages.dem.add({static_cast<float>(x), static_cast<float>(y),
                        (x < edge_m ? 0.0f : 0.12f) + 0.001f * static_cast<float>(noise.normal()), 1e-4f});
    }
    stages.view.bearing_step_rad = static_cast<float>(beam_m) / 1.6f;
    stages.settle();
    stages.trace(0.0f, 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    const Curb& curb = stages.tracer.curbs()[0];
    errors_m2 += std::pow(0.5 * static_cast<double>(curb.x0_m + curb.x1_m) - edge_m, 2) / 60;
    told_m2 += std::pow(static_cast<double>(curb.position_sd_m), 2) / 60;
  }
  INFO("mm: " << 1e3 * std::sqrt(errors_m2) << ", told " << 1e3 * std::sqrt(told_m2) << ", of lines " << pitch_m);
  CHECK(errors_m2 < 1.5 * pitch_m * pitch_m / 12.0);
  CHECK(told_m2 > 0.4 * errors_m2);
  CHECK(told_m2 < 2.0 * errors_m2);
}

TEST_CASE("curb piece: a low step's place is known less well, as its height is") {
  const auto stages = traced([](double x, double) { return x < 1.4 ? 0.0 : 0.025; });
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  REQUIRE(curb.kind == CurbKind::step_up);
  // Cells of 10 cm, each deviating by half of the height's uncertainty relative to the height.
  const double others_m2 = place_variance_m2(*stages, curb, 1.0),
               by_height_m = 0.1 * 0.5 * curb.height_sd_m / curb.height_m;
  CHECK(curb.position_sd_m == Approx(std::sqrt(others_m2 + by_height_m * by_height_m)).epsilon(0.02));
  CHECK(by_height_m > 0.001);
}

TEST_CASE("curb piece: a sharp step has no width to tell") {
  const auto stages = traced(up);
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].face_width_m == Approx(0.0).margin(0.01));
}

//  y          |
//  |   near   |  not seen (or something else)
//  1.6        |____________
//  |   near   |  0.12 m higher
TEST_CASE("curb piece: a curb goes on for two cells where one side is not seen, not where it is another plane") {
  struct Ground {
    bool seen = true;
    double height_m = 0.0, rough_m = 0.0;
  };
  const Ground unseen{.seen = false}, hedge{.height_m = 0.5, .rough_m = 0.4};
  const auto end_m = [](const Ground& near, const Ground& far) {
    Stages<> stages(small_settings());
    Noise noise;
    const auto map = [&](const test::Patch& patch, const Ground& ground) {
      if (!ground.seen) return;
      const auto height_m = [&](double, double y) {
        return ground.height_m + (static_cast<int>(y * 100) % 10 < 5 ? -ground.rough_m : ground.rough_m);
      };
      for (const Point& p : test::sample(patch, 0.05, 0.003, noise, height_m)) stages.dem.add(p);
    };
    map({0, 1.4, 0, 1.6}, {});
    map({1.4, 2.4, 0, 1.6}, {.height_m = 0.12});
    map({0, 1.4, 1.6, 2.4}, near);
    map({1.4, 2.4, 1.6, 2.4}, far);
    stages.settle();
    stages.trace(0.0f, 1.2f);
    float furthest_m = 0.0f;
    for (const Curb& curb : stages.tracer.curbs()) {
      if (curb.kind != CurbKind::step_up || std::abs(curb.x1_m - curb.x0_m) > 0.1f) continue;  // another side
      CHECK(curb.x0_m == Approx(1.4).margin(0.02));
      CHECK(std::min(curb.y0_m, curb.y1_m) == Approx(0.0).margin(0.02));  // not beyond the window
      furthest_m = std::max(curb.y0_m, curb.y1_m);
    }
    return furthest_m;
  };
  CHECK(end_m({}, unseen) == Approx(1.8).margin(0.02));
  CHECK(end_m({}, hedge) == Approx(1.8).margin(0.02));
  CHECK(end_m(hedge, {.height_m = 0.12}) == Approx(1.8).margin(0.02));
  CHECK(end_m(unseen, unseen) == Approx(1.6).margin(0.02));
  CHECK(end_m({}, {.height_m = 0.0}) == Approx(1.6).margin(0.03));  // the pavement's corner
  CHECK(end_m({}, {.height_m = -0.1}) == Approx(1.6).margin(0.02));
}

TEST_CASE(
    "curb piece: a curb that goes on tells the height of its middle, one height, and no more than a quarter of its "
    "length") {
  struct Kerb {
    double slope, seen_to_m, told_to_m;
  };
  const Kerb kerb = GENERATE(Kerb{0.016, 1.7, 1.9}, Kerb{0.019, 1.7, 1.8}, Kerb{0.0, 0.7, 0.8});
  const auto step_m = [=](double y) { return 0.08 + kerb.slope * y; };
  Stages<> stages(small_settings());
  Noise noise;
  for (const Point& p : test::sample({0, 1.4, 0, 2.4}, 0.05, 0.0005, noise, [](double, double) { return 0.0; }))
    stages.dem.add(p);
  for (const Point& p :
       test::sample({1.4, 2.4, 0, kerb.seen_to_m}, 0.05, 0.0005, noise, [&](double, double y) { return step_m(y); }))
    stages.dem.add(p);
  stages.settle();
  stages.trace(0.0f, 1.2f);
  float end_m = 0.0f;
  for (const Curb& curb : stages.tracer.curbs()) {
    CHECK(curb.height_m == Approx(step_m(0.5 * (curb.y0_m + curb.y1_m))).margin(0.0007));
    CHECK(std::abs(step_m(curb.y1_m) - step_m(curb.y0_m)) < 0.022);
    end_m = std::max({end_m, curb.y0_m, curb.y1_m});
  }
  CHECK(end_m == Approx(kerb.told_to_m).margin(0.02));
}

//  o
//  ________            the laser sees the edge and readings that mix it with the road behind, nothing more
//          -_
TEST_CASE("curb piece: of a brink, and of the end of a face, all borders err alike, and as much may be hidden again") {
  const auto one_sided = [](double slope, double from) {
    const auto stages = traced(
        [=](double x, double) { return x > from + 0.3 ? std::nan("") : slope * std::max(x - from, 0.0); }, 0.0f, 1.2f);
    std::vector<Curb> found;
    for (const Curb& curb : stages->tracer.curbs()) {
      if (curb.far_label == no_label) found.push_back(curb);
    }
    return found;
  };
  const std::vector<Curb> brinks = one_sided(-0.5, 1.4), faces = one_sided(0.4, 1.2);
  REQUIRE(brinks.size() == 1);
  CHECK(brinks[0].position_sd_m == Approx(0.05 / std::sqrt(3.0)).epsilon(0.02));
  CHECK(brinks[0].height_sd_m == Approx(-brinks[0].height_m / std::sqrt(3.0)).epsilon(0.02));
  REQUIRE(faces.size() == 1);
  CHECK(faces[0].position_sd_m == Approx(0.1 / std::sqrt(3.0)).epsilon(0.02));
}

//          1.6
//  y  0.12  |  not seen      the chain begins with a border that was found along its line, on a cell of the other side
//     0.0
TEST_CASE("curb piece: a curb goes on where one side is not seen, though its first border was found along its line") {
  const float lean = GENERATE(0.02f, -0.02f);
  Stages<small_limits> stages(small_settings());
  fill(stages.dem, [](double x, double y) { return y < 1.2 ? 0.0 : x > 1.6 ? std::nan("") : 0.12; });
  stages.settle();
  const Label low = stages.label_at(3, 3), high = stages.label_at(3, 20);
  std::array<Border, 15> borders{};
  std::array<Border::Index, 15> chain{};
  for (std::size_t k = 0; k < borders.size(); ++k) {
    const float x_m = 0.1f * static_cast<float>(k) + 0.05f;
    chain[k] = static_cast<Border::Index>(k);
    borders[k].axis = k == 0 ? 0 : 1;
    borders[k].x_m = k == 0 ? 0.1f : x_m;
    borders[k].y_m = k == 0 ? 1.22f : 1.2f + lean * (x_m - 0.85f);
    borders[k].half_gap_m = 0.05f;
    borders[k].probability = 1.0f;
    borders[k].one = std::min(low, high);
    borders[k].other = std::max(low, high);
    borders[k].sign = low < high ? 1 : -1;
  }
  const CurbSettings settings{};
  const CurbStages<small_limits> curb_stages{stages.dem,  stages.mixture, stages.field,
                                             stages.view, stages.latency, settings};
  const ChainPart part(borders.data(), chain, {true, true});
  CurbPiece<small_limits> piece(curb_stages, part);
  const float seen_m = piece.line.x1_m;
  piece.go_on(CurbPiece<small_limits>::End::second);
  CHECK(piece.line.x1_m > seen_m + 0.15f);
}

//  y  near  |   not seen, at one end of the edge, whichever way it runs
//  |  near  |____
//  |  near  |  0.12 m higher
TEST_CASE("curb piece: a curb goes on for two cells where one side is not seen at either end, along x and y") {
  const bool along_x = GENERATE(false, true), mirrored = GENERATE(false, true), far_unseen = GENERATE(false, true);
  const auto stages = traced(
      [=](double x, double y) {
        double along = along_x ? x : y;
        const double across = along_x ? y : x;
        if (mirrored) along = 2.4 - along;
        if (along > 1.6 && (across > 1.4) == far_unseen) return std::nan("");
        return across < 1.4 ? 0.0 : 0.12;
      },
      along_x ? 1.2f : 0.0f, along_x ? 0.0f : 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  const double a = along_x ? curb.x0_m : curb.y0_m, b = along_x ? curb.x1_m : curb.y1_m;
  const double first = mirrored ? 2.4 - std::max(a, b) : std::min(a, b),
               last = mirrored ? 2.4 - std::min(a, b) : std::max(a, b);
  CHECK(first == Approx(0.0).margin(0.02));
  CHECK(last == Approx(1.8).margin(0.02));
}

TEST_CASE("curb piece: an oblique face is as wide as across it") {
  const double turn = GENERATE(0.0, 0.5, 0.7854);
  const double nx = std::cos(turn), ny = std::sin(turn);
  auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  const auto face = [=](double x, double y) { return 1.2 * std::clamp(nx * (x - 1.2) + ny * (y - 1.2), 0.0, 0.1); };
  for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.003, noise, face)) stages->dem.add(p);
  stages->settle();
  stages->trace(0.0f, 0.0f);
  const auto curbs = stages->tracer.curbs();
  const auto longest = std::max_element(curbs.begin(), curbs.end(),
                                        [](const Curb& a, const Curb& b) { return length_m(a) < length_m(b); });
  REQUIRE(longest != curbs.end());
  CHECK(longest->height_m == Approx(0.12).margin(0.01));
  CHECK(longest->face_width_m == Approx(0.1).margin(0.06));
}

}  // namespace
}  // namespace curbline
