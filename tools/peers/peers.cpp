#include "peers/peers.hpp"

namespace curbline::tools::peers {

Map map_cloud(std::span<const Point3> cloud, const Grid& grid, double max_height_m, Method method) {
  const reference::Dem dem = reference::make_dem(cloud, grid, max_height_m);
  Map map;
  map.grid = grid;
  map.cells.resize(grid.cells());
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) {
      const reference::DemCell& cell = dem.cells[grid.at(i, j)];
      if (cell.points == 0) continue;
      map.cells[grid.at(i, j)] = {grid.x_m(i), grid.y_m(j), cell.height_m, cell.variance_m2(), cell.points, -1, 0};
    }
  }
  map.curbs = method == Method::canny ? canny_curbs(dem) : gradient_curbs(dem);
  return map;
}

}  // namespace curbline::tools::peers
