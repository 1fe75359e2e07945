// Curbs from labels: where they are, how high they are, which way they run, and what is not a curb.
#include "curbline/curbs/curb_tracer.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::Noise;
using test::small_settings;
using test::Stages;

/// A window with this ground, labelled, and traced from the robot's position.
template <Limits limits = test::small_limits, typename Height>
std::unique_ptr<Stages<limits>> traced(Height&& height_m, float robot_x_m = 0.0f, float robot_y_m = 0.0f,
                                       const Settings& settings = small_settings()) {
  auto stages = std::make_unique<Stages<limits>>(settings);
  fill(stages->dem, height_m);
  stages->settle();
  stages->trace(robot_x_m, robot_y_m);
  return stages;
}

double length_m(const Curb& c) {
  return std::hypot(c.x1_m - c.x0_m, c.y1_m - c.y0_m);
}

double total_length_m(std::span<const Curb> curbs) {
  double sum = 0.0;
  for (const Curb& c : curbs) sum += length_m(c);
  return sum;
}

double up(double x, double) {
  return x < 1.4 ? 0.0 : 0.12;
}

TEST_CASE("curb tracer: a step is one piece with its place, height and direction") {
  const auto stages = traced(up);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(curb.kind == CurbKind::step_up);
  CHECK(curb.height_m == Approx(0.12).margin(4 * curb.height_sd_m));
  CHECK(curb.height_sd_m > 0.0f);
  CHECK(curb.height_sd_m < 0.002f);
  CHECK(curb.x0_m == Approx(1.4).margin(0.01));
  CHECK(curb.x1_m == Approx(1.4).margin(0.01));
  CHECK(length_m(curb) == Approx(2.4).margin(0.02));
  CHECK(curb.probability > 0.99f);
  CHECK(curb.near_label == stages->label_at(0, 0));
  CHECK(curb.far_label == stages->label_at(23, 0));
}

//  A A A B B
//  A . . . B   on one row the border lies aside, and the chain comes back to it last
//  A A A B B
TEST_CASE("curb tracer: a curb reaches its outermost borders, in whatever order they were chained") {
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
TEST_CASE("curb tracer: where two surfaces meet at a single cell the curb is as long as that") {
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

TEST_CASE("curb tracer: a probability is at most 1, however many cells agree on it") {
  for (int cols = 4; cols <= 24; cols += 4) {
    Settings settings = small_settings();
    settings.window.cols = cols;
    for (double step_m = 0.05; step_m < 0.25; step_m += 0.01) {
      const auto stages = traced([&](double x, double) { return x < 1.2 ? 0.0 : step_m; }, 0.0f, 0.0f, settings);
      REQUIRE_FALSE(stages->tracer.curbs().empty());
      for (const Curb& curb : stages->tracer.curbs()) CHECK(curb.probability <= 1.0f);
    }
  }
}

TEST_CASE("curb tracer: seen from above the same step goes down") {
  const auto stages = traced(up, 2.3f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(curb.kind == CurbKind::step_down);
  CHECK(curb.height_m == Approx(-0.12).margin(4 * curb.height_sd_m));
  CHECK(curb.near_label == stages->label_at(23, 0));
}

/// A step down of 12 cm at x = 1.2, with what it hides from a laser 1 m up at x = -0.8.
std::unique_ptr<Stages<>> seen_over_an_edge() {
  auto stages = std::make_unique<Stages<>>(small_settings());
  const double hidden_m = 2.0 * 0.12 / (1.0 - 0.12);
  stages->dem.look_from(-0.8f, 1.2f);
  Noise noise;
  const auto height_m = [](double x, double) { return x < 1.2 ? 0.12 : 0.0; };
  for (const Point& p : test::sample({0.0, 2.4, 0.0, 2.4}, 0.02, 0.005, noise, height_m)) {
    if (p.x_m < 1.2f || p.x_m > 1.2 + hidden_m) stages->dem.add(p);
  }
  stages->settle();
  return stages;
}

//  -0.8     0.9  1.2        a robot that has driven up to the edge, or over it, has seen the ground behind it from afar
//   o  ->    o    |____
TEST_CASE("curb tracer: an edge lies before its shadow from where it was seen, wherever the robot is by now") {
  const auto stages = seen_over_an_edge();
  for (const float robot_x_m : {-0.8f, 0.9f, 1.9f}) {
    INFO("robot at " << robot_x_m);
    stages->dem.look_from(robot_x_m, 1.2f);
    stages->trace(robot_x_m, 1.2f);
    REQUIRE(stages->tracer.curbs().size() == 1);
    const Curb& curb = stages->tracer.curbs()[0];
    CHECK(curb.kind == (robot_x_m < 1.2f ? CurbKind::step_down : CurbKind::step_up));
    CHECK(std::abs(curb.height_m) == Approx(0.12).margin(0.005));
    CHECK(curb.x0_m == Approx(1.2).margin(0.015));
    CHECK(curb.x1_m == Approx(1.2).margin(0.015));
  }
}

TEST_CASE("curb tracer: a step that was seen from below casts no shadow for a robot that has climbed it") {
  auto stages = std::make_unique<Stages<>>(small_settings());
  stages->dem.look_from(-0.8f, 1.2f);
  fill(stages->dem, up);
  stages->settle();
  stages->dem.look_from(2.3f, 1.2f);
  stages->trace(2.3f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].kind == CurbKind::step_down);
  CHECK(stages->tracer.curbs()[0].x0_m == Approx(1.4).margin(0.01));
}

TEST_CASE(
    "curb tracer: from its first end to its second the robot's side lies to the right, whatever way a curb runs") {
  for (const double turn : {0.0, 0.4, 0.8, 1.2, 1.6, 2.0, 2.4, 2.8}) {
    const double nx = std::cos(turn), ny = std::sin(turn);
    const auto across = [&](double x, double y) { return (x - 1.2) * nx + (y - 1.2) * ny; };
    for (const auto& [side, along] : {std::pair{-1.0, 0.0}, {1.0, 0.0}, {-0.6, 3.0}, {0.6, 3.0}, {-0.6, -3.0}}) {
      const auto robot_x = static_cast<float>(1.2 + side * nx - along * ny);
      const auto robot_y = static_cast<float>(1.2 + side * ny + along * nx);
      const auto stages = traced([&](double x, double y) { return across(x, y) < 0.0 ? 0.0 : 0.12; }, robot_x, robot_y);
      REQUIRE_FALSE(stages->tracer.curbs().empty());
      for (const Curb& c : stages->tracer.curbs()) {
        const float dx = c.x1_m - c.x0_m, dy = c.y1_m - c.y0_m;
        CHECK(dx * (robot_y - c.y0_m) - dy * (robot_x - c.x0_m) < 0.0f);
        CHECK((c.kind == CurbKind::step_up) == (side < 0.0));
      }
    }
  }
}

TEST_CASE("curb tracer: near is the side of the line on which the robot stands, also in cells that are long") {
  Settings settings = small_settings();
  settings.window.cell_x_m = 0.2f;
  settings.window.cell_y_m = 0.05f;
  const auto rises = [](double x, double y) { return 0.4 * (x - 2.4) + (y - 0.6) > 0.0 ? 0.12 : 0.0; };
  const auto below = traced(rises, 0.4f, 1.2f, settings), above = traced(rises, 0.4f, 1.6f, settings);
  REQUIRE(below->tracer.curbs().size() == 1);
  REQUIRE(above->tracer.curbs().size() == 1);
  CHECK(below->tracer.curbs()[0].kind == CurbKind::step_up);
  CHECK(above->tracer.curbs()[0].kind == CurbKind::step_down);
}

TEST_CASE("curb tracer: a step across y is found as well as one across x") {
  const auto stages = traced([](double, double y) { return y < 1.0 ? 0.12 : 0.0; }, 0.0f, 2.3f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(curb.kind == CurbKind::step_up);
  CHECK(curb.y0_m == Approx(1.0).margin(0.01));
  CHECK(curb.y1_m == Approx(1.0).margin(0.01));
}

TEST_CASE("curb tracer: an oblique step is straight and within half a cell") {
  const double turn = GENERATE(0.3, 0.7, 1.2);
  const double nx = std::cos(turn), ny = std::sin(turn);
  const auto stages = traced([&](double x, double y) { return nx * (x - 1.2) + ny * (y - 1.2) < 0.0 ? 0.0 : 0.12; });
  double length = 0.0;
  for (const Curb& curb : stages->tracer.curbs()) {
    CHECK(std::abs(nx * (curb.x0_m - 1.2) + ny * (curb.y0_m - 1.2)) < 0.05);
    CHECK(std::abs(nx * (curb.x1_m - 1.2) + ny * (curb.y1_m - 1.2)) < 0.05);
    length += length_m(curb);
  }
  CHECK(stages->tracer.curbs().size() <= 2);
  CHECK(length == Approx(2.4 / std::max(nx, ny)).margin(0.2));
}

TEST_CASE("curb tracer: in the map frame a curb lies where it is, wherever the window is") {
  Settings settings = small_settings();
  settings.window.origin_x_m = -10.0f;
  settings.window.origin_y_m = 30.0f;
  const auto stages = traced([](double x, double) { return x < -9.0 ? 0.0 : 0.12; }, 0.5f, 1.2f, settings);
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].x0_m == Approx(-9.0).margin(0.01));
  CHECK(std::min(stages->tracer.curbs()[0].y0_m, stages->tracer.curbs()[0].y1_m) == Approx(30.0).margin(0.01));
}

TEST_CASE("curb tracer: a plane and a ramp meet at the edge of a ramp, not a step") {
  const auto stages = traced([](double x, double) { return x < 1.2 ? 0.0 : 0.3 * (x - 1.2); });
  REQUIRE_FALSE(stages->tracer.curbs().empty());
  for (const Curb& curb : stages->tracer.curbs()) {
    CHECK(curb.kind == CurbKind::ramp_edge);
    CHECK(std::abs(curb.height_m) < 0.02f);
    CHECK(curb.x0_m == Approx(1.2).margin(0.1));
  }
}

//           _-
//         _-         oblique, so that the position of the lip is known to better than a cell
//  ______|
TEST_CASE("curb tracer: a lip at the foot of a ramp is a step, a ramp without one has an edge") {
  const auto ramp_behind = [](double lip_m) {
    return [=](double x, double y) { return x + 0.2 * y < 1.4 ? 0.0 : lip_m + 0.17 * (x + 0.2 * y - 1.4); };
  };
  const auto with_lip = traced(ramp_behind(0.025)), without = traced(ramp_behind(0.0));
  REQUIRE_FALSE(with_lip->tracer.curbs().empty());
  for (const Curb& curb : with_lip->tracer.curbs()) {
    CHECK(curb.kind == CurbKind::step_up);
    CHECK(curb.height_m == Approx(0.025).margin(0.01));
  }
  REQUIRE_FALSE(without->tracer.curbs().empty());
  for (const Curb& curb : without->tracer.curbs()) CHECK(curb.kind == CurbKind::ramp_edge);
}

TEST_CASE("curb tracer: a step down to two rows, of which the first holds some of the edge, is no ramp") {
  for (const double share : {0.2, 0.3}) {
    const auto stages = traced([=](double x, double) { return x < 2.2 ? 0.06 : x < 2.3 ? 0.06 * share : 0.0; });
    REQUIRE(stages->tracer.curbs().size() == 1);
    const Curb& curb = stages->tracer.curbs()[0];
    CHECK(curb.kind == CurbKind::step_down);
    CHECK(curb.height_m == Approx(-0.06).margin(0.015));
    CHECK(std::abs(curb.height_m + 0.06f) < 2.0f * curb.height_sd_m);
  }
}

TEST_CASE("curb tracer: one plane has no curb") {
  CHECK(traced([](double x, double y) { return 0.1 * x + 0.05 * y; })->tracer.curbs().empty());
}

TEST_CASE("curb tracer: a curved border becomes several pieces along the curve") {
  // A corner with a radius of 1.4 m around (2.4, 2.4).
  const auto radius = [](double x, double y) { return std::hypot(x - 2.4, y - 2.4); };
  const auto stages = traced([&](double x, double y) { return radius(x, y) < 1.4 ? 0.12 : 0.0; });
  CHECK(stages->tracer.curbs().size() <= 5);
  for (const Curb& curb : stages->tracer.curbs()) {
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const double x = curb.x0_m + t * (curb.x1_m - curb.x0_m), y = curb.y0_m + t * (curb.y1_m - curb.y0_m);
      CHECK(radius(x, y) == Approx(1.4).margin(0.04));
    }
    CHECK(curb.kind == CurbKind::step_up);
  }
  CHECK(total_length_m(stages->tracer.curbs()) == Approx(1.4 * 1.5708).epsilon(0.15));
}

