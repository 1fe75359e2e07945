// The curb that a robot meets first, among several and from several poses.
#include "curbline/curbs/curb_ahead.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

using namespace curbline;

TEST_CASE("curb ahead: the nearest of those that reach into the way, at the point where they do") {
  const auto curb = [](float x0, float y0, float x1, float y1, float height) {
    Curb c{};
    c.x0_m = x0, c.y0_m = y0, c.x1_m = x1, c.y1_m = y1;
    c.height_m = height, c.height_sd_m = 0.01f, c.probability = 0.9f, c.kind = CurbKind::step_up;
    return c;
  };
  const Curb across = curb(3.0f, -2.0f, 3.0f, 2.0f, 0.12f), beside = curb(0.5f, 0.6f, 6.0f, 0.6f, 0.1f);
  const Curb other_side = curb(0.5f, -0.6f, 6.0f, -0.6f, 0.1f);
  const Curb slanting = curb(5.0f, 0.0f, 3.0f, 1.0f, 0.08f), behind = curb(-1.0f, -2.0f, -1.0f, 2.0f, 0.2f);
  CHECK_FALSE(nearest_ahead({}, Pose{}, 0.5f));
  CHECK_FALSE(nearest_ahead(std::array{beside, other_side, behind}, Pose{}, 0.5f));
  const auto all = nearest_ahead(std::array{beside, other_side, slanting, behind, across}, Pose{}, 0.5f);
  REQUIRE(all);
  CHECK(all->distance_m == 3.0f);
  CHECK(all->height_m == 0.12f);
  const auto at_edge = nearest_ahead(std::array{slanting}, Pose{}, 0.5f);
  REQUIRE(at_edge);
  CHECK(at_edge->distance_m == Approx(4.0f));
  CHECK(at_edge->lateral_m == Approx(0.5f));
  const auto from_behind = nearest_ahead(std::array{curb(-1.0f, 0.1f, 4.0f, 0.1f, 0.1f)}, Pose{}, 0.5f);
  REQUIRE(from_behind);
  CHECK(from_behind->distance_m == Approx(0.0f).margin(1e-6));
}

TEST_CASE("curb ahead: the gutter before a curb does not hide it, alone it is told") {
  Curb gutter{}, kerb{}, ramp{};
  gutter.x0_m = gutter.x1_m = 0.5f, kerb.x0_m = kerb.x1_m = 0.6f, ramp.x0_m = ramp.x1_m = 0.8f;
  for (Curb* curb : {&gutter, &kerb, &ramp}) curb->y0_m = -1.0f, curb->y1_m = 1.0f;
  kerb.height_m = 0.12f, kerb.kind = CurbKind::step_up, ramp.kind = CurbKind::ramp_edge;
  for (const auto& curbs : {std::array{gutter, kerb, ramp}, std::array{ramp, kerb, gutter}}) {
    const auto ahead = nearest_ahead(curbs, Pose{}, 0.5f);
    REQUIRE(ahead);
    CHECK(ahead->kind == CurbKind::step_up);
    CHECK(ahead->height_m == 0.12f);
    CHECK(ahead->distance_m == 0.6f);
  }
  const auto alone = nearest_ahead(std::array{ramp, gutter}, Pose{}, 0.5f);
  REQUIRE(alone);
  CHECK(alone->kind == CurbKind::crease);
}

TEST_CASE("curb ahead: of a robot that drives it is told in the base frame, curbs being in the map frame") {
  Curb across{};  // 2 m ahead of a robot at (10, 5) that heads along y
  across.x0_m = 8.0f, across.y0_m = 7.0f, across.x1_m = 12.0f, across.y1_m = 7.2f;
  const Pose pose{.x_m = 10.0f, .y_m = 5.0f, .qz = std::sqrt(0.5f), .qw = std::sqrt(0.5f)};
  const auto ahead = nearest_ahead(std::array{across}, pose, 0.5f);
  REQUIRE(ahead);
  CHECK(ahead->distance_m == Approx(2.075f));
  CHECK(ahead->lateral_m == Approx(0.5f));
}
