// How late the tilt readings are, found on the way: a servo's stamps lag or lead the beams by some milliseconds, and
// not by the same amount in every sweep. Where a sweep looks at ground that an earlier one has mapped, heights differ
// by the sweep's tilt rate times what is missing in the latency. A Kalman filter with one state for upward and one for
// downward sweeps makes each agree with the map; the first sweep is the datum. Each sweep may have a latency of its
// own, except on a robot that drives: there the datum stays behind, ground is looked at again from nearer, and two
// offsets would wander, upward and downward sweeps agreeing on a tilted ground. It has one constant offset, which tilts
// both the other way. Cost: 20 operations a point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/settings.hpp"

namespace curbline {

class TiltLatency {
 public:
  void init(const TiltSettings& tilt, const PoseSettings& pose);

  enum class Turn : std::uint8_t {
    none,
    back,  ///< of a damaged reading, or play: the offset is another, the sweep goes on
    new_sweep,
  };
  /// The angle and its rate at the beginning of a line: has the servo turned round since the last?
  Turn follow(float angle_rad, float rate_rad_s);

  /// A point of the line on ground that an earlier sweep has mapped: how far it lies above it, the variance of that,
  /// and by how much its height grows a second of latency.
  void compare(float above_m, float variance_m2, float growth_m_s);

  /// The line is over: its points together are one observation of the sweep's latency.
  void end_line(float tilt_rate_rad_s);

  /// To be added to TiltSettings::latency_s, and its standard deviation.
  float offset_s() const { return state().offset_s; }
  float sd_s() const;
  /// The larger of both sweeps' offsets: how far ahead of a line its readings may be wanted.
  float latest_offset_s() const {
    const State& other = one_offset_ ? state_[0] : state_[1];
    return state_[0].offset_s > other.offset_s ? state_[0].offset_s : other.offset_s;
  }

 private:
  struct State {
    float offset_s = 0.0f;
    float variance_s2 = 0.0f;
  };
  const State& state() const { return state_[one_offset_ ? 0 : sweep_]; }
  State& state() { return state_[one_offset_ ? 0 : sweep_]; }

  float new_sweep_variance_s2_ = 0.0f;  ///< by how much a sweep's latency differs from the last one's of its direction
  float time_variance_s2_ = 0.0f, angle_variance_ = 0.0f, height_variance_m2_ = 0.0f;
  float largest_offset_s_ = 0.0f;  ///< five standard deviations: beyond, the settings are wrong and not the servo late
  float slow_rad_s_ = 0.0f;        ///< below it a wrong latency is less than the error of an angle
  bool begun_ = false, one_offset_ = false;
  float turned_at_rad_ = 0.0f;  ///< where the sweep began
  std::size_t sweep_ = 0;       ///< 0: upward (the angle falls), 1: downward
  std::array<State, 2> state_{};
  float precision_ = 0.0f, weighted_ = 0.0f, growth_ = 0.0f, points_ = 0.0f;  ///< sums of a line
};

}  // namespace curbline
