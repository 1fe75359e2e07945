// Where a robot may drive.
#include "curbline/passability.hpp"

#include <catch2/catch.hpp>

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
  for (int pass = 0; pass < 3; ++pass) stages.infer(true);
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

TEST_CASE("passability: ground that nobody has seen is not passable") {
  Stages<small_limits> stages(small_settings());
  CHECK_FALSE(passable(stages.dem, stages.mixture, stages.field, 3, 3, {1.0f, 1.0f}));
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

}  // namespace
}  // namespace curbline
