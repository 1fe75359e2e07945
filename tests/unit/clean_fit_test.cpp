// The fit of one plane to clean cells. Which cells are clean, on whole maps: plane_mixture_test.cpp.
#include "curbline/planes/clean_fit.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/terrain.hpp"

namespace curbline {
namespace {

/// A cell of so many points of weight 1 with this spread about its mean.
Cell cell_of(int points, double sd_m, test::Noise& noise) {
  Cell cell;
  for (int k = 0; k < points; ++k) cell.add(0.0f, 0.0f, static_cast<float>(sd_m * noise.normal()), 1.0f);
  return cell;
}

/// The moments of a cell at (x, y) whose points are all at one height.
PlaneMoments moments_at(double x_m, double y_m, double z_m, float points = 10.0f) {
  PlaneMoments cell;
  cell.cells = 1.0f;
  cell.points = cell.weight = points;
  cell.x = static_cast<float>(x_m);
  cell.y = static_cast<float>(y_m);
  cell.z = static_cast<float>(z_m);
  return cell;
}

constexpr float expected_m2 = 1e-4f;  // of the noise

TEST_CASE("clean fit: grass is as rough as its blades, though a third of its cells hold a step") {
  test::Noise noise;
  for (const int points : {8, 30}) {
    CleanFit fit;
    for (int k = 0; k < 400; ++k) fit.look_at(cell_of(points, k % 3 == 0 ? 0.1 : 0.02, noise));
    // 4 cm^2, of which the noise is 1; cells of a step have no precision to speak of, but take a third of the weight.
    CHECK(fit.rough_m2(expected_m2) == Approx(1.5 * 4e-4 - 1e-4).epsilon(0.15));
  }
}

TEST_CASE("clean fit: ground that spreads no more than noise, or whose cells have few points, is not rough") {
  test::Noise noise;
  CleanFit even, sparse;
  for (int k = 0; k < 100; ++k) {
    even.look_at(cell_of(30, 0.009, noise));
    sparse.look_at(cell_of(5, 0.05, noise));
  }
  CHECK(even.rough_m2(expected_m2) == 0.0f);
  CHECK(sparse.rough_m2(expected_m2) == 0.0f);
}

/// The level of a strip of 40 clean cells, with so many more beside a step of 10 cm, all 5 cm too high.
float level_m(int beside) {
  CleanFit fit;
  fit.cells = 40.0f;
  fit.points = 400.0f;
  for (int k = 0; k < 40; ++k) fit.add(moments_at(0.1 * (k % 10), 0.1 * (k / 10), 0.0), 10.0f, 0.0f);
  for (int k = 0; k < beside; ++k) fit.add(moments_at(0.1 * (k % 10), 0.4, 0.05), 10.0f, 0.1f);
  Plane plane;
  fit.fit(plane, PlanePrior{}, 1e-5f, 4.0f);
  return plane.height_m(0.45f, 0.2f);
}

TEST_CASE("clean fit: cells beside a step, which are too high all alike, move a plane no more the more there are") {
  CHECK(level_m(0) == Approx(0.0).margin(1e-6));
  CHECK(level_m(10) < 0.001f);
  CHECK(level_m(20) == Approx(level_m(10)).margin(0.0003));
}

TEST_CASE("clean fit: three cells replace no plane, unless one has too many points to hold both sides of a step") {
  const auto level_after = [](float points) {
    CleanFit fit;
    fit.cells = 3.0f;
    fit.points = 3.0f * points;
    for (const double x_m : {0.0, 0.1, 0.2}) fit.add(moments_at(x_m, 0.05 * x_m, 0.0, points), points, 0.0f);
    Plane plane{.z_m = 0.02f, .cells = 6.0f};
    fit.fit(plane, PlanePrior{}, 1e-5f, 4.0f);
    return plane.z_m;
  };
  CHECK(level_after(5.0f) == 0.02f);
  CHECK(level_after(6.0f) == Approx(0.0).margin(1e-6));
}

}  // namespace
}  // namespace curbline