TEST_CASE("curb tracer: a curb that turns three cells from its end is told in two pieces, whichever end that is") {
  const bool last = GENERATE(false, true);
  const auto stages = traced([=](double x, double y) {
    const double turned_m = std::max(0.0, last ? y - 2.1 : 0.3 - y);
    return up(x + 0.3 * turned_m, y);
  });
  REQUIRE(stages->tracer.curbs().size() == 2);
  const double lengths_m[] = {length_m(stages->tracer.curbs()[0]), length_m(stages->tracer.curbs()[1])};
  CHECK(std::min(lengths_m[0], lengths_m[1]) == Approx(0.3).margin(0.05));
}

//           _____
//  |  near  |_____   not seen: the shadow of a post
//  |        |   seen
TEST_CASE("curb tracer: where a shadow hides one of its sides a curb stays where the others see it") {
  Stages<> stages(small_settings());
  fill(stages.dem, [](double x, double y) {
    const bool hidden = x > 1.4 && x < 1.7 && y > 2.3;
    return hidden ? std::nan("") : x > 1.4 ? 0.12 : 0.0;
  });
  stages.settle();
  stages.trace(0.0f, 1.2f);
  REQUIRE(stages.tracer.curbs().size() == 1);
  const Curb& curb = stages.tracer.curbs()[0];
  CHECK(curb.x0_m == Approx(1.4).margin(0.015));
  CHECK(curb.x1_m == Approx(1.4).margin(0.015));
  CHECK(length_m(curb) == Approx(2.4).margin(0.02));
}

//  y  near  |  |   a box and what it hides; three quarters of that is on the near side of the edge
//  |  near  |__|
//  |  near       |   12 cm higher
constexpr double box_m = 0.4;
auto behind_box(double from_y, double to_y = 2.2) {
  return [=](double x, double y) {
    if (y > from_y && y < to_y && x > 1.1 && x < 1.2) return box_m;
    return y > from_y && x > 1.1 && x < 1.5 ? std::nan("") : up(x, y);
  };
}

