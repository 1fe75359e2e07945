// The map as a whole.
#include "map/map.hpp"

#include <catch2/catch.hpp>

namespace curbline::tools {
namespace {

TEST_CASE("map: a map that is moved has its planes where its cells are") {
  Map map;
  map.grid = {.x0_m = 1, .y0_m = 2, .rows = 1, .cols = 1};
  map.cells = {{.x_m = 1.02, .y_m = 2.07, .height_m = 0.5, .points = 3}};
  map.planes = {{.z0_m = 0.1, .sx = 0.25, .sy = -0.5}};
  map.curbs = {{.x0_m = 1, .y0_m = 2, .x1_m = 1.1, .y1_m = 2.1, .height_m = 0.12}};
  move(map, {1000, -2000, 400});
  CHECK(map.grid.x0_m == 1001);
  CHECK(map.grid.y_m(0) == Approx(-1997.95));
  CHECK(map.cells[0].x_m == Approx(1001.02));
  CHECK(map.cells[0].y_m == Approx(-1997.93));
  CHECK(map.cells[0].height_m == Approx(400.5));
  const MapPlane& plane = map.planes[0];
  CHECK(plane.z0_m + plane.sx * 1001 + plane.sy * -1998 == Approx(400 + 0.1 + 0.25 * 1 - 0.5 * 2));
  CHECK(map.curbs[0].x1_m == Approx(1001.1));
  CHECK(map.curbs[0].y0_m == Approx(-1998));
  CHECK(map.curbs[0].height_m == 0.12);
}

TEST_CASE("map: a part of a curb is as high as the curb is there, up or down") {
  const MapCurb curb{.x0_m = 1, .y0_m = 2, .x1_m = 5, .y1_m = 2, .height_m = 0.03, .kind = "step_up", .rise_m = 0.08};
  const MapCurb end = part_of(curb, {0.75, 1.0}), middle = part_of(curb, {0.25, 0.75}), start = part_of(curb, {0, 0.2});
  CHECK(end.x0_m == Approx(4));
  CHECK(end.height_m == Approx(0.06));
  CHECK(end.rise_m == Approx(0.02));
  CHECK(middle.height_m == Approx(0.03));
  CHECK(start.height_m == Approx(-0.002));
  CHECK(end.kind == "step_up");
  CHECK(start.kind == "step_down");
  CHECK(part_of({.x1_m = 4, .kind = "crease"}, {0, 0.2}).kind == "crease");
}

}  // namespace
}  // namespace curbline::tools
