// What lies in a polygon.
#include <catch2/catch.hpp>

#include "map/polygon.hpp"

namespace curbline::tools {
namespace {

//   (0,2)____(1,2)
//    |        |
//    |      (1,1)____(2,1)
//    |________________|
const Polygon corner{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};

TEST_CASE("polygon: a notch is outside, either way round") {
  const Polygon turned(corner.rbegin(), corner.rend());
  for (const Polygon& polygon : {corner, turned}) {
    CHECK(contains(polygon, {0.5, 1.5}));
    CHECK(contains(polygon, {1.5, 0.5}));
    CHECK_FALSE(contains(polygon, {1.5, 1.5}));
    CHECK_FALSE(contains(polygon, {-0.1, 1.0}));
    CHECK_FALSE(contains(polygon, {2.1, 0.5}));
  }
}

TEST_CASE("polygon: a line through a corner is crossed once") {
  const Polygon diamond{{1, 0}, {2, 1}, {1, 2}, {0, 1}};
  CHECK(contains(diamond, {0.5, 1}));
  CHECK_FALSE(contains(diamond, {-0.5, 1}));
  CHECK_FALSE(contains(diamond, {2.5, 1}));
}

}  // namespace
}  // namespace curbline::tools
