// Fits cubic polynomials to edge points by RANSAC, and converts them to curbs.
#pragma once

#include <vector>

#include "map/map.hpp"

namespace curbline::tools::peers {

struct EdgePoint {
  double x_m = 0, y_m = 0;
  double height_m = 0;  ///< far minus near
};

/// Finds the curve with the most points within 8 cm, then that of the remaining points, and so on as long as it has 8
/// points. Each is split at gaps of 0.4 m and returned in pieces of at most 0.3 m. The same points give the same curbs.
std::vector<MapCurb> polynomial_curbs(std::vector<EdgePoint> points);

}  // namespace curbline::tools::peers
