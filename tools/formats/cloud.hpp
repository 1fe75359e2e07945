// Point clouds, read whole. The format goes by the file's ending:
//   .xyz .csv  text, x y z in metres, apart by blanks or commas; further columns are ignored; # comments are passed
//              over; a first line of names may say which columns are x, y and z
//   .pcd       PCD 0.7, ascii or binary, with float fields x, y and z among others
//   .bin       KITTI, float32 x y z intensity, little-endian
// In each of them a point with a NaN or an infinity is no point, as organised clouds have where no beam returned.
#pragma once

#include <string>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

/// Throws BadInput if the file is not of its format, or has no point. About 0.2 us a point of text.
std::vector<Point3> read_cloud(const std::string& path);

}  // namespace curbline::tools
