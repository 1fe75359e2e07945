// The elevation map (paper, III-A and III-B): each cell has the posterior of its height.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools::reference {

/// kappa0 = 0, nu0 = 1, sigma0^2 = 3e-4 m^2, as in the paper's code, which continues with the mode of the posterior.
struct DemCell {
  int points = 0;
  double height_m = 0;
  double squares_m2 = 0;  ///< sum of squared deviations from the mean
  double variance_m2() const { return (3e-4 + squares_m2) / (points + 3); }
};

/// Two neighbouring valid cells, as indices into Dem::valid.
struct DemEdge {
  std::size_t a, b;
};

struct Dem {
  Grid grid;
  std::vector<DemCell> cells;
  std::vector<std::size_t> valid;  ///< cells with a point, in the order of the grid
  std::vector<DemEdge> edges;      ///< 4-neighbourhood of valid cells

  const DemCell& cell(std::size_t v) const { return cells[valid[v]]; }
  /// [1 x y] at the cell's centre, from the grid's corner.
  std::array<double, 3> phi(std::size_t v) const;
};

/// Points above the greatest height, outside the grid or not finite are ignored. O(points + cells).
Dem make_dem(std::span<const Point3> cloud, const Grid& grid, double max_height_m);

}  // namespace curbline::tools::reference
