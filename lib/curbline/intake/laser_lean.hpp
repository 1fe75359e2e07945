// By how much the laser looks farther down than its mount, the servo's zero and the poses say: its lean. It lifts
// ground by how far ahead of the tilt axis it lies, so that a robot that drives finds ground higher or lower than when
// it saw that from farther away, always to the same side; a servo that is late, in upward and downward sweeps to
// different sides. z that drifts with the way looks the same, and is taken off the same way.
// The second stage of TiltLatency's filter (Friedland's separate bias): the first runs as if there were no lean, and
// knows by how much that bends what it estimates; what its observations then lack is an observation of the lean.
#pragma once

namespace curbline {

class LaserLean {
 public:
  /// sd_rad: before any observation; 0 if it is not estimated.
  void init(float sd_rad);
  /// A sweep begins. Other wheels, load or drift: the lean may have changed by a fifth of the prior's deviation. The
  /// first one is due when found with three standard deviations, what is left of it with one.
  void begin_sweep();
  /// Begins again, but for what has been taken off.
  void forget();

  /// Effect of the lean on an observation, of which the derivative by the lean is `by`: mean and variance.
  float mean(float by) const { return by * found_rad_; }
  float variance(float by) const { return by * by * variance_; }
  /// An observation that is off by `missing`, with its variance but for the lean's.
  void observe(float by, float missing, float variance_without);

  /// If a lean is due: from now on it counts as taken off. Returns it, otherwise 0.
  float take_off();
  /// The sum of all that was taken off.
  float taken_off_rad() const { return taken_off_rad_; }

 private:
  float prior_variance_ = 0.0f, largest_rad_ = 0.0f;  ///< five standard deviations: beyond, the settings are wrong
  float found_rad_ = 0.0f, variance_ = 0.0f;          ///< of what is left
  float taken_off_rad_ = 0.0f;
  bool due_ = false;
};

}  // namespace curbline
