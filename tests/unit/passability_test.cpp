// Where a robot may drive.
#include "curbline/curbs/passability.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::small_limits;
using test::small_settings;
using test::Stages;

template <typename Height>
bool cell_passable(Height&& height_m, int i, const Mobility& mobility) {
  Stages<small_limits> stages(small_settings());
  fill(stages.dem, height_m);
  stages.settle();
  return passable(stages.dem, stages.mixture, stages.field, i, 12, mobility);
}

TEST_CASE("passability: a cell on the level is passable, one beside a step only for a robot that takes the step") {
  const auto step = [](double x, double) { return x < 1.4 ? 0.0 : 0.12; };
  CHECK(cell_passable(step, 5, {0.05f, 0.1f}));
  CHECK(cell_passable(step, 20, {0.05f, 0.1f}));
  for (const int i : {13, 14}) {
    CHECK_FALSE(cell_passable(step, i, {0.05f, 0.1f}));
    CHECK(cell_passable(step, i, {0.15f, 0.1f}));
  }
}

TEST_CASE("passability: a cell that holds a step within is not passable") {
  const auto step = [](double x, double) { return x < 1.45 ? 0.0 : 0.12; };
  CHECK_FALSE(cell_passable(step, 14, {0.05f, 0.1f}));
}

TEST_CASE("passability: a slope is passable up to its angle") {
  const auto slope = [](double x, double) { return 0.1 * x; };  // 5.7 degrees
  CHECK(cell_passable(slope, 12, {0.05f, 0.11f}));
  CHECK_FALSE(cell_passable(slope, 12, {0.05f, 0.09f}));
}

TEST_CASE("passability: what a slope rises by within a cell is no step") {
  const auto slope = [](double x, double) { return 0.5 * x; };  // 5 cm a cell
  CHECK(cell_passable(slope, 12, {0.01f, 0.6f}));
  const auto stone = [=](double x, double y) { return slope(x, y) + (x > 1.25 && x < 1.3 ? 0.06 : 0.0); };
  CHECK_FALSE(cell_passable(stone, 12, {0.01f, 0.6f}));
}

TEST_CASE("passability: ground that nobody has seen is not passable") {
  Stages<small_limits> stages(small_settings());
  CHECK_FALSE(passable(stages.dem, stages.mixture, stages.field, 3, 3, {1.0f, 1.0f}));
}

TEST_CASE("passability: what turns out to be no ground is not passable, also while its cells wait for other labels") {
  Settings settings = small_settings();
  settings.labels.max_messages = directions * 24;  // of one row of cells
  Stages<small_limits> stages(settings);
  // A veil for a laser 1 m up, a slope for a higher one.
  fill(stages.dem, [](double x, double) { return x < 1.2 || x > 1.8 ? 0.0 : 1.0 - x / 1.8; });
  stages.view.z_m = 3.0f;
  stages.settle();
  const auto passable_cells = [&] {
    int cells = 0;
    for (int i = 13; i < 17; ++i) cells += passable(stages.dem, stages.mixture, stages.field, i, 12, {0.3f, 0.6f});
    return cells;
  };
  CHECK(passable_cells() == 4);
  stages.view.z_m = 1.0f;
  stages.dem.add({0.05f, 0.05f, 0.0f, 1e-4f});
  stages.segment();
  stages.mix();
  CHECK(passable_cells() == 0);  // as between two lines: labels follow with the next
  stages.label(false);
  CHECK(passable_cells() == 0);
}

TEST_CASE("passability: a curb is crossed if it is low enough for sure, a ramp's edge if the ramp is not too steep") {
  Plane level, ramp;
  level.cells = ramp.cells = 100.0f;
  ramp.slope_x = 0.1f;
  const Curb step{.height_m = -0.04f, .height_sd_m = 0.004f, .kind = CurbKind::step_down};
  CHECK(passable(step, level, level, {0.05f, 0.0f}));
  CHECK_FALSE(passable(step, level, level, {0.045f, 0.0f}));
  const Curb edge{.kind = CurbKind::ramp_edge};
  CHECK(passable(edge, level, ramp, {0.0f, 0.11f}));
  CHECK_FALSE(passable(edge, level, ramp, {0.0f, 0.09f}));
}

TEST_CASE("passability: a plane is passable up to its angle in any direction, one that has died is not") {
  const auto on = [](float slope_x, float slope_y, float cells = 100.0f) {
    Plane plane;
    plane.cells = cells;
    plane.slope_x = slope_x;
    plane.slope_y = slope_y;
    return plane;
  };
  const Mobility up_to_45_degrees{0.05f, 0.7854f};
  for (const float sign : {-1.0f, 1.0f}) {
    CHECK(passable(on(sign * 0.98f, 0.0f), up_to_45_degrees));
    CHECK(passable(on(0.0f, sign * 0.98f), up_to_45_degrees));
    CHECK_FALSE(passable(on(sign * 1.02f, 0.0f), up_to_45_degrees));
    CHECK_FALSE(passable(on(0.0f, sign * 1.02f), up_to_45_degrees));
    CHECK_FALSE(passable(on(sign * 0.8f, 0.8f), up_to_45_degrees));
  }
  CHECK_FALSE(passable(on(0.0f, 0.0f, 0.0f), up_to_45_degrees));
  const Curb edge{.kind = CurbKind::ramp_edge}, up{.height_m = 0.04f, .height_sd_m = 0.004f, .kind = CurbKind::step_up};
  CHECK_FALSE(passable(edge, on(0.2f, 0.0f), on(0.0f, 0.0f), {0.0f, 0.1f}));
  CHECK_FALSE(passable(edge, on(0.0f, 0.0f), on(0.2f, 0.0f), {0.0f, 0.1f}));
  CHECK(passable(up, on(0.0f, 0.0f), on(0.0f, 0.0f), {0.049f, 0.0f}));
  CHECK_FALSE(passable(up, on(0.0f, 0.0f), on(0.0f, 0.0f), {0.047f, 0.0f}));
}

