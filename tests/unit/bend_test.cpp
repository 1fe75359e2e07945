// Bent ground that two planes follow, told from planes that meet at a crease or a step.
#include "curbline/bend.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <vector>

#include "curbline/plane_evidence.hpp"
#include "support/moments.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

using test::Noise;
using test::of_points;

//   __-----__       a road of 4 m, cut in halves at x = 2, 1.2 m or all of it seen beyond
//  -         -
struct Halves {
  std::vector<Point> before, behind;
};

template <typename Height>
Halves halves(Height&& height_m, double width_m = 2.0) {
  Noise noise;
  return {test::sample({0, 2, 0, 4}, 0.1, 0.005, noise, height_m),
          test::sample({2, 2 + width_m, 0, 4}, 0.1, 0.005, noise, height_m)};
}

Bend bend_of(const Halves& road, const BorderRise& border = {}) {
  return PlaneEvidence{}.bend(of_points(road.before), of_points(road.behind), border);
}

/// Do the points of both halves, each a cell of its own, follow their bend?
bool follow(const Halves& road, float noise_m2 = PlanePrior{}.noise_m2) {
  const Bend bend = bend_of(road);
  REQUIRE(bend.any());
  BendTally tally(bend);
  for (const auto& points : {road.before, road.behind}) {
    const PlaneMoments moments = of_points(points);
    const Plane plane = fit_plane(moments, PlanePrior{});
    for (const Point& p : points) tally.add(test::of_point(p), plane, tally.square_m2(moments));
  }
  return tally.bent(noise_m2);
}

TEST_CASE("bend: planes of a bent surface tell how and along which way it is bent, whatever it leans") {
  const double lean = GENERATE(0.0, 0.08);
  const Bend bend = bend_of(halves([=](double x, double y) { return lean * (x - y) - 0.01 * (x - 2.0) * (x - 2.0); }));
  CHECK(bend.curvature_1_m == Approx(-0.02).margin(0.002));
  CHECK(std::abs(bend.dx) == Approx(1.0).margin(0.01));
  CHECK(bend.dy == Approx(0.0).margin(0.1));
}

TEST_CASE("bend: planes that a low step parts follow no bent surface, nor do those that meet at more than usual") {
  const auto bent = [](double x, double) { return -0.01 * (x - 2.0) * (x - 2.0); };
  CHECK(bend_of(halves(bent), {40.0f, 0.1f, 0.0f, 0.0f}).any());
  CHECK_FALSE(bend_of(halves(bent), {40.0f, 0.1f, 0.0f, 0.015f}).any());
  CHECK_FALSE(bend_of(halves(bent), {40.0f, 0.1f, 0.0f, -0.015f}).any());
  CHECK_FALSE(bend_of(halves([&](double x, double y) { return bent(x, y) + (x < 2.0 ? 0.0 : 0.03); })).any());
  CHECK_FALSE(bend_of(halves([](double x, double) { return x < 2.0 ? 0.0 : 0.1 * (x - 2.0); })).any());
}

TEST_CASE("bend: of a few cells, of which the slope may be open, nothing is told") {
  const Halves road = halves([](double x, double) { return -0.01 * (x - 2.0) * (x - 2.0); });
  const auto bends = [&](std::size_t cells) {
    const std::vector<Point> few(road.behind.begin(), road.behind.begin() + static_cast<std::ptrdiff_t>(cells));
    return PlaneEvidence{}.bend(of_points(road.before), of_points(few), {}).any() ||
           PlaneEvidence{}.bend(of_points(few), of_points(road.before), {}).any();
  };
  CHECK(bends(40));
  CHECK_FALSE(bends(19));
}

TEST_CASE("bend: cells follow what is bent, up or down, not planes that meet as steeply") {
  const double width_m = GENERATE(1.2, 2.0), sign = GENERATE(1.0, -1.0);
  CHECK(follow(halves([=](double x, double) { return sign * 0.007 * (x - 2.0) * (x - 2.0); }, width_m)));
  CHECK_FALSE(follow(halves([=](double x, double) { return sign * 0.012 * std::abs(x - 2.0); }, width_m)));
}

TEST_CASE("bend: what heights err by may look bent: it has to be sure") {
  const Halves road = halves([](double x, double) { return 0.007 * (x - 2.0) * (x - 2.0); });
  CHECK(follow(road, square(0.01f)));
  CHECK_FALSE(follow(road, square(0.03f)));
}

}  // namespace
}  // namespace curbline
