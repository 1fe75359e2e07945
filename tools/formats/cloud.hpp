// Point clouds, read whole. The format goes by the file's ending:
//   .xyz .csv  text, x y z in metres, apart by blanks or commas; further columns are ignored; # comments are passed
//   over;
//              a first line of names may say which columns are x, y and z
//   .pcd       PCD 0.7, ascii or binary, with float fields x, y and z among others; a point with a NaN is no point
//   .bin       KITTI, float32 x y z intensity, little-endian
#pragma once

#include <string>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

/// Throws BadInput if the file is not of its format, has no point, or (in text and .bin) a coordinate that is not
/// finite. About 0.2 us a point of text.
std::vector<Point3> read_cloud(const std::string& path);

}  // namespace curbline::tools
