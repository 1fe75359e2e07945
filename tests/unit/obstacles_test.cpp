// What an obstacle hides from the laser. Which planes are obstacles, on whole maps: ground_test.cpp.
#include "curbline/planes/obstacles.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <memory>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::small_limits;
using test::small_settings;

constexpr Label road{0}, beyond{1}, thing{2};

/// The road up to road_end_m, other ground beyond it, and at x = 1.0 m, y = 1.2 m a thing of 0.2 x 0.2 m that is so
/// high. Does it hide the cell (i, j) of the other ground from a laser 1 m above (0, laser_y_m)?
bool hidden_behind(double thing_m, int i, int j, float laser_y_m = 1.2f, double road_end_m = 1.2) {
  const auto dem = std::make_unique<Dem<small_limits>>();
  dem->init(small_settings().window, PlanePrior{});
  const auto on_thing = [](double x, double y) { return x > 1.0 && x < 1.2 && y > 1.1 && y < 1.3; };
  fill(*dem, [=](double x, double y) { return on_thing(x, y) && static_cast<int>(x * 100) % 10 < 5 ? thing_m : 0.0; });
  const auto labels = std::make_unique<CellLabels<small_limits>>();
  std::array<Plane, small_limits.planes> planes{};
  for (int k = 0; k < 24 * 24; ++k) {
    const double x = 0.1 * (k / 24) + 0.05, y = 0.1 * (k % 24) + 0.05;
    (*labels)[dem->slot(k / 24, k % 24)] = on_thing(x, y) ? thing : x < road_end_m ? road : beyond;
  }
  for (const Label label : {road, beyond, thing}) {
    planes[label].cells = label == thing ? 4.0f : 286.0f;
    planes[label].variance_m2 = label == thing ? static_cast<float>(0.25 * thing_m * thing_m) : 1e-4f;
    planes[label].pxx = planes[label].pyy = 0.05f;
  }
  const Viewpoint view{0.0f, laser_y_m, 1.0f};
  const Obstacles<small_limits> obstacles(*dem, planes, view, *labels);
  REQUIRE(obstacles.ground() == planes.data());  // the first of two that are equally large
  return obstacles.hides(i, j, beyond);
}

//      |
//  o   |        seen from above the laser looks along y = 1.2 m
TEST_CASE("obstacles: a post hides what lies behind it in the laser's sight, not what lies beside that") {
  CHECK(hidden_behind(1.0, 15, 12));
  CHECK(hidden_behind(1.0, 23, 12));
  CHECK_FALSE(hidden_behind(1.0, 15, 16));
  CHECK_FALSE(hidden_behind(1.0, 15, 12, 0.2f));
}

TEST_CASE("obstacles: what has ground of another plane before it is not hidden: readings there mix no edge with it") {
  CHECK_FALSE(hidden_behind(1.0, 15, 12, 1.2f, 1.3));
}

TEST_CASE("obstacles: a thing as low as a curb hides nothing") {
  CHECK_FALSE(hidden_behind(0.15, 15, 12));
}

}  // namespace
}  // namespace curbline
