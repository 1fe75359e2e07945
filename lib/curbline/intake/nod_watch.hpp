// Whether the laser nods: an encoder that is stuck, or a servo that has stopped, gives readings like one that works,
// but ground seen at another tilt than the stated one is mapped where it is not. A servo may rest by intention; only
// the robot knows. Beside the way of the data, as source_watch.hpp.
//
// No clock: times are those of the readings. update() takes constant time; one context.
#pragma once

#include <cstdint>

#include "curbline/intake/source_watch.hpp"
#include "curbline/intake/sweep_turns.hpp"
#include "curbline/math.hpp"
#include "curbline/tilt_reading.hpp"

namespace curbline {

class NodWatch {
 public:
  /// Starts afresh. longest_rest_s: for how long the angle may stay within SweepTurns::least_sweep_rad, 3 degrees, the
  /// play of a servo that holds: a sweep there and back at most. `fixed`, as in TiltSettings: nothing is watched, all
  /// is well.
  void init(float longest_rest_s, bool fixed) {
    *this = NodWatch{};
    moves_.init(longest_rest_s, fixed);
  }

  /// Call with each reading that the pipeline takes. Says once that the tilt has come to rest (lost) and once that it
  /// moves again (recovered). Between two readings that are further apart than longest_rest_s, as of a clock that is
  /// set, it may have moved.
  SourceEvent update(const TiltReading& reading) {
    const bool unseen = watch().state() == SourceState::ok && reading.time_ns - newest_ns_ > watch().stale_after_ns();
    const bool moved = unseen || moves_.begins(reading.time_ns) ||
                       magnitude(reading.angle_rad - at_rad_) >= SweepTurns::least_sweep_rad;
    if (moved) at_rad_ = reading.angle_rad;
    newest_ns_ = reading.time_ns;
    return moves_.update(moved, reading.time_ns);
  }

  /// ok, or stale if the tilt rests; never before the first reading.
  const SourceWatch& watch() const { return moves_.watch(); }

 private:
  SignWatch moves_{};
  std::int64_t newest_ns_ = 0;
  float at_rad_ = 0.0f;  ///< where it has moved to last
};

}  // namespace curbline