TEST_CASE("curb tracer: a curb continues straight behind an obstacle, wherever in the hidden part it lies") {
  const auto stages = traced(behind_box(1.6), 0.0f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(curb.x0_m == Approx(1.4).margin(0.02));
  CHECK(curb.x1_m == Approx(1.4).margin(0.02));
  CHECK(length_m(curb) == Approx(2.4).margin(0.05));
}

TEST_CASE("curb tracer: a corner behind what hides it is one all the same") {
  // The edge turns by 45 degrees where the box begins. If it went on straight, it would lie far outside the hidden
  // part.
  const auto stages = traced(
      [](double x, double y) {
        const double edge = y < 1.2 ? 1.0 : 1.0 + (y - 1.2), beyond = x - edge;
        if (y > 1.2 && beyond > -0.25 && beyond < -0.15) return box_m;
        return y > 1.2 && beyond > -0.25 && beyond < 0.1 ? std::nan("") : beyond < 0.0 ? 0.0 : 0.12;
      },
      0.0f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 2);
  for (const Curb& curb : stages->tracer.curbs())
    CHECK(std::fabs(curb.x1_m - curb.x0_m) == Approx(curb.y1_m > 1.5f || curb.y0_m > 1.5f ? 1.2 : 0.0).margin(0.25));
}

TEST_CASE("curb tracer: the place of a curb of which an obstacle hides most is known less well") {
  const auto sd_m = [](double from_y, double to_y = 2.2) {
    return traced(behind_box(from_y, to_y), 0.0f, 1.2f)->tracer.curbs()[0].position_sd_m;
  };
  CHECK(traced(behind_box(0.6), 0.0f, 1.2f)->tracer.curbs().size() == 1);
  CHECK(sd_m(0.6) > 2.0f * sd_m(1.8));
  CHECK(sd_m(-1.0, 9.0) > sd_m(0.6));  // all of it
}

TEST_CASE("curb tracer: a curb's face is no obstacle before what lies behind it") {
  const auto stages = traced(
      [](double x, double y) {
        if (x > 1.1 && x < 1.2 && static_cast<int>(10.0 * y) % 4 == 1) return std::nan("");
        return x < 1.0 ? 0.0 : x < 1.05 ? 0.03 : x < 1.1 ? 0.11 : 0.14;
      },
      0.0f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const auto& borders = stages->work.curbs().borders;  // one chain
  REQUIRE(borders.size() == 24);
  for (int k = 0; k < borders.size(); ++k) CHECK(!borders.at(k).open);
}

TEST_CASE("curb tracer: a step that grows along its way is cut into pieces of which the height holds") {
  const auto step_m = [](double y) { return 0.03 + 0.05 * y; };
  const auto stages = traced([&](double x, double y) { return x < 1.4 ? 0.0 : step_m(y); });
  const auto curbs = stages->tracer.curbs();
  REQUIRE(curbs.size() >= 6);  // it grows by 12 cm in all
  REQUIRE(curbs.size() <= 16);
  for (const Curb& curb : curbs) {
    CHECK(curb.kind == CurbKind::step_up);
    for (const float y : {curb.y0_m, curb.y1_m})
      CHECK(curb.height_m == Approx(step_m(static_cast<double>(y))).margin(0.016));
    const double middle = 0.5 * static_cast<double>(curb.y0_m + curb.y1_m);
    CHECK(curb.height_m == Approx(step_m(middle)).margin(4 * curb.height_sd_m));
  }
  CHECK(total_length_m(curbs) > 2.35);
  CHECK(total_length_m(curbs) < 2.4 + 0.1 * static_cast<double>(curbs.size()));  // they meet to within a cell
}

//            ________
//           /
//  ________/           the face, within the cells from 1.0 to 1.1 m
TEST_CASE("curb tracer: a curb's face is looked through, the full step and the width told") {
  const auto stages = traced([&](double x, double) { return x < 1.0 ? 0.0 : x < 1.05 ? 0.03 : x < 1.1 ? 0.11 : 0.14; });
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(curb.height_m == Approx(0.14).margin(4 * curb.height_sd_m + 0.002));
  CHECK(curb.x0_m == Approx(1.05).margin(0.02));
  CHECK(curb.face_width_m == Approx(0.1).margin(0.01));
  CHECK(curb.kind == CurbKind::step_up);
}

/// A road, a pavement of 12 cm, and a dropped part of 6 cm that begins with a row of cells between them. In that row
/// points are added then: half of them spread_m higher, half lower.
std::unique_ptr<Stages<>> with_row_between(double spread_m) {
  auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double x, double y) { return x < 1.0 ? 0.0 : x < 1.1 || y > 1.4 ? 0.06 : 0.12; });
  stages->settle();
  for (int j = 0; j < 24; ++j) {
    CHECK(stages->label_at(10, j) == stages->label_at(20, 20));
    for (int k = 0; k < 200; ++k) {
      const double z = 0.06 + (k % 2 == 0 ? spread_m : -spread_m);
      stages->dem.add({1.05f, 0.1f * static_cast<float>(j) + 0.05f, static_cast<float>(z), 1e-4f});
    }
  }
  stages->trace();
  return stages;
}

TEST_CASE("curb tracer: an edge is as high as its planes are apart, though its cells bear a third plane's label") {
  const auto heights_m = [](const Stages<>& stages) {
    std::vector<float> found;
    for (const Curb& c : stages.tracer.curbs()) {
      if (is_step(c) && c.y0_m + c.y1_m < 2.0f) found.push_back(c.height_m);
    }
    return found;
  };
  SECTION("readings of both sides are an edge") {
    const auto found = heights_m(*with_row_between(0.06));
    REQUIRE(found.size() == 1);
    CHECK(found[0] == Approx(0.12f).margin(0.002));
  }
  SECTION("readings at one height are a strip of that plane") {
    for (const float height_m : heights_m(*with_row_between(0.03))) CHECK(height_m == Approx(0.06f).margin(0.002));
  }
}

/// A step of 12 cm at x = 1.4 m; over the last 0.2 m before it the road falls by depth_m.
auto with_gutter(double depth_m) {
  return [depth_m](double x, double) { return x > 1.4 ? 0.12 : x > 1.2 ? -depth_m * (x - 1.2) / 0.2 : 0.0; };
}

/// The same window, when it has turned out that its cells share no noise but 1 mm.
auto traced_gutter(double depth_m, float robot_x_m = 0.0f, float robot_y_m = 0.0f) {
  auto stages = traced(with_gutter(depth_m), robot_x_m, robot_y_m);
  stages->dem.set_common(1e-6f, 1e-6f);
  stages->trace(robot_x_m, robot_y_m);
  return stages;
}

TEST_CASE("curb tracer: a step from a gutter labelled as the road is as high as from its bottom") {
  const auto up = traced_gutter(0.02), down = traced_gutter(0.02, 2.3f, 1.2f);
  REQUIRE(up->tracer.curbs().size() == 1);
  REQUIRE(down->tracer.curbs().size() == 1);
  const Curb& from_road = up->tracer.curbs()[0];
  CHECK(up->label_at(13, 5) == up->label_at(0, 5));  // the gutter's cells and the road's
  CHECK(from_road.height_m == Approx(0.14).margin(4 * from_road.height_sd_m));
  CHECK(from_road.height_m > 0.135f);
  CHECK(from_road.height_sd_m < 0.005f);
  CHECK(down->tracer.curbs()[0].height_m < -0.135f);
}

TEST_CASE(
    "curb tracer: a step from a road that falls toward it is as high as from its foot, not from what lies along it") {
  struct Fringe {
    double width_m, depth_m;
  };
  const Fringe fringe = GENERATE(Fringe{0.7, 0.014}, Fringe{0.8, 0.017}, Fringe{0.8, 0.019});
  constexpr Limits limits{.rows = 40, .cols = 40, .planes = 6, .beams = 181};
  const auto ground = [=](double x, double) {
    return x > 2.4 ? 0.12 : -fringe.depth_m * std::max(0.0, 1.0 - (2.4 - x) / fringe.width_m);
  };
  const auto stages = std::make_unique<Stages<limits>>(small_settings(40, 40));
  const float known_m2 = 1e-5f;  // as a moving robot finds it
  stages->dem.set_common(known_m2, 0.0f);
  Noise noise;
  for (const Point& p : test::sample({0, 4.0, 0, 4.0}, 0.05, 0.005, noise, ground)) stages->dem.add(p);
  stages->settle();
  stages->trace(0.0f, 2.0f);
  REQUIRE(stages->label_at(23, 20) == stages->label_at(0, 20));  // one plane
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].height_m == Approx(0.12 + fringe.depth_m).margin(0.0015));
}

