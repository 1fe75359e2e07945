// Reads point clouds into memory. The file's ending determines the format:
//   .xyz .csv  text, x y z in metres, separated by blanks or commas; further columns are ignored; # comments are
//              skipped; names in the first line may say which columns are x, y and z
//   .pcd       PCD 0.7, ascii or binary, with float fields x, y and z among others
//   .bin       KITTI, float32 x y z intensity, little-endian
// In all formats, points with NaN or infinite coordinates are skipped; organised clouds have them where no beam
// returned.
#pragma once

#include <string>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

/// Throws BadInput if the file does not have its format, or has no points. About 0.2 us a point of text.
std::vector<Point3> read_cloud(const std::string& path);

}  // namespace curbline::tools
