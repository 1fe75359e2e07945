// The plane under a cell's middle, according to the side of a curb on which it lies.
#include "curbline/curbs/ground_label.hpp"

#include <catch2/catch.hpp>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::small_limits;
using test::Stages;

//          near    |    far        readings change at x = 1.4, as the laser sees them
//  ______________
//                |______________
//  0            1.4              2.4
class GroundLabelTest {
 public:
  GroundLabelTest() : stages_(test::small_settings()) {
    test::fill(stages_.dem, [](double x, double) { return x < 1.4 ? 0.0 : -0.12; });
    stages_.settle();
    near_ = stages_.label_at(0, 0);
    far_ = stages_.label_at(23, 0);
    REQUIRE(near_ != far_);
  }

  /// A step at x, from y = 0.5 to 2. Its near side, on the right of its direction, is that of lower x.
  Curb step_at(float x_m) const {
    Curb curb;
    curb.x0_m = curb.x1_m = x_m;
    curb.y0_m = 2.0f;
    curb.y1_m = 0.5f;
    curb.height_m = -0.12f;
    curb.kind = CurbKind::step_down;
    curb.near_label = near_;
    curb.far_label = far_;
    return curb;
  }
  Label at(int i, int j, std::span<const Curb> curbs) const {
    return ground_label(stages_.dem, stages_.mixture, stages_.field, curbs, i, j);
  }
  Label at(int i, int j, const Curb& curb) const { return at(i, j, std::span(&curb, 1)); }

 protected:
  Stages<small_limits> stages_;
  Label near_, far_;
};

TEST_CASE_METHOD(GroundLabelTest,
                 "ground label: the ground under a cell is of the side of the step that its middle is on") {
  const Curb before = step_at(1.32f), beyond = step_at(1.48f);
  CHECK(at(13, 10, before) == far_);  // its middle is at 1.35
  CHECK(at(12, 10, before) == near_);
  CHECK(at(14, 10, beyond) == near_);
  CHECK(at(15, 10, beyond) == far_);
}

TEST_CASE_METHOD(GroundLabelTest, "ground label: where no step is near, readings tell it") {
  CHECK(at(13, 10, std::span<const Curb>{}) == near_);
  CHECK(at(13, 2, step_at(1.32f)) == near_);   // beyond its end
  CHECK(at(13, 10, step_at(1.10f)) == near_);  // more than two cells away
  Curb crease = step_at(1.32f);
  crease.kind = CurbKind::crease;
  CHECK(at(13, 10, crease) == near_);
  Curb brink = step_at(1.32f);
  brink.far_label = no_label;
  CHECK(at(13, 10, brink) == near_);
}

TEST_CASE_METHOD(GroundLabelTest,
                 "ground label: the nearer of two steps tells it, and none that parts other planes or dead ones") {
  const Curb steps[] = {step_at(1.30f), step_at(1.36f)}, other_way_round[] = {steps[1], steps[0]};
  CHECK(at(13, 10, steps) == near_);
  CHECK(at(13, 10, other_way_round) == near_);
  Label dead = 0;
  while (stages_.mixture.plane(dead).alive()) ++dead;
  Curb other = step_at(1.32f);
  other.near_label = other.far_label = dead;
  CHECK(at(13, 10, other) == near_);
  other.near_label = near_;
  CHECK(at(13, 10, other) == near_);
}

TEST_CASE_METHOD(GroundLabelTest, "ground label: of a cell that is not seen there is none") {
  Stages<small_limits> unseen(test::small_settings());
  CHECK(ground_label(unseen.dem, unseen.mixture, unseen.field, {}, 3, 3) == no_label);
}

TEST_CASE("ground label: the ground under a cell is told wherever the window lies, of steps along x as well") {
  Settings settings = test::small_settings();
  settings.window.origin_x_m = -10.0f;
  settings.window.origin_y_m = 30.0f;
  Stages<small_limits> stages(settings);
  test::fill(stages.dem, [](double, double y) { return y < 31.4 ? 0.0 : -0.12; });
  stages.settle();
  const Label near = stages.label_at(0, 0), far = stages.label_at(0, 23);
  REQUIRE(near != far);
  const auto at = [&](int j, float step_y_m) {
    Curb curb{.x0_m = -9.5f, .y0_m = step_y_m, .x1_m = -8.0f, .y1_m = step_y_m, .kind = CurbKind::step_down};
    curb.near_label = near;
    curb.far_label = far;
    return ground_label(stages.dem, stages.mixture, stages.field, std::span<const Curb>(&curb, 1), 10, j);
  };
  CHECK(at(13, 31.32f) == far);  // its middle is at 31.35
  CHECK(at(13, 31.37f) == near);
  CHECK(at(12, 31.32f) == near);
  CHECK(at(14, 31.48f) == near);
  CHECK(at(12, 31.07f) == far);   // 18 cm away
  CHECK(at(12, 31.03f) == near);  // more than two cells
}

}  // namespace
}  // namespace curbline
