// The angle of the tilt servo at one time, from a bus or an encoder: input of the pipeline.
#pragma once

#include <cstdint>

namespace curbline {

struct TiltReading {
  /// A greater angle is a damaged frame: no servo winds further. Up to here sin_cos() can still reduce the angle,
  /// extrapolated too.
  static constexpr float furthest_rad = 1e6f;
  std::int64_t time_ns = 0;  ///< nanoseconds of the epoch of ScanLine::time_ns
  float angle_rad = 0.0f;    ///< tilt > 0 looks down; continuous: no wrap of the encoder within the sweep
};

}  // namespace curbline
