// Curbs from labels: where they are, which way they run, and what is not a curb.
#include "curbline/curbs/curb_tracer.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "support/traced_curbs.hpp"

namespace curbline {
namespace {

using test::fill;
using test::length_m;
using test::Noise;
using test::small_settings;
using test::Stages;
using test::total_length_m;
using test::traced;
using test::up;

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

//  B B B B   A part b of the pavement B, lower or higher than that, meets the road A. The curb on both sides of it is
//  no B b b B   single one that reaches over it, and for which the piece before b would be a duplicate: a step of 12 cm
//  was A A A A   told as one of 4 cm.
TEST_CASE("curb tracer: a curb does not reach over a part of another height, which is told as high as it is") {
  const double part_m = GENERATE(0.2, 0.3, 0.4), part_z_m = GENERATE(0.04, 0.12);
  const bool along_x = GENERATE(false, true);
  INFO("a part of " << part_m << " m, " << part_z_m << " m high");
  const auto ground = [=](double across, double along) {
    const bool in_part = across < 2.1 && along > 1.0 && along < 1.0 + part_m;
    return across < 1.4 ? 0.0 : in_part ? part_z_m : 0.16 - part_z_m;
  };
  const auto stages = traced([=](double x, double y) { return along_x ? ground(y, x) : ground(x, y); });
  double told_m = 0.0;
  for (const Curb& curb : stages->tracer.curbs()) {
    const double across0 = along_x ? curb.y0_m : curb.x0_m, across1 = along_x ? curb.y1_m : curb.x1_m;
    if (std::abs(across0 - 1.4) > 0.05 || std::abs(across1 - 1.4) > 0.05) continue;
    const double along0 = along_x ? curb.x0_m : curb.y0_m, along1 = along_x ? curb.x1_m : curb.y1_m;
    const double in_part_m = std::min(std::max(along0, along1), 1.0 + part_m) - std::max(std::min(along0, along1), 1.0);
    INFO("from " << along0 << " to " << along1 << ", " << curb.height_m);
    if (curb.height_m == Approx(part_z_m).margin(0.01)) {
      told_m += in_part_m;
    } else {
      CHECK(in_part_m < 0.06);
    }
  }
  CHECK(told_m == Approx(part_m).margin(0.02));
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
    tracer.trace(of->dem, of->mixture, of->field, of->view, of->latency, of->work.curbs(), of->counters);
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

//  y      / nothing       where ground ends along y, askew to the grid: a laser on its upper side looks over the edge.
//   o    /                 One to the left would see the face below it: what falls there mixes the two
//       / ground  o
TEST_CASE(
    "curb tracer: a drop of which nothing is seen is hidden from a laser on its upper side only, when it was seen") {
  Stages<> stages(small_settings());
  stages.dem.look_from(2.0f, 0.5f);
  fill(stages.dem, [](double, double) { return 0.0; });
  stages.settle();
  const CurbSettings settings{};
  std::vector<Border> borders;
  for (const float x_m : {0.85f, 0.95f, 1.05f, 1.15f}) {
    Border brink{};
    brink.x_m = x_m;
    brink.y_m = 1.2f + 3.0f * (x_m - 1.0f);
    brink.probability = 1.0f;
    brink.half_gap_m = 0.05f;
    brink.drop_m = 0.1f;
    brink.one = stages.label_at(0, 0);
    brink.other = no_label;
    brink.axis = 1;
    brink.sign = 1;
    borders.push_back(brink);
  }
  const std::vector<Border::Index> chain{0, 1, 2, 3};
  const auto seen_from = [&](float x_m) {
    const Viewpoint view{x_m, 0.5f, 1.2f};
    const CurbStages<test::small_limits> seen{stages.dem, stages.mixture, stages.field, view, stages.latency, settings};
    return CurbMaker<test::small_limits>(seen).make(ChainPart(borders.data(), chain, {true, true}));
  };
  const std::optional<Curb> drop = seen_from(2.0f);
  REQUIRE(drop);
  CHECK(drop->kind == CurbKind::step_down);
  CHECK(drop->height_m == Approx(-0.1f).margin(0.01));
  CHECK_FALSE(seen_from(0.0f));
  stages.dem.look_from(0.0f, 0.5f);
  CHECK(seen_from(0.0f));  // a robot that has driven over the edge since it saw it
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

TEST_CASE("curb tracer: a number goes to one curb of the same kind within two cells of its earlier position") {
  const auto first = traced([](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  CurbTracer<test::small_limits> tracer;
  const auto ids_on = [&](Stages<>& stages) {
    tracer.init(CurbSettings{});
    tracer.trace(first->dem, first->mixture, first->field, first->view, first->latency, first->work.curbs(),
                 first->counters);
    REQUIRE(tracer.curbs().size() == 1);
    REQUIRE(tracer.curbs()[0].id == 1);
    tracer.trace(stages.dem, stages.mixture, stages.field, stages.view, stages.latency, stages.work.curbs(),
                 stages.counters);
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