TEST_CASE("curb tracer: ground that rises toward a step, as what mixes both sides does, makes it no lower") {
  const auto stages = traced(with_gutter(-0.012));
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].height_m > 0.115f);
}

TEST_CASE("curb tracer: cells beside the border that lie off their planes make the height less certain") {
  const auto flat = traced(up),
             worn = traced([](double x, double y) { return up(x, y) - (x > 1.5 && x < 1.7 ? 0.008 : 0.0); });
  REQUIRE(flat->tracer.curbs().size() == 1);
  REQUIRE(worn->tracer.curbs().size() == 1);
  CHECK(worn->tracer.curbs()[0].height_sd_m > 1.05f * flat->tracer.curbs()[0].height_sd_m);
}

TEST_CASE(
    "curb tracer: a step is as high as the ground along it, though its plane holds ground of another height too") {
  // Seen from above. A lip of 7 mm, too low to separate planes, continues one side of the corner. So the plane of
  // everything that is not road lies 1.6 mm above the lower part, and 2.4 mm below the other part where that borders
  // the road.
  //   y 2.4 +------------------+
  //         |   0.127          |
  //     1.2 +----------+ . . . +
  //         |   0      | 0.12  |
  //         +----------+-------+ x 2.4
  const float known_m2 = 1e-6f;  // even ground
  Stages<> stages(small_settings());
  stages.dem.set_common(known_m2, 0.0f);
  fill(stages.dem, [](double x, double y) { return y > 1.2 ? 0.1267 : x > 1.4 ? 0.12 : 0.0; });
  stages.settle();
  stages.trace();
  REQUIRE(stages.tracer.curbs().size() == 2);
  REQUIRE(stages.label_at(20, 2) == stages.label_at(20, 20));
  for (const Curb& curb : stages.tracer.curbs()) {
    const bool along_x = std::abs(curb.x1_m - curb.x0_m) > std::abs(curb.y1_m - curb.y0_m);
    CHECK(std::abs(curb.height_m - (along_x ? 0.1267f : 0.12f)) < (along_x ? 0.0019f : 0.0008f));
  }
}

//               .:'.    grass, 3 cm rough
//  ____________|
TEST_CASE(
    "curb tracer: a curb between a road and rough ground is told, its height less certain than beside a smooth one") {
  const auto kerb_to = [](double rough_m) {
    auto stages = std::make_unique<Stages<>>(small_settings());
    Noise noise;
    const auto ground = [&](double x, double) { return x < 1.4 ? 0.0 : 0.08 + rough_m * noise.normal(); };
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.003, noise, ground)) stages->dem.add(p);
    stages->settle();
    stages->trace();
    REQUIRE(stages->tracer.curbs().size() == 1);
    return stages->tracer.curbs()[0];
  };
  const Curb smooth = kerb_to(0.0), rough = kerb_to(0.03);
  CHECK(rough.kind == CurbKind::step_up);
  CHECK(length_m(rough) == Approx(2.4).margin(0.05));
  CHECK(rough.x0_m == Approx(1.4).margin(0.02));
  CHECK(rough.height_m == Approx(0.08).margin(2 * rough.height_sd_m));
  CHECK(smooth.height_sd_m < 0.003f);
  CHECK(rough.height_sd_m == Approx(0.03 / std::sqrt(3.0)).epsilon(0.2));
}

//  o
//  ________
//          |  .        the ground behind the shadow is cambered, and is known less well at the edge than in its middle
//          |____.--
TEST_CASE("curb tracer: a step down is no better known than its lower plane is at the edge, before the shadow") {
  const double edge = 1.12, drop = 0.232, behind = edge + 0.284;
  int steps = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    Noise noise(seed);
    stages->view = {0.0f, 1.2f, 0.54f};
    stages->dem.set_common(1e-6f, 0.0f);
    for (int k = 0; k < 24 * 24 * 16; ++k) {
      const double x = 2.4 * noise.uniform(), y = 2.4 * noise.uniform();
      if (x >= edge && (x < behind || x > behind + 0.807)) continue;
      const double z_m = x < edge ? 0.0 : -drop + 0.0666 * (x - behind) * (x - behind);
      const double error_m = 0.0008 * noise.normal();
      stages->dem.add({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z_m + error_m), 1e-4f});
    }
    stages->settle();
    stages->trace(0.0f, 1.2f);
    for (const Curb& curb : stages->tracer.curbs()) {
      if (curb.kind != CurbKind::step_down) continue;
      const Plane& below = stages->mixture.plane(curb.far_label);
      const float x = 0.5f * (curb.x0_m + curb.x1_m), y = 0.5f * (curb.y0_m + curb.y1_m);
      CHECK(square(curb.height_sd_m) > 0.05f * below.height_variance_m2(x, y));
      ++steps;
    }
  }
  CHECK(steps > 0);
}

TEST_CASE("curb tracer: a low step through the middle of cells is told as high as it is") {
  double rise_m2 = 0.0, along_m = 0.0;
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
    Stages<> stages(small_settings());
    Noise noise(seed);
    const auto ground = [](double x, double) { return x < 1.25 ? 0.0 : 0.02; };
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.008, noise, ground)) stages.dem.add(p);
    for (int pass = 0; pass < 4; ++pass) {
      stages.infer(true);
      stages.trace();
      stages.dem.add({0.05f, 0.05f, 0.0f, 1e-4f});  // some cell must be touched, otherwise planes stay as they are
    }
    for (const Curb& c : stages.tracer.curbs()) {
      rise_m2 += length_m(c) * c.height_m;
      along_m += length_m(c);
    }
  }
  CHECK(rise_m2 / along_m == Approx(0.02).margin(0.0003));
}

TEST_CASE("curb tracer: one edge is told once, though cells that it crosses bear a third plane") {
  // A table, the ramp up to it, and a pavement along both. The ramp's plane meets the face halfway up.
  const double along_x = std::cos(0.8), along_y = std::sin(0.8);
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    Stages<> stages(small_settings());
    Noise noise(seed);
    const auto ground = [=](double x, double y) {
      const double along = (x - 1.2) * along_x + (y - 1.2) * along_y,
                   beside = (y - 1.2) * along_x - (x - 1.2) * along_y;
      return beside > 0.0 ? 0.055 : along < 0.0 ? 0.0 : -0.06 * along;
    };
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.03, 0.008, noise, ground)) stages.dem.add(p);
    stages.settle();
    stages.trace(2.4f, 0.0f);
    const auto curbs = stages.tracer.curbs();
    for (const Curb& one : curbs) {
      for (const Curb& other : curbs) {
        if (&one == &other || !is_step(one) || !is_step(other) || length_m(one) > length_m(other)) continue;
        INFO(seed << ": " << one.height_m << " along " << other.height_m);
        CHECK(overlap_m(one, other, 0.1f) < length_m(one) - 0.1);
      }
    }
  }
}

