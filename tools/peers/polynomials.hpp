// Cubic polynomials through edge points, by RANSAC, and the curbs that they are.
#pragma once

#include <vector>

#include "map/map.hpp"

namespace curbline::tools::peers {

struct EdgePoint {
  double x_m = 0, y_m = 0;
  double height_m = 0;  ///< far less near
};

/// The curve with the most points within 8 cm, then that of the points that are left, and so on while it has 8 points.
/// Each is cut at gaps of 0.4 m and given out in pieces of at most 0.3 m. The same points give the same curbs.
std::vector<MapCurb> polynomial_curbs(std::vector<EdgePoint> points);

}  // namespace curbline::tools::peers
