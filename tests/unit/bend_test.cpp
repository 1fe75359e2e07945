// What the cells of two planes show: is the ground bent from one to the other, or creased between them?
#include "curbline/curbs/bend.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "support/moments.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

using test::Noise;
using test::of_points;

constexpr float noise_m2 = square(0.005f);

//   __-----__       a road of 4 m, cut into halves at x = 2
//  -         -
struct Halves {
  std::vector<Point> before, behind;
};

template <typename Height>
Halves halves(Height&& height_m) {
  Noise noise;
  return {test::sample({0, 2, 0, 4}, 0.1, 0.005, noise, height_m),
          test::sample({2, 4, 0, 4}, 0.1, 0.005, noise, height_m)};
}

Plane plane_of(const std::vector<Point>& points) {
  return fit_plane(of_points(points), PlanePrior{});
}

Bend bend_of(const Halves& road) {
  return Bend::between(plane_of(road.before), plane_of(road.behind));
}

BendSums sums_of(const std::vector<Point>& points) {
  const Plane plane = plane_of(points);
  BendSums sums;
  for (const Point& p : points) sums.add(p.x_m - plane.x_m, p.y_m - plane.y_m, p.z_m - plane.height_m(p.x_m, p.y_m));
  return sums;
}

float likelier_bent(const std::vector<Point>& points, const Bend& bend, float variance_m2 = noise_m2) {
  return sums_of(points).likelier_bent(bend, variance_m2);
}

/// For cells of one point each with errors of `sd_m`.
bool one_bend(const Halves& road, float sd_m = 0.005f) {
  Plane before = plane_of(road.before), behind = plane_of(road.behind);
  before.fit_variance_m2 = behind.fit_variance_m2 = square(sd_m);
  return one_bend(before, sums_of(road.before), behind, sums_of(road.behind));
}

TEST_CASE("bend: planes of a bent surface tell how and along which way it is bent, whatever it leans") {
  const double lean = GENERATE(0.0, 0.08), curvature_1_m = GENERATE(-0.02, 0.02);
  const Bend bend =
      bend_of(halves([=](double x, double y) { return lean * (x - y) + 0.5 * curvature_1_m * (x - 2.0) * (x - 2.0); }));
  CHECK(bend.curvature_1_m == Approx(curvature_1_m).margin(0.002));
  CHECK(std::abs(bend.dx) == Approx(1.0).margin(0.01));
  CHECK(bend.dy == Approx(0.0).margin(0.1));
}

TEST_CASE(
    "bend: both halves of what is bent say so, up or down, and of what is creased as steeply that they are even") {
  const double sign = GENERATE(1.0, -1.0);
  const Halves bent = halves([=](double x, double) { return sign * 0.01 * (x - 2.0) * (x - 2.0); });
  const Halves creased = halves([=](double x, double) { return sign * 0.02 * std::abs(x - 2.0); });
  CHECK(std::abs(bend_of(creased).curvature_1_m) == Approx(std::abs(bend_of(bent).curvature_1_m)).margin(0.002));
  for (const auto& half : {bent.before, bent.behind}) CHECK(likelier_bent(half, bend_of(bent)) > 4.5f);
  for (const auto& half : {creased.before, creased.behind}) CHECK(likelier_bent(half, bend_of(creased)) < -4.5f);
}

TEST_CASE("bend: a half that is bent along another way is no part of it") {
  const Halves road = halves([](double x, double) { return 0.01 * (x - 2.0) * (x - 2.0); });
  Bend along = bend_of(road);
  CHECK(likelier_bent(road.before, along) > 4.5f);
  along.dx = 0.0f, along.dy = 1.0f;
  CHECK(likelier_bent(road.before, along) < -4.5f);
}

TEST_CASE("bend: it is told alike along the axes and across them") {
  // Points of a disc, bent along the direction `turn`.
  const auto of_disc = [](double turn) {
    const double across_x = std::cos(turn), across_y = std::sin(turn);
    BendSums sums;
    for (int i = -20; i <= 20; ++i) {
      for (int j = -20; j <= 20; ++j) {
        if (i * i + j * j > 410) continue;
        const double x = 0.05 * i, y = 0.05 * j, way = x * across_x + y * across_y;
        sums.add(static_cast<float>(x), static_cast<float>(y), static_cast<float>(0.01 * way * way));
      }
    }
    return sums.likelier_bent({static_cast<float>(across_x), static_cast<float>(across_y), 0.02f}, noise_m2);
  };
  const double turn = GENERATE(0.5, 0.785, 1.2, 1.571, 2.5);
  CHECK(of_disc(turn) == Approx(of_disc(0.0)).epsilon(0.02));
}

TEST_CASE("bend: the noisier the cells, the less they say, without one nothing is said") {
  const Halves road = halves([](double x, double) { return 0.01 * (x - 2.0) * (x - 2.0); });
  const Bend bend = bend_of(road);
  CHECK(likelier_bent(road.before, bend, 4 * noise_m2) == Approx(0.25f * likelier_bent(road.before, bend)));
  CHECK(BendSums{}.likelier_bent(bend, noise_m2) == 0.0f);
}

TEST_CASE("bend: two planes follow one if their cells are sure of it") {
  const Halves road = halves([](double x, double) { return 0.004 * (x - 2.0) * (x - 2.0); });
  CHECK(one_bend(road));
  CHECK_FALSE(one_bend(road, 0.05f));
  CHECK_FALSE(one_bend(halves([](double x, double) { return 0.008 * std::abs(x - 2.0); })));
}

//  _--          the slope changes within the left half as it does from its middle to that of the right one
//     --__
TEST_CASE("bend: a bent plane and a flat one share no bend, however certain the bent one is") {
  const Halves road =
      halves([](double x, double) { return x < 2.0 ? -0.02 * (x - 1.0) * (x - 1.0) : -0.02 - 0.04 * (x - 2.0); });
  const float sd_m = 0.003f;
  REQUIRE(likelier_bent(road.before, bend_of(road), square(sd_m)) > 4.5f);
  CHECK_FALSE(one_bend(road, sd_m));
}

TEST_CASE("bend: a plane that says hardly anything is no objection, one that is flat for certain is") {
  Plane plane, other;
  plane.fit_variance_m2 = other.fit_variance_m2 = noise_m2;
  other.x_m = 1.0f;
  other.slope_x = 0.02f;
  const BendSums bent = sums_of(halves([](double x, double) { return 0.01 * (x - 2.0) * (x - 2.0); }).before);
  const auto few = [](float middle_m) {  // three cells, bent the other way
    BendSums sums;
    for (const float x_m : {-0.3f, 0.0f, 0.3f}) sums.add(x_m, 0.0f, x_m == 0.0f ? middle_m : -0.5f * middle_m);
    return sums;
  };
  CHECK(one_bend(plane, bent, other, few(0.005f)));  // as far as chance takes a cell
  CHECK_FALSE(one_bend(plane, bent, other, few(0.02f)));
}

TEST_CASE("bend: parallel planes follow none, nor do those of which no cell is seen alone") {
  Plane plane, other;
  plane.fit_variance_m2 = other.fit_variance_m2 = noise_m2;
  other.x_m = 1.0f;
  const BendSums bent = sums_of(halves([](double x, double) { return 0.01 * (x - 2.0) * (x - 2.0); }).before);
  CHECK_FALSE(one_bend(plane, bent, other, bent));
  other.slope_x = 0.02f;
  CHECK(one_bend(plane, bent, other, bent));
  CHECK_FALSE(one_bend(plane, BendSums{}, other, BendSums{}));
}

}  // namespace
}  // namespace curbline