TEST_CASE("curb tracer: the height of a step is less certain where few points tell it") {
  const auto deviation_m = [](int scans) {
    Stages<> stages(small_settings());
    for (int scan = 0; scan < scans; ++scan) fill(stages.dem, up);
    stages.settle();
    stages.dem.set_common(1e-8f, 1e-3f);
    stages.trace(0.0f, 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    return stages.tracer.curbs()[0].height_sd_m;
  };
  CHECK(deviation_m(1) == Approx(2.0 * deviation_m(4)).epsilon(0.1));
}

//  x ^   ===========   lines that run along the step see one side each        |   those that cross it see both, and
//    |   -----------   with errors of their own                           ----+---  their errors cancel
TEST_CASE("curb tracer: a step is as uncertain as the scan lines along it, not as those that cross it") {
  struct Found {
    double errors_m2 = 0.0, told_m2 = 0.0;
  };
  const float line_sd_m = 0.001f;
  const auto found = [&](bool along) {
    Found sum;
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
      Noise noise(seed);
      std::array<double, 24> line{};
      for (double& off_m : line) off_m = static_cast<double>(line_sd_m) * noise.normal();
      Stages<> stages(small_settings());
      fill(stages.dem, [&](double x, double y) {
        return line[static_cast<std::size_t>(10.0 * x)] + ((along ? x : y) < 1.4 ? 0.0 : 0.12);
      });
      const float points = stages.dem.cell(stages.dem.slot(0, 0)).points;
      stages.dem.set_common(1e-8f, points * line_sd_m * line_sd_m);
      stages.settle();
      stages.trace(0.0f, along ? 1.2f : 0.0f);
      const double all_m = total_length_m(stages.tracer.curbs());
      REQUIRE(all_m > 2.0);
      for (const Curb& curb : stages.tracer.curbs()) {
        sum.errors_m2 += length_m(curb) / all_m * std::pow(static_cast<double>(curb.height_m) - 0.12, 2) / 40;
        sum.told_m2 += length_m(curb) / all_m * std::pow(static_cast<double>(curb.height_sd_m), 2) / 40;
      }
    }
    return sum;
  };
  const Found along = found(true), across = found(false);
  INFO("mm: along " << 1e3 * std::sqrt(along.errors_m2) << ", told " << 1e3 * std::sqrt(along.told_m2) << "; across "
                    << 1e3 * std::sqrt(across.errors_m2) << ", told " << 1e3 * std::sqrt(across.told_m2));
  CHECK(along.errors_m2 > 20.0 * across.errors_m2);
  CHECK(along.told_m2 > 0.4 * along.errors_m2);  // 0.06 if cells erred each on its own
  CHECK(along.told_m2 < 2.0 * along.errors_m2);
  CHECK(across.told_m2 < 0.1 * along.told_m2);
}

TEST_CASE("curb tracer: of a plane of four cells, whose fit does not show it, what scan lines err is counted in full") {
  auto stages = std::make_unique<Stages<>>(small_settings());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  fill(stages->dem, [&](double x, double y) { return x < 1.2 ? 0.0 : x < 1.4 && y > 1.0 && y < 1.2 ? 0.12 : nan; });
  stages->settle();
  const auto deviation_m = [&](float line_m2) {
    stages->dem.set_common(1e-8f, line_m2);
    stages->trace(0.0f, 1.1f);
    REQUIRE(stages->tracer.curbs().size() == 1);
    return stages->tracer.curbs()[0].height_sd_m;
  };
  CHECK(deviation_m(1e-3f) > 2.0f * deviation_m(0.0f));  // if it counted as four lines or two, this would be 1.4
}

TEST_CASE("curb tracer: between planes of different slope the height is as uncertain as its place") {
  const auto with_slope = [](double slope) {
    const auto stages = traced([=](double x, double) { return x < 1.4 ? 0.0 : 0.12 + slope * (x - 1.4); });
    REQUIRE(stages->tracer.curbs().size() == 1);
    CHECK(stages->tracer.curbs()[0].kind == CurbKind::step_up);
    return stages->tracer.curbs()[0];
  };
  const Curb level = with_slope(0.0), sloped = with_slope(0.15);
  const float by_place_m2 = sloped.height_sd_m * sloped.height_sd_m - level.height_sd_m * level.height_sd_m;
  CHECK(std::sqrt(by_place_m2) == Approx(0.15f * sloped.position_sd_m).epsilon(0.1));
}

//  ____
//      ----____        40 cm, as on the flank of a dropped curb
TEST_CASE("curb tracer: where a slope leads from plane to plane a step's height is less certain than at a face") {
  const auto deviation_m = [](double length_m) {
    Stages<> stages(small_settings());
    stages.view = {-0.3f, 1.2f, 1.1f, 8.0f, 8.0f};  // seen from afar, too, where its spot would have blurred an edge
    fill(stages.dem,
         [=](double x, double) { return x < 1.1 ? 0.0 : -0.064 * std::min(1.0, (x - 1.1) / (length_m + 1e-9)); });
    stages.settle();
    stages.trace(-0.3f, 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    CHECK(stages.tracer.curbs()[0].height_m == Approx(-0.064).margin(0.005));
    return stages.tracer.curbs()[0].height_sd_m;
  };
  CHECK(deviation_m(0.0) < 0.005f);
  CHECK(deviation_m(0.4) > 0.02f);  // all but a cell of it may be ground
}

TEST_CASE("curb tracer: the wider the laser's spot, the less of a slope behind a step may be ground") {
  const auto deviation_m = [](float divergence_rad) {
    Stages<> stages(small_settings());
    stages.view = {-0.3f, 1.2f, 1.1f, 8.0f, 8.0f};
    fill(stages.dem, [](double x, double) { return x < 1.1 ? 0.0 : -0.064 * std::min(1.0, (x - 1.1) / 0.4); });
    stages.settle();  // to the same planes
    stages.view.divergence_rad = divergence_rad;
    stages.trace(-0.3f, 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    return stages.tracer.curbs()[0].height_sd_m;
  };
  CHECK(deviation_m(0.0f) > 1.1f * deviation_m(0.01f));
  CHECK(deviation_m(0.01f) > 1.1f * deviation_m(0.02f));
}

//  road / flank     seen from above: the crease between a pavement and the flank of its dropped curb runs out at the
//      /___         curb, just where the laser's sight begins; a cell from the curb it is all pavement
//     /\  pavement
TEST_CASE(
    "curb tracer: a step beside a flank's tip is less certain by what it would be lower if the flank reached it") {
  const auto into_m = [](double x, double y) { return 0.74 * (x - 1.2) - 0.67 * (y - 1.2); };
  const auto along_m = [](double x, double y) { return 0.67 * (x - 1.2) + 0.74 * (y - 1.2); };
  for (double tip_m = -1.2; tip_m < 0.0; tip_m += 0.02) {
    INFO("tip at " << tip_m);
    const auto step_m = [=](double into, double along) {
      return std::clamp(0.13 - 0.2 * (0.87 * (along - tip_m) - 0.49 * into), 0.0, 0.13);
    };
    const auto height_m = [=](double x, double y) {
      return into_m(x, y) < 0.0 ? 0.0 : step_m(into_m(x, y), along_m(x, y));
    };
    Stages<> stages(small_settings());
    Noise noise;
    for (const Point& p : test::sample({0.0, 2.4, 0.0, 2.4}, 0.01, 0.002, noise, height_m)) {
      if (p.x_m > 1.15 + 0.67 * tip_m) stages.dem.add(p);
    }
    stages.dem.set_common(1e-6f, 0.0f);
    stages.settle();
    stages.trace(0.0f, 1.2f);
    for (const Curb& curb : stages.tracer.curbs()) {
      const double x_m = 0.5 * (curb.x0_m + curb.x1_m), y_m = 0.5 * (curb.y0_m + curb.y1_m);
      if (!is_step(curb) || std::abs(into_m(x_m, y_m)) > 0.05) continue;
      CHECK(std::abs(curb.height_m) == Approx(step_m(0.0, along_m(x_m, y_m))).margin(3 * curb.height_sd_m));
    }
  }
}

TEST_CASE("curb tracer: a step that grows along its piece is as uncertain as it grows, if the localisation steps") {
  const auto deviation_m = [](double growth, bool steps) {
    const auto stages = traced([=](double x, double y) { return x < 1.4 ? 0.0 : 0.12 + growth * (y - 1.2); });
    stages->view.localisation_steps = steps;
    stages->trace();
    REQUIRE(stages->tracer.curbs().size() == 1);
    return static_cast<double>(stages->tracer.curbs()[0].height_sd_m);
  };
  const double even_m = deviation_m(0.0, true), grows_m = deviation_m(0.008, true);
  CHECK(even_m == Approx(deviation_m(0.0, false)));
  CHECK(deviation_m(0.008, false) == Approx(even_m).epsilon(0.01));
  // Uniformly distributed within the 19.2 mm by which it grows.
  CHECK(std::sqrt(grows_m * grows_m - even_m * even_m) == Approx(0.0192 / std::sqrt(12.0)).epsilon(0.02));
}

TEST_CASE("curb tracer: a step down is as high as its planes lie apart at its edge, not in its shadow") {
  const auto stages = traced([](double x, double) { return x < 1.4 ? 0.12 : 0.05 * (x - 1.4); });
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  REQUIRE(curb.kind == CurbKind::step_down);
  const double edge_m = 0.5 * static_cast<double>(curb.x0_m + curb.x1_m);
  CHECK(edge_m < 1.36);
  CHECK(curb.height_m == Approx(0.05 * (edge_m - 1.4) - 0.12).margin(0.001));
}

/// Variance of a step's position, with 24 borders in gaps of one cell of 10 cm, without the part due to the uncertainty
/// of its height. Each border may be anywhere within half a cell, and deviates by a cell's own error relative to the
/// step.
double place_variance_m2(const Stages<>& stages, const Curb& curb) {
  const double cells_m2 = 0.5 * static_cast<double>(stages.mixture.plane(curb.near_label).fit_variance_m2 +
                                                    stages.mixture.plane(curb.far_label).fit_variance_m2);
  const double step_m2 = static_cast<double>(curb.height_m * curb.height_m);
  return 0.05 * 0.05 / (3.0 * 24.0) + 0.2 * 0.1 * cells_m2 / step_m2 / 24.0;
}

TEST_CASE("curb tracer: a curb's place is known to its gaps, over the root of their number") {
  const auto stages = traced(up);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(curb.position_sd_m == Approx(std::sqrt(place_variance_m2(*stages, curb))).epsilon(0.02));
}

//      ________      scan lines run along the edge, three empty cells apart: no border shows where it lies between them
//  ____  ?
TEST_CASE("curb tracer: a step between the same two scan lines is known to all that lies between them") {
  const auto stages = traced([](double x, double y) { return x > 1.2 && x < 1.5 ? std::nan("") : up(x, y); });
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  REQUIRE(curb.kind == CurbKind::step_up);
  CHECK(curb.position_sd_m == Approx(0.3 / std::sqrt(12.0)).epsilon(0.02));  // regardless of the number of borders
}

TEST_CASE("curb tracer: a low step's place is known less well, as its height is") {
  const auto stages = traced([](double x, double) { return x < 1.4 ? 0.0 : 0.025; });
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  REQUIRE(curb.kind == CurbKind::step_up);
  // Cells of 10 cm, each deviating by half of the height's uncertainty relative to the height.
  const double others_m2 = place_variance_m2(*stages, curb), by_height_m = 0.1 * 0.5 * curb.height_sd_m / curb.height_m;
  CHECK(curb.position_sd_m == Approx(std::sqrt(others_m2 + by_height_m * by_height_m)).epsilon(0.02));
  CHECK(by_height_m > 0.001);
}

TEST_CASE("curb tracer: a sharp step has no width to tell") {
  const auto stages = traced(up);
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].face_width_m == Approx(0.0).margin(0.01));
}

