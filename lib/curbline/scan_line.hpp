// One scan line of the laser: what goes into the pipeline 40 times a second.
#pragma once

#include <cstdint>
#include <span>

namespace curbline {

/// ranges_m[i] was measured at bearing first_bearing_rad + i * bearing_step_rad and at time_ns + i * beam_interval
/// (LaserSettings). NaN, infinite and out-of-range readings mean no return. Owned by the caller.
struct ScanLine {
  std::int64_t time_ns;             ///< of beam 0, nanoseconds of any epoch, the same for tilt readings and poses
  std::span<const float> ranges_m;  ///< metres, at most LaserSettings::beams
};

}  // namespace curbline
