// Clouds in PCD 0.7 (Point Cloud Library), ascii or binary. read_cloud() is the way in.
#pragma once

#include <string>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

/// All points, those that are not finite too; fields other than x, y and z are passed over. Throws BadInput, also for
/// fewer points than the header promises and for binary_compressed data.
std::vector<Point3> read_pcd(const std::string& path);

}  // namespace curbline::tools
