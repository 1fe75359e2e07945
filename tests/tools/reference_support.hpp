// Ground for tests of the reference: clouds over a grid with a few points a cell and the same noise on every machine.
#pragma once

#include <random>
#include <vector>

#include "map/map.hpp"
#include "reference/dem.hpp"

namespace curbline::tools::reference::testing {

/// The sum of twelve uniform numbers approximates a normal one without depending on the standard library.
inline double normal(std::mt19937& random) {
  double sum = -6;
  for (int n = 0; n < 12; ++n) sum += static_cast<double>(random()) / 4294967296.0;
  return sum;
}

/// Four points in each cell at height(x, y) plus noise. Where the height is NaN the cell is left out.
template <typename Height>
std::vector<Point3> cloud_of(const Grid& grid, double noise_sd_m, Height height) {
  std::mt19937 random(3);
  std::vector<Point3> cloud;
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) {
      for (int n = 0; n < 4; ++n) {
        const double x = grid.x_m(i) + (n % 2 == 0 ? -0.25 : 0.25) * grid.dx_m;
        const double y = grid.y_m(j) + (n < 2 ? -0.25 : 0.25) * grid.dy_m;
        const double noise = noise_sd_m * normal(random);
        const double z = height(x, y);
        if (z == z) cloud.push_back({x, y, z + noise});
      }
    }
  }
  return cloud;
}

/// A row of cells along y with one point in each: every variance is 3e-4 / 4.
inline Dem row_of(const std::vector<double>& heights_m) {
  const Grid grid{0, 0, 1, 1, 1, static_cast<int>(heights_m.size())};
  std::vector<Point3> cloud;
  for (std::size_t j = 0; j < heights_m.size(); ++j) cloud.push_back({0.5, static_cast<double>(j) + 0.5, heights_m[j]});
  return make_dem(cloud, grid, 1e9);
}

}  // namespace curbline::tools::reference::testing
