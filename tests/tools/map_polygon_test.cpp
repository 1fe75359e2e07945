// Which points and parts of segments lie in a polygon.
#include <catch2/catch.hpp>
#include <cmath>

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

TEST_CASE("polygon: of a segment counts what lies in the rectangle, none of one beside it") {
  const Bounds box{0, 0, 2, 1};
  const Share through = share_in(box, {-1, 0.5}, {3, 0.5});
  CHECK(through.from == Approx(0.25));
  CHECK(through.to == Approx(0.75));
  const Share within = share_in(box, {0.5, 0.5}, {1, 0.75});
  CHECK(within.from == 0.0);
  CHECK(within.to == 1.0);
  CHECK_FALSE(share_in(box, {-1, 1.5}, {3, 1.5}).any());
  CHECK_FALSE(share_in(box, {-1, 0.5}, {1, 2.6}).any());
  CHECK(crosses(box, {2, -1}, {2, 2}));
  CHECK_FALSE(crosses(box, {2.1, -1}, {2.1, 2}));
  const double nan = std::nan("");
  for (const Point2 end : {Point2{nan, 0.5}, Point2{0.5, nan}}) {
    CHECK_FALSE(crosses(box, {1, 0.5}, end));
    CHECK_FALSE(crosses(box, end, {1, 0.5}));
  }
}

}  // namespace
}  // namespace curbline::tools