TEST_CASE("curb tracer: a curb keeps its number as long as it is found, a new one gets another") {
  const auto stages = traced(up);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const auto id = stages->tracer.curbs()[0].id;
  CHECK(id > 0);
  for (int more = 0; more < 4; ++more)
    fill(stages->dem, [](double x, double) { return x < 1.4 ? 0.0 : x < 2.0 ? 0.12 : 0.18; });
  stages->settle();
  stages->trace();
  REQUIRE(stages->tracer.curbs().size() == 2);
  int same = 0;
  for (const Curb& curb : stages->tracer.curbs()) {
    same += curb.id == id;
    CHECK((curb.id == id) == (std::abs(curb.x0_m - 1.4f) < 0.05f));
  }
  CHECK(same == 1);
}

TEST_CASE("curb tracer: numbers begin anew with 1, but for those that curbs still bear") {
  // Two maps in turn; each has a curb that the other does not have, so that each trace uses a new number.
  const auto first = traced([](double x, double) { return x < 0.6 ? 0.0 : x < 1.8 ? 0.12 : 0.24; });
  const auto second = traced([](double x, double) { return x < 1.2 ? 0.0 : x < 1.8 ? 0.12 : 0.24; });
  REQUIRE(first->tracer.curbs().size() == 2);
  REQUIRE(second->tracer.curbs().size() == 2);
  CurbTracer<test::small_limits> tracer;
  tracer.init(CurbSettings{});
  int doubled = 0, none = 0, anew = 0;
  for (int trace = 0; trace < 65'600; ++trace) {
    const auto& of = trace % 2 == 0 ? first : second;
    tracer.trace(of->dem, of->mixture, of->field, of->view, of->work.curbs(), of->counters);
    doubled += tracer.curbs()[0].id == tracer.curbs()[1].id;
    for (const Curb& curb : tracer.curbs()) {
      none += curb.id == 0;
      anew += trace > 65'536 && curb.id < 100;
    }
  }
  CHECK(doubled == 0);
  CHECK(none == 0);
  CHECK(anew > 0);
}

TEST_CASE("curb tracer: a step of three cells' width is two curbs") {
  const auto stages = traced([](double x, double) { return x < 1.0 ? 0.0 : x < 1.3 ? 0.07 : 0.14; });
  REQUIRE(stages->tracer.curbs().size() == 2);
  for (const Curb& curb : stages->tracer.curbs()) CHECK(curb.height_m == Approx(0.07).margin(4 * curb.height_sd_m));
}

TEST_CASE("curb tracer: clutter makes no curb, the ground beside it does") {
  // A bush of 30 cm between the street and a step.
  Noise noise;
  auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [&](double x, double y) { return x < 0.8 ? 0.0 : y < 1.2 ? 0.3 * noise.uniform() : 0.12; });
  stages->settle();
  stages->trace();
  REQUIRE_FALSE(stages->tracer.curbs().empty());
  for (const Curb& curb : stages->tracer.curbs()) {
    CHECK(std::max(curb.y0_m, curb.y1_m) > 1.1f);
    CHECK(curb.height_m == Approx(0.12).margin(0.02));
  }
}

TEST_CASE("curb tracer: the side of a box, higher than any curb, is none, but a drop is told, however deep") {
  const auto height = [](double step_m) { return [step_m](double x, double) { return x < 1.4 ? 0.0 : step_m; }; };
  CHECK(traced(height(0.29))->tracer.curbs().size() == 1);
  CHECK(traced(height(0.32))->tracer.curbs().empty());
  for (const double drop_m : {0.32, 0.8}) {
    const auto stages = traced(height(-drop_m));
    REQUIRE(stages->tracer.curbs().size() == 1);
    CHECK(stages->tracer.curbs()[0].kind == CurbKind::step_down);
    CHECK(stages->tracer.curbs()[0].height_m == Approx(-drop_m).margin(0.005));
  }
  const auto platform = [](double x, double) { return x < 0.8 ? 0.0 : x < 1.8 ? 0.35 : 0.0; };
  CHECK(traced(platform)->tracer.curbs().empty());
}

