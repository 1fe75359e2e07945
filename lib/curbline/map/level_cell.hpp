// What the spread of heights within a cell tells about the slope of its ground. Readings on a tread lie level, although
// the plane along a flight of stairs rises by half a cell's length and more across each cell. 20 operations a cell,
// and a logarithm.
#pragma once

#include <algorithm>

#include "curbline/limits.hpp"
#include "curbline/map/cell.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// Scatter that a plane's slope makes in a cell, per point. Points spread evenly over a cell of side a have the
/// variance a^2 / 12 along it; those of a single scan line, which crosses the cell anywhere, lie in one place. A
/// centroid d off the cell's middle is a sign of that: a^2 / 12 - d^2.
template <Limits limits>
float slope_scatter_m2(const Dem<limits>& dem, const Cell& cell, const Plane& plane) {
  const auto along_m2 = [](float slope, float side_m, float offset_m) {
    return slope * slope * std::max(0.0f, side_m * side_m * (1.0f / 12) - offset_m * offset_m);
  };
  return (along_m2(plane.slope_x, dem.cell_x_m(), cell.dx_m) + along_m2(plane.slope_y, dem.cell_y_m(), cell.dy_m)) *
         cell.weight / cell.points;
}

/// Twice the log of the likelihood ratio of level ground to the slope, by the scatter of a cell: n (r - 1 - ln r), for
/// n degrees of freedom and a scatter that is r times what the slope alone makes; 0 from r = 1 on. Level ground is
/// given the noise that explains the scatter best, since the sensor's is not known so well.
template <Limits limits>
float level_likelihood(const Dem<limits>& dem, const Cell& cell, const Plane& plane) {
  const float freedom = cell.points - 1.0f;
  const float expected_m2 = freedom * slope_scatter_m2(dem, cell, plane);
  if (!(freedom > 0.0f) || !(cell.scatter_m2 < expected_m2)) return 0.0f;
  const float share = std::max(cell.scatter_m2 / expected_m2, 1e-3f);  // of a cell whose heights are all the same
  return freedom * (share - 1.0f - log(share));
}

}  // namespace curbline
