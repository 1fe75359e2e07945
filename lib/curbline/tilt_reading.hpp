// The angle of the tilt servo at one time: what a bus or an encoder tells the pipeline.
#pragma once

#include <cstdint>

namespace curbline {

struct TiltReading {
  /// No servo winds further, and what follows can reduce it, carried beyond the readings too: a greater angle is a
  /// damaged frame.
  static constexpr float furthest_rad = 1e6f;
  std::int64_t time_ns = 0;  ///< nanoseconds of the epoch of ScanLine::time_ns
  float angle_rad = 0.0f;    ///< tilt > 0 looks down; continuous: an encoder's zero does not lie within the sweep
};

}  // namespace curbline
