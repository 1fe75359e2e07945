// Clouds in PCD 0.7 (Point Cloud Library), ascii or binary. Called by read_cloud().
#pragma once

#include <string>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

/// All points, including those that are not finite; fields other than x, y and z are skipped. Throws BadInput, also if
/// there are fewer points than the header states, and for binary_compressed data.
std::vector<Point3> read_pcd(const std::string& path);

}  // namespace curbline::tools
