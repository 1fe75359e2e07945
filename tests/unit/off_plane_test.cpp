// What the cells beside a border show about a side of a step: that its ground deviates from its plane, or how wrong the
// plane may be.
#include "curbline/curbs/off_plane.hpp"

#include <catch2/catch.hpp>

namespace curbline {
namespace {

TEST_CASE("off plane: the ground beside a border is carried on to it") {
  Plane plane;
  plane.fit_variance_m2 = 1e-6f;
  const Beside beside = Beside::of({-0.010f, 4.0f}, {-0.004f, 4.0f}, 1.0f);  // falls by 6 mm a cell
  CHECK(deviation(beside, plane, -1.0f, 0.0f, 0.0f, 0.0f).away_m == Approx(0.016));
  CHECK(deviation(beside, plane, -1.0f, 0.5f, 0.0f, 0.0f).away_m == Approx(0.019));
  Beside two = beside;
  two.add(beside);
  CHECK(deviation(two, plane, -1.0f, 0.0f, 0.0f, 0.0f).away_m == Approx(0.016));
}

TEST_CASE("off plane: of a deviation from the plane the share is the ground's that chance does not explain") {
  Plane plane;
  plane.fit_variance_m2 = 1e-6f;  // of the two cells, with weights 2 and -1: 5e-6
  Beside beside = Beside::of({0.010f, 4.0f}, {0.010f, 4.0f}, 1.0f);
  float common_m2 = 0.0f, line_m2 = 0.0f;
  const auto seen = [&] { return deviation(beside, plane, 1.0f, 0.0f, common_m2, line_m2); };
  CHECK(seen().share() == Approx(0.95));  // 1 - 5e-6 / 1e-4
  CHECK(static_cast<double>(seen().height_variance_m2(seen().share())) == Approx(0.95 * 5e-6).margin(0.0));
  beside.add(beside);
  CHECK(seen().share() == Approx(0.975));  // of two borders half the variance
  common_m2 = 4e-5f;                       // half of it is common to both
  CHECK(seen().share() == Approx(0.775));
  CHECK(static_cast<double>(seen().height_variance_m2(seen().share())) == Approx(0.775 * 2.25e-5).margin(0.0));
  common_m2 = 2e-4f;
  CHECK(seen().share() == 0.0f);
  common_m2 = 0.0f;
  line_m2 = 1.6e-5f;  // 4 points a cell: 4e-6, of both rows 5 times as much
  CHECK(seen().share() == Approx(0.775));
  CHECK(deviation(beside, plane, -1.0f, 0.0f, 0.0f, 0.0f).share() == 0.0f);  // toward the other side: it may be mixed
  CHECK(deviation(Beside{}, plane, 1.0f, 0.0f, 0.0f, 0.0f).share() == 0.0f);
}

TEST_CASE("off plane: a plane may be wrong beside a border by up to half of its cells' deviation beyond chance") {
  Plane plane;
  plane.fit_variance_m2 = 1e-6f;
  const auto lying = [&](float off_m) {
    return deviation(Beside::of({off_m, 4.0f}, {off_m, 4.0f}, 1.0f), plane, 1.0f, 0.0f, 0.0f, 0.0f);
  };
  CHECK(lying(-0.006f).height_variance_m2(0.0f) == Approx((3.6e-5 - 4 * 5e-6) / 12));
  CHECK(lying(0.004f).too_far_m2(1.0f) == 0.0f);  // the other side is below
  CHECK(lying(-0.02f).height_variance_m2(0.0f) == Approx((4e-4 - 4 * 5e-6) / 12));
  CHECK(lying(-0.02f).too_far_m2(1.0f) == Approx(4e-4 - 5e-6));
  CHECK(lying(-0.004f).height_variance_m2(0.0f) == 0.0f);  // within chance
  CHECK(lying(-0.002f).too_far_m2(1.0f) == 0.0f);
  CHECK(deviation(Beside{}, plane, 1.0f, 0.0f, 0.0f, 0.0f).height_variance_m2(0.0f) == 0.0f);
}

TEST_CASE("off plane: what the cells beside one border say is no doubt about all the others") {
  Plane plane;
  plane.fit_variance_m2 = 1e-6f;
  const Deviation one = deviation(Beside::of({-0.058f, 4.0f}, {-0.058f, 4.0f}, 1.0f), plane, 1.0f, 0.0f, 0.0f, 0.0f);
  CHECK(one.too_far_m2(10.0f) == Approx(0.1 * (0.058 * 0.058 - 5e-6)));
  CHECK(deviation(Beside{}, plane, 1.0f, 0.0f, 0.0f, 0.0f).too_far_m2(10.0f) == 0.0f);
}

TEST_CASE("off plane: cells along a border tell how far the ground lies off its plane, less two deviations of chance") {
  Plane plane;
  plane.fit_variance_m2 = 1e-6f;
  const GroundAlong ground = GroundAlong::of(4.0f, 4.0f, 4 * 0.002f, plane);
  CHECK(static_cast<double>(ground.variance_m2) == Approx(0.25e-6 + 4e-6).margin(0.0));  // and 2 mm
  CHECK(ground.share == Approx(0.75));  // 1 - 4 * 0.25 / 2^2
  CHECK(ground.above_m == Approx(0.0015));
  CHECK(GroundAlong::of(4.0f, 4.0f, -4 * 0.002f, plane).above_m == Approx(-0.0015));
  CHECK(GroundAlong::of(4.0f, 4.0f, 4 * 0.00099f, plane).above_m == 0.0f);
  CHECK(GroundAlong::of(4.0f, 4.0f, 4 * 0.00099f, plane).share == 0.0f);
  CHECK(GroundAlong::of(0.0f, 0.0f, 0.0f, plane).share == 0.0f);
}

TEST_CASE("off plane: four cells behind each border tell the ground's height there no better than one would") {
  Plane plane;
  plane.fit_variance_m2 = 1e-6f;
  const GroundAlong one = GroundAlong::of(12.0f, 12.0f, 12 * 0.002f, plane);
  const GroundAlong four = GroundAlong::of(12.0f, 3.0f, 12 * 0.002f, plane);
  CHECK(four.above_m == one.above_m);
  CHECK(four.share == one.share);
  const float off_m2 = square(0.002f);
  CHECK(four.variance_m2 - off_m2 == Approx(4.0f * (one.variance_m2 - off_m2)));
}

}  // namespace
}  // namespace curbline
