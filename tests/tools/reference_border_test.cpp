// The reference's curbs, which are borders between labels, from maps made by hand.
#include "reference/border.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

namespace curbline::tools::reference::testing {
namespace {

/// Cells of 1 m from (1, 1) with these labels, row by row; -1: no points.
Map map_of(int rows, int cols, const std::vector<int>& labels, const std::vector<MapPlane>& planes) {
  Map map;
  map.grid = {1, 1, 1, 1, rows, cols};
  map.planes = planes;
  for (const int label : labels) map.cells.push_back({0, 0, 0, 1e-4, label < 0 ? 0 : 4, label, 1});
  return map;
}

MapPlane level(double z_m, int label) {
  return {z_m, 0, 0, 0.01, label};
}

bool is(const MapCurb& c, double x0, double y0, double x1, double y1) {
  return c.x0_m == x0 && c.y0_m == y0 && c.x1_m == x1 && c.y1_m == y1;
}

//   x = 3 ..  .  1  1  1     the dot is a cell without points
//   x = 2 ..  0  0  1  1
//   x = 1 ..  0  0  0  0
//             y = 1 .. 4
TEST_CASE("reference borders: edges join along a line and end at corners and empty cells") {
  auto curbs = borders(map_of(3, 4, {0, 0, 0, 0, 0, 0, 1, 1, -1, 1, 1, 1}, {level(0, 0), level(0.1, 1)}));
  REQUIRE(curbs.size() == 3);
  CHECK(is(curbs[0], 2, 3, 2, 5));
  CHECK(is(curbs[1], 3, 2, 3, 3));
  CHECK(is(curbs[2], 2, 3, 3, 3));
}

TEST_CASE("reference borders: an edge between other labels begins a new piece") {
  const auto curbs = borders(map_of(2, 3, {0, 0, 0, 1, 1, 2}, {level(0, 0), level(0.1, 1), level(0.2, 2)}));
  REQUIRE(curbs.size() == 3);
  CHECK(is(curbs[0], 2, 1, 2, 3));
  CHECK(curbs[0].height_m == Approx(0.1));
  CHECK(is(curbs[1], 2, 3, 2, 4));
  CHECK(curbs[1].height_m == Approx(0.2));
}

TEST_CASE("reference borders: the height is the planes' difference in the middle, its sd that of both") {
  const auto curbs = borders(map_of(2, 2, {0, 0, 1, 1}, {{0, 0, 0, 0.03, 0}, {0.1, 0, 0.05, 0.04, 1}}));
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].height_m == Approx(0.1 + 0.05 * 2));
  CHECK(curbs[0].height_sd_m == Approx(0.05));
  CHECK(curbs[0].kind == "step_up");
}

TEST_CASE("reference borders: seen from the origin a lower far side is a step down, on either side of it") {
  Map map = map_of(1, 2, {0, 1}, {level(0.1, 0), level(0, 1)});
  CHECK(borders(map)[0].kind == "step_down");
  CHECK(borders(map)[0].height_m == Approx(-0.1));
  map.grid.y0_m = -4;  // now cell 0 is the far one
  CHECK(borders(map)[0].kind == "step_up");
  CHECK(borders(map)[0].height_m == Approx(0.1));
}

TEST_CASE("reference borders: planes that meet anywhere between the cells' centres make a crease") {
  for (const double fold_x : {1.6, 2.0, 2.4}) {
    const auto curbs = borders(map_of(2, 1, {0, 1}, {{0, 0, 0, 0.001, 0}, {-0.3 * fold_x, 0.3, 0, 0.001, 1}}));
    INFO("fold at " << fold_x);
    REQUIRE(curbs.size() == 1);
    CHECK(curbs[0].kind == "crease");
  }
}

TEST_CASE("reference borders: a step within two sd is a crease, one beyond is a step") {
  const auto kind_of = [](double z_m) { return borders(map_of(1, 2, {0, 1}, {level(0, 0), level(z_m, 1)}))[0].kind; };
  CHECK(kind_of(0.028) == "crease");  // its sd is 0.0141
  CHECK(kind_of(0.029) == "step_up");
}

TEST_CASE("reference borders: nothing is known of the height where a label has no plane") {
  const auto curbs = borders(map_of(1, 2, {0, 7}, {level(0, 0)}));
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].height_m == 0);
  CHECK(curbs[0].height_sd_m == 1);
}

TEST_CASE("reference borders: one label has none") {
  CHECK(borders(map_of(2, 2, {3, 3, 3, 3}, {level(0, 3)})).empty());
}

}  // namespace
}  // namespace curbline::tools::reference::testing