//         ___                             ______
//     ___|   |                                  |         ___
//  __|       |                                  |        |   |
//            |_____  a landing                  |________|   |__  a wall
TEST_CASE("curb tracer: the edge of a pit is told, though the ground goes on behind it") {
  const auto pit = [](double x, double y) { return x > 0.8 && x < 1.6 && y > 0.6 && y < 1.8 ? -0.4 : 0.0; };
  const auto stages = traced(pit);
  const auto curbs = stages->tracer.curbs();
  CHECK(std::count_if(curbs.begin(), curbs.end(),
                      [](const Curb& c) { return c.height_m < -0.3f && c.x0_m < 1.0f && c.x1_m < 1.0f; }) == 1);
}

TEST_CASE("curb tracer: a drop behind steps up is told, one behind a wall is not") {
  const auto flight = traced([](double x, double) { return x < 0.6 ? 0.0 : x < 1.0 ? 0.17 : x < 1.6 ? 0.34 : -0.1; });
  const auto steps = flight->tracer.curbs();
  const auto deep = [](const Curb& curb) { return curb.height_m < -0.3f; };
  CHECK(std::count_if(steps.begin(), steps.end(), deep) == 1);
  const auto wall = traced([](double x, double) { return x < 0.8 ? 0.0 : x < 1.4 ? -0.35 : x < 2.0 ? 0.05 : -0.35; });
  REQUIRE(wall->tracer.curbs().size() == 1);
  CHECK(wall->tracer.curbs()[0].x0_m < 1.0f);
}

TEST_CASE("curb tracer: borders across a gap lie in its middle, and none across a wider one") {
  const int gap = GENERATE(4, 5);  // cells without points; the reach is 5 cells
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  for (const Point& p : test::sample({0, 1, 0, 2.4}, 0.05, 0.003, noise, [](double, double) { return 0.0; }))
    stages->dem.add(p);
  for (const Point& p :
       test::sample({1 + 0.1 * gap, 2.4, 0, 2.4}, 0.05, 0.003, noise, [](double, double) { return 0.12; }))
    stages->dem.add(p);
  stages->settle();
  stages->trace();
  if (gap == 5) {
    CHECK(stages->tracer.curbs().empty());
  } else {
    REQUIRE(stages->tracer.curbs().size() == 1);
    CHECK(stages->tracer.curbs()[0].x0_m == Approx(1.2).margin(0.01));
    CHECK(stages->tracer.curbs()[0].height_m == Approx(0.12).margin(4 * stages->tracer.curbs()[0].height_sd_m));
  }
}

//  y          |
//  |   near   |  not seen (or something else)
//  1.6        |____________
//  |   near   |  0.12 m higher
TEST_CASE("curb tracer: a curb goes on for two cells where one side is not seen, not where it is another plane") {
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
    "curb tracer: a curb that goes on tells the height of its middle, one height, and no more than a quarter of its "
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

TEST_CASE("curb tracer: the stated deviation of a height is no smaller than repeated maps show") {
  std::vector<double> heights;
  double stated = 0.0;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    Noise noise(seed);
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.05, 0.008, noise, up)) stages->dem.add(p);
    for (int pass = 0; pass < 2; ++pass) stages->infer(true);
    stages->trace();
    REQUIRE(stages->tracer.curbs().size() == 1);
    heights.push_back(stages->tracer.curbs()[0].height_m);
    stated += stages->tracer.curbs()[0].height_sd_m / 40.0;
  }
  double sum2 = 0.0;
  for (const double h : heights) sum2 += (h - 0.12) * (h - 0.12);
  CHECK(stated > 0.8 * std::sqrt(sum2 / 40.0));
}

TEST_CASE("curb tracer: cells whose label outlives its plane make no curb") {
  const auto stages = traced([](double x, double) { return x < 1.4 ? -0.015 : 0.015; });
  REQUIRE(stages->tracer.curbs().size() == 1);
  stages->mixture.init(small_settings().planes);
  stages->trace(0.0f, 0.0f);
  CHECK(stages->tracer.curbs().empty());
}

TEST_CASE("curb tracer: the place of a crease is known to its gaps, of an edge that is all hidden to one of them") {
  const auto ramp = traced([](double x, double) { return x < 1.2 ? 0.0 : 0.3 * (x - 1.2); });
  REQUIRE(ramp->tracer.curbs().size() == 1);
  REQUIRE(ramp->tracer.curbs()[0].kind == CurbKind::ramp_edge);
  CHECK(ramp->tracer.curbs()[0].position_sd_m == Approx(0.05 / std::sqrt(3.0 * 24.0)).epsilon(0.02));
  const auto hidden = traced(behind_box(-1.0, 9.0), 0.0f, 1.2f);  // from 1.1 m to 1.5 m, a gap of 50 cm
  REQUIRE(hidden->tracer.curbs().size() == 1);
  CHECK(hidden->tracer.curbs()[0].position_sd_m == Approx(0.25 / std::sqrt(3.0)).epsilon(0.02));
}

//  o
//  ________            the laser sees the edge and readings that mix it with the road behind, nothing more
//          -_
TEST_CASE("curb tracer: of a brink, and of the end of a face, all borders err alike, and as much may be hidden again") {
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

TEST_CASE("curb tracer: the variance of a step's height is that of both planes in the middle of its piece") {
  const auto stages = traced(up, 0.0f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  const double of_planes_m2 =
      static_cast<double>(stages->mixture.plane(curb.near_label).height_variance_m2(1.4f, 1.2f) +
                          stages->mixture.plane(curb.far_label).height_variance_m2(1.4f, 1.2f));
  CHECK(curb.height_sd_m > 0.99 * std::sqrt(of_planes_m2));
  CHECK(curb.height_sd_m < 1.02 * std::sqrt(of_planes_m2));  // and a little for its position: slopes differ by rounding
}

TEST_CASE("curb tracer: between planes of different slope the height is as uncertain as its place, along y, too") {
  const auto with_slopes = [](double before, double behind) {
    const auto stages =
        traced([=](double, double y) { return y < 1.4 ? before * (y - 1.4) : 0.12 + behind * (y - 1.4); }, 1.2f, 0.0f);
    REQUIRE(stages->tracer.curbs().size() == 1);
    CHECK(stages->tracer.curbs()[0].kind == CurbKind::step_up);
    return stages->tracer.curbs()[0];
  };
  const Curb level = with_slopes(0.0, 0.0);
  for (const auto& [before, behind] : {std::pair{0.0, 0.15}, {-0.15, 0.0}, {0.1, -0.05}}) {
    const Curb sloped = with_slopes(before, behind);
    const float by_place_m2 = sloped.height_sd_m * sloped.height_sd_m - level.height_sd_m * level.height_sd_m;
    CHECK(std::sqrt(by_place_m2) == Approx(0.15f * sloped.position_sd_m).epsilon(0.1));
  }
}

TEST_CASE("curb tracer: the probability of a curb is that of the cells beside it, of a low one in noise below 1") {
  const auto mean_probability = [](double step_m, double noise_m) {
    double sum = 0.0, along_m = 0.0;
    for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
      Stages<> stages(small_settings());
      Noise noise(seed);
      const auto ground = [=](double x, double) { return x < 1.2 ? 0.0 : step_m; };
      for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.05, noise_m, noise, ground)) stages.dem.add(p);
      stages.settle();
      stages.trace(0.0f, 1.2f);
      for (const Curb& curb : stages.tracer.curbs()) {
        sum += length_m(curb) * curb.probability;
        along_m += length_m(curb);
      }
    }
    REQUIRE(along_m > 2.4);
    return sum / along_m;
  };
  CHECK(mean_probability(0.12, 0.003) > 0.9999);
  const double low = mean_probability(0.025, 0.008);
  CHECK(low > 0.9);
  CHECK(low < 0.9995);
}

