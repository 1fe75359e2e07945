// Whether the tilt's angles are radians: a servo described in degrees sweeps through many turns, which no servo of a
// laser does, and curbs appear where none are. The daemon tells so at once, `curbline replay` at the end. One thread;
// O(1).
#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "curbline/math.hpp"
#include "curbline/tilt_reading.hpp"

namespace curbline::tools {

class RadiansWatch {
 public:
  /// Starts afresh. sweep_s: a sweep there and back at most, after which angles are compared with another one, as a
  /// servo may lose its zero; no less than half a second, for enough readings.
  void init(float sweep_s) {
    *this = RadiansWatch{};
    sweep_ns_ = static_cast<std::int64_t>(std::max(sweep_s, 0.5f) * 1e9f);
  }

  /// Call with each reading that the pipeline takes.
  void update(const TiltReading& reading) {
    if (readings_ == 0 || reading.time_ns < since_ns_ || reading.time_ns - since_ns_ > sweep_ns_) begin(reading);
    ++readings_;
    const bool near = magnitude(reading.angle_rad - from_rad_) <= turn_rad;
    if (near) {
      agreed_ = agreed_ || readings_ > 1;
      return;
    }
    if (!agreed_) from_rad_ = reading.angle_rad;  // the one before was damaged, or this one is
    ++away_;
    if (in_doubt_) {
      ++beyond_;
    } else if (away_ >= least_away && mostly_away()) {
      in_doubt_ = true;
      beyond_ += static_cast<std::uint64_t>(away_);
    }
  }

  /// Most angles of this sweep or the last one lie more than a turn from where it began.
  bool in_doubt() const { return in_doubt_; }
  /// Readings that lay there in sweeps that were in doubt, since init().
  std::uint64_t beyond() const { return beyond_; }

 private:
  static constexpr float turn_rad = 2.0f * std::numbers::pi_v<float>;
  static constexpr int least_away = 16;  ///< no bus damages as many

  bool mostly_away() const { return 2 * away_ > readings_; }
  void begin(const TiltReading& reading) {
    in_doubt_ = mostly_away();
    agreed_ = false;
    readings_ = away_ = 0;
    since_ns_ = reading.time_ns;
    from_rad_ = reading.angle_rad;
  }

  std::int64_t sweep_ns_ = 0, since_ns_ = 0;
  float from_rad_ = 0.0f;  ///< where the sweep began
  bool agreed_ = false;    ///< two readings on end lay there
  bool in_doubt_ = false;
  int readings_ = 0, away_ = 0;  ///< of the sweep
  std::uint64_t beyond_ = 0;
};

}  // namespace curbline::tools
