// Where the robot is at one time, by its odometry or localisation: input of the pipeline.
#pragma once

#include <cstdint>

namespace curbline {

/// Position of the base in the map frame and its attitude as a unit quaternion. float resolves 0.1 mm within 1 km of
/// the map's origin: choose it near the robot. That is so for z, too: subtract the place's height above the sea. At
/// z = 3 km one curb in five is missed.
struct Pose {
  static constexpr float furthest_m = 1e6f;  ///< along each axis: beyond, float cannot tell cells apart
  std::int64_t time_ns = 0;                  ///< nanoseconds of the epoch of ScanLine::time_ns
  float x_m = 0.0f, y_m = 0.0f, z_m = 0.0f;
  float qx = 0.0f, qy = 0.0f, qz = 0.0f, qw = 1.0f;  ///< qw last; z of the base up, within 90 degrees
};

}  // namespace curbline