TEST_CASE(
    "curb tracer: a step down is as high as its planes lie apart at its edge, of any slope, along y, from below") {
  const auto ground = [](double, double y) { return y < 1.4 ? 0.12 + 0.06 * (y - 1.4) : 0.04 * (y - 1.4); };
  for (const float robot_y_m : {0.0f, 2.3f}) {
    auto stages = std::make_unique<Stages<>>(small_settings());
    stages->dem.look_from(1.2f, 0.0f);
    fill(stages->dem, ground);
    stages->settle();
    stages->dem.look_from(1.2f, robot_y_m);
    stages->trace(1.2f, robot_y_m);
    REQUIRE(stages->tracer.curbs().size() == 1);
    const Curb& curb = stages->tracer.curbs()[0];
    REQUIRE(curb.kind == (robot_y_m > 1.4f ? CurbKind::step_up : CurbKind::step_down));
    const double edge_m = 0.5 * static_cast<double>(curb.y0_m + curb.y1_m);
    CHECK(edge_m < 1.36);
    CHECK(std::abs(curb.height_m) == Approx(0.12 + 0.02 * (edge_m - 1.4)).margin(0.0006));
    CHECK(curb.face_width_m >= 0.0f);
  }
}

TEST_CASE("curb tracer: ground beside a step down is carried on to the near end of the step's shadow") {
  const auto stages = traced_gutter(0.02, 2.3f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(curb.kind == CurbKind::step_down);
  const double edge_m = 0.5 * static_cast<double>(curb.x0_m + curb.x1_m);
  CHECK(curb.height_m == Approx(-0.12 - 0.1 * (edge_m - 1.2)).margin(0.001));
}

TEST_CASE("curb tracer: a step that grows along x is cut into pieces of which the height holds, from either plane") {
  const auto grows = [](double of_low, double of_high) {
    const auto stages =
        traced([=](double x, double y) { return y < 1.4 ? of_low * x : 0.06 + of_high * x; }, 1.2f, 0.0f);
    for (const Curb& curb : stages->tracer.curbs())
      CHECK(std::abs(curb.x1_m - curb.x0_m) * std::abs(of_high - of_low) < 0.026);
    return stages->tracer.curbs().size();
  };
  CHECK(grows(0.0, 0.05) >= 6);
  CHECK(grows(-0.05, 0.0) >= 6);
  CHECK(grows(0.04, 0.04) == 1);
}

//  y  near  |   not seen, at one end of the edge, whichever way it runs
//  |  near  |____
//  |  near  |  0.12 m higher
TEST_CASE("curb tracer: a curb goes on for two cells where one side is not seen at either end, along x and y") {
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

TEST_CASE("curb tracer: an edge along x lies before its shadow from where it was seen, wherever the robot is by now") {
  auto stages = std::make_unique<Stages<>>(small_settings());
  const double hidden_m = 2.0 * 0.12 / (1.0 - 0.12);
  stages->dem.look_from(1.2f, -0.8f);
  Noise noise;
  for (const Point& p :
       test::sample({0.0, 2.4, 0.0, 2.4}, 0.02, 0.005, noise, [](double, double y) { return y < 1.2 ? 0.12 : 0.0; })) {
    if (p.y_m < 1.2f || p.y_m > 1.2 + hidden_m) stages->dem.add(p);
  }
  stages->settle();
  for (const float robot_y_m : {-0.8f, 0.9f, 1.9f}) {
    stages->dem.look_from(1.2f, robot_y_m);
    stages->trace(1.2f, robot_y_m);
    REQUIRE(stages->tracer.curbs().size() == 1);
    CHECK(stages->tracer.curbs()[0].y0_m == Approx(1.2).margin(0.015));
    CHECK(stages->tracer.curbs()[0].y1_m == Approx(1.2).margin(0.015));
  }
}

TEST_CASE("curb tracer: a robot on a table is told its drops, however high the table is") {
  for (const double map_m : {0.0, 4.0}) {
    for (const bool turned : {false, true}) {
      const auto told = [=](double robot_m) {
        Stages<> stages(small_settings());
        stages.view.z_m = static_cast<float>(map_m + 1.4);
        fill(stages.dem, [=](double x, double y) {
          const double along = turned ? y : x;
          return map_m + (along > 0.8 && along < 1.6 ? 0.35 : 0.0);
        });
        stages.settle();
        stages.trace(turned ? 1.2f : static_cast<float>(robot_m), turned ? static_cast<float>(robot_m) : 1.2f);
        for (const Curb& curb : stages.tracer.curbs()) CHECK(curb.kind == CurbKind::step_down);
        return stages.tracer.curbs().size();
      };
      CHECK(told(1.2) == 2);
      CHECK(told(0.2) == 0);
      CHECK(told(2.3) == 0);
    }
  }
}

TEST_CASE("curb tracer: a step of which the window holds a single row of the far side is told") {
  const auto stages =
      traced([](double x, double y) { return x < 1.4              ? 0.0
                                             : y > 1.0 && y < 1.1 ? 0.12
                                                                  : std::nan(""); }, 0.0f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].kind == CurbKind::step_up);
  CHECK(length_m(stages->tracer.curbs()[0]) == Approx(0.1).margin(0.01));
}

TEST_CASE("curb tracer: in the map frame both ends of a curb lie where they are") {
  Settings settings = small_settings();
  settings.window.origin_x_m = -10.0f;
  settings.window.origin_y_m = 30.0f;
  const auto stages = traced([](double, double y) { return y < 31.0 ? 0.0 : 0.12; }, 1.2f, 0.0f, settings);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(std::min(curb.x0_m, curb.x1_m) == Approx(-10.0).margin(0.02));
  CHECK(std::max(curb.x0_m, curb.x1_m) == Approx(-7.6).margin(0.02));
  CHECK(curb.y0_m == Approx(31.0).margin(0.01));
  CHECK(curb.y1_m == Approx(31.0).margin(0.01));
}

TEST_CASE("curb tracer: an oblique face is as wide as across it") {
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

TEST_CASE("curb tracer: a number goes to one curb of the same kind within two cells of its earlier position") {
  const auto first = traced([](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  CurbTracer<test::small_limits> tracer;
  const auto ids_on = [&](Stages<>& stages) {
    tracer.init(CurbSettings{});
    tracer.trace(first->dem, first->mixture, first->field, first->view, first->work.curbs(), first->counters);
    REQUIRE(tracer.curbs().size() == 1);
    REQUIRE(tracer.curbs()[0].id == 1);
    tracer.trace(stages.dem, stages.mixture, stages.field, stages.view, stages.work.curbs(), stages.counters);
    std::vector<int> ids;
    for (const Curb& curb : tracer.curbs()) ids.push_back(curb.id);
    std::sort(ids.begin(), ids.end());
    return ids;
  };
  CHECK(ids_on(*traced([](double x, double) { return x < 1.3 ? 0.0 : 0.12; })) == std::vector{1});
  CHECK(ids_on(*traced([](double x, double) { return x < 1.5 ? 0.0 : 0.12; })) == std::vector{2});
  CHECK(ids_on(*traced([](double x, double) { return x < 1.2 ? 0.0 : 0.3 * (x - 1.2); })) == std::vector{2});
  const auto ids = ids_on(*traced([](double x, double y) { return x < 1.2 ? 0.0 : y < 1.2 ? 0.08 : 0.16; }));
  CHECK(ids.size() >= 2);  // each has its own
  CHECK(std::adjacent_find(ids.begin(), ids.end()) == ids.end());
}

TEST_CASE("curb tracer: full stores refuse and count") {
  constexpr Limits few{.rows = 24, .cols = 24, .planes = 6, .borders = 30, .curbs = 1};
  const auto stages = traced<few>([](double x, double) { return x < 0.8 ? 0.0 : x < 1.6 ? 0.12 : 0.3; });
  CHECK(stages->tracer.curbs().size() == 1);
  CHECK(stages->counters.borders_full == 48 - 30);
  CHECK(stages->counters.curbs_full > 0);
}

}  // namespace
}  // namespace curbline
