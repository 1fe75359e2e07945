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

/// Scatter that a plane's slope makes in a cell, per point. Points are spread evenly over the ground, but those of a
/// cell less than over its length, the less the farther their centroid is off its middle: a single scan line crosses it
/// anywhere.
template <Limits limits>
float slope_scatter_m2(const Dem<limits>& dem, const Cell& cell, const Plane& plane) {
  const auto along_m2 = [](float slope, float side_m, float offset_m) {
    return slope * slope * std::max(0.0f, side_m * side_m * (1.0f / 12) - offset_m * offset_m);
  };
  return (along_m2(plane.slope_x, dem.cell_x_m(), cell.dx_m) + along_m2(plane.slope_y, dem.cell_y_m(), cell.dy_m)) *
         cell.weight / cell.points;
}

/// Twice the log of the likelihood ratio of level ground to the slope, for the scatter of a cell: each with the noise
/// that suits it best, as the sensor's is not known so well. 0 where heights spread as far as the slope makes them.
template <Limits limits>
float level_likelihood(const Dem<limits>& dem, const Cell& cell, const Plane& plane) {
  const float freedom = cell.points - 1.0f;
  const float expected_m2 = freedom * slope_scatter_m2(dem, cell, plane);
  if (!(freedom > 0.0f) || !(cell.scatter_m2 < expected_m2)) return 0.0f;
  const float share = std::max(cell.scatter_m2 / expected_m2, 1e-3f);  // of a cell whose heights are all the same
  return freedom * (share - 1.0f - log(share));
}

}  // namespace curbline