TEST_CASE("passability: a step beside a cell is in the way on any side of it, across a cell that is not seen, too") {
  const int to_x = GENERATE(-1, 0, 1), to_y = GENERATE(-1, 0, 1);
  if ((to_x == 0) == (to_y == 0)) return;
  const auto beside = [=](int away) {
    Stages<small_limits> stages(small_settings());
    const auto at = [](double m, int cell) { return static_cast<int>(m * 10.0) == cell; };
    fill(stages.dem, [=](double x, double y) {
      for (int k = 1; k < away; ++k) {
        if (at(x, 12 + k * to_x) && at(y, 12 + k * to_y)) return std::nan("");
      }
      return at(x, 12 + away * to_x) && at(y, 12 + away * to_y) ? 0.12 : 0.0;
    });
    stages.settle();
    const auto& s = stages;
    CHECK(passable(s.dem, s.mixture, s.field, 12, 12, {0.15f, 0.1f}));
    return passable(s.dem, s.mixture, s.field, 12, 12, {0.05f, 0.1f});
  };
  CHECK_FALSE(beside(1));
  CHECK_FALSE(beside(2));
  CHECK(beside(3));
}

TEST_CASE("passability: a step is not passable in two parts, by way of a cell of readings that mix both sides") {
  const double share = GENERATE(0.3, 0.5, 0.7);  // ____-~~~~
  const bool up = GENERATE(true, false);
  const auto step = [=](double x, double) {
    const double climbed = x < 1.3 ? 0.0 : x < 1.4 ? share : 1.0;
    return 0.12 * (up ? climbed : -climbed);
  };
  const auto across = [&](float max_step_m) {
    return cell_passable(step, 12, {max_step_m, 0.1f}) && cell_passable(step, 13, {max_step_m, 0.1f}) &&
           cell_passable(step, 14, {max_step_m, 0.1f});
  };
  CHECK_FALSE(across(0.09f));
  CHECK(across(0.13f));
  CHECK(cell_passable(step, 11, {0.09f, 0.1f}));
  CHECK(cell_passable(step, 15, {0.09f, 0.1f}));
}

TEST_CASE("passability: a curb goes through the cells on its line, and those within two deviations of its place") {
  const double angle = GENERATE(0.0, 0.6, 1.5708, 2.3);
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  Curb curb{.x0_m = 1.0f, .y0_m = 2.0f, .x1_m = 1.0f + 2.0f * c, .y1_m = 2.0f + 2.0f * s};
  const auto through = [&](float along_m, float aside_m) {
    return crosses(curb, 1.0f + along_m * c - aside_m * s, 2.0f + along_m * s + aside_m * c, 0.05f, 0.05f);
  };
  CHECK(through(1.0f, 0.04f));
  CHECK(through(0.0f, -0.04f));
  CHECK_FALSE(through(1.0f, 0.08f));
  CHECK_FALSE(through(2.2f, 0.0f));
  curb.position_sd_m = 0.02f;
  CHECK(through(1.0f, 0.08f));
  CHECK_FALSE(through(1.0f, -0.12f));
}

TEST_CASE(
    "passability: a line's direction is uncertain, too, so that it may go through cells farther off at its ends") {
  const Curb curb{.x1_m = 1.0f, .position_sd_m = 0.02f};
  const auto through = [&](float x_m, float y_m) { return crosses(curb, x_m, y_m, 0.05f, 0.05f); };
  for (const float sign : {-1.0f, 1.0f}) {
    CHECK(through(0.5f, sign * 0.08f));
    CHECK_FALSE(through(0.5f, sign * 0.1f));
    for (const float x_m : {0.05f, 0.95f}) {
      CHECK(through(x_m, sign * 0.12f));
      CHECK_FALSE(through(x_m, sign * 0.14f));
    }
  }
}

TEST_CASE("passability: what spreads within a cell by more than the step is in the way, noise is not") {
  const auto with_spread = [](double spread_m, float max_step_m) {
    Stages<small_limits> stages(small_settings());
    fill(stages.dem, [](double, double) { return 0.0; });
    for (int k = 0; k < 400; ++k) {
      stages.dem.add({1.23f + 0.0001f * static_cast<float>(k), 1.25f,
                      static_cast<float>(spread_m * ((k % 20) / 19.0 - 0.5)), 1e-4f});
    }
    stages.settle();
    return passable(stages.dem, stages.mixture, stages.field, 12, 12, {max_step_m, 0.1f});
  };
  CHECK(with_spread(0.03, 0.02f));  // the laser has noise of 1 cm
  CHECK(with_spread(0.16, 0.17f));
  CHECK_FALSE(with_spread(0.16, 0.13f));
}

}  // namespace
}  // namespace curbline
