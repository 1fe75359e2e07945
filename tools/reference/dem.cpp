#include "reference/dem.hpp"

#include <cmath>

namespace curbline::tools::reference {
namespace {

void add(DemCell& cell, double z) {
  ++cell.points;
  const double innovation = z - cell.height_m;
  cell.height_m += innovation / cell.points;
  cell.squares_m2 += innovation * (z - cell.height_m);
}

void link_neighbours(Dem& dem) {
  const std::size_t none = dem.valid.size();
  std::vector<std::size_t> number(dem.cells.size(), none);
  for (std::size_t v = 0; v < dem.valid.size(); ++v) number[dem.valid[v]] = v;
  for (int i = 0; i < dem.grid.rows; ++i) {
    for (int j = 0; j < dem.grid.cols; ++j) {
      const std::size_t a = number[dem.grid.at(i, j)];
      if (a == none) continue;
      if (i + 1 < dem.grid.rows && number[dem.grid.at(i + 1, j)] != none)
        dem.edges.push_back({a, number[dem.grid.at(i + 1, j)]});
      if (j + 1 < dem.grid.cols && number[dem.grid.at(i, j + 1)] != none)
        dem.edges.push_back({a, number[dem.grid.at(i, j + 1)]});
    }
  }
}

}  // namespace

std::array<double, 3> Dem::phi(std::size_t v) const {
  const auto cols = static_cast<std::size_t>(grid.cols);
  return {1, (static_cast<double>(valid[v] / cols) + 0.5) * grid.dx_m,
          (static_cast<double>(valid[v] % cols) + 0.5) * grid.dy_m};
}

Dem make_dem(std::span<const Point3> cloud, const Grid& grid, double max_height_m) {
  Dem dem;
  dem.grid = grid;
  dem.cells.resize(grid.cells());
  for (const Point3& p : cloud) {
    const double i = std::floor((p.x - grid.x0_m) / grid.dx_m), j = std::floor((p.y - grid.y0_m) / grid.dy_m);
    if (!std::isfinite(p.z) || p.z > max_height_m || !(i >= 0 && j >= 0 && i < grid.rows && j < grid.cols)) continue;
    add(dem.cells[grid.at(static_cast<int>(i), static_cast<int>(j))], p.z);
  }
  for (std::size_t c = 0; c < dem.cells.size(); ++c) {
    if (dem.cells[c].points > 0) dem.valid.push_back(c);
  }
  link_neighbours(dem);
  return dem;
}

}  // namespace curbline::tools::reference
