// How late the tilt readings are, found on the way: a servo's stamps lag or lead the beams by some milliseconds, and
// not by the same amount in every sweep. Where a sweep looks at ground that an earlier one has mapped, its heights lie
// off the map's by what is missing in both offsets, each times the growth of a height by a second of latency. A Kalman
// filter keeps the offset of this sweep and of the ground mapped before it; what becomes known of that ground mends the
// map (Correction).
//   - A robot that stands takes its first two sweeps, of opposite direction, to be late by the same time. Their ground
//     is the datum of all later ones: each has an offset of its own, beginning with what the last of its direction had.
//   - One that drives leaves its datum behind, so the ground before is always that of the last sweep, and all offsets
//     are a constant and a little more: each sweep may differ from it by a part of what is not known of it, or upward
//     and downward sweeps would agree on a tilted ground.
// A latency that has stepped by more than either allows (a servo that started anew, a clock that was set) disagrees
// with all that is known: where ten lines on end do, and agree with each other, it is as unknown as at the beginning.
// Cost: 30 operations a point, and the mending: a pass over the window for a line that tells anything.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/intake/sweep_turns.hpp"
#include "curbline/settings.hpp"

namespace curbline {

class TiltLatency {
 public:
  void init(const TiltSettings& tilt, const PoseSettings& pose);

  using Turn = SweepTurns::Turn;
  /// A line begins: SweepTurns::follow().
  Turn begin_line(float angle_rad, float rate_rad_s, std::uint32_t reading);

  /// A point of the line on ground that an earlier sweep has mapped.
  struct Sighting {
    float above_m;             ///< how far it lies above that ground
    float variance_m2;         ///< of that, its own
    float common_variance_m2;  ///< and what it shares with the line's other points: the slope of the ground
    float growth_m_s;          ///< of its height, by a second of latency
    float map_growth_m_s;      ///< of the ground's
  };
  void compare(const Sighting& seen);

  /// By how much latency has turned out to be greater than what heights were mapped with.
  struct Correction {
    float this_sweep_s = 0.0f, earlier_s = 0.0f;
    bool any() const { return this_sweep_s != 0.0f || earlier_s != 0.0f; }
  };
  /// The line is over: its points together are one observation. What it says of the map.
  Correction end_line(float tilt_rate_rad_s);

  /// How often it has turned out to have stepped.
  std::uint32_t steps() const { return steps_; }

  /// Sum of Correction::earlier_s of all lines.
  float mended_s() const { return mended_s_; }

  /// Variance of how far a point of this sweep lies above ground of an earlier one by what is not known of the latency;
  /// of how far it lies above ground of this sweep.
  float earlier_variance_m2(float growth_m_s, float map_growth_m_s) const {
    const float g = growth_m_s, m = map_growth_m_s;
    return g * g * covariance_[now][now] - 2.0f * g * m * covariance_[now][earlier] +
           m * m * covariance_[earlier][earlier];
  }
  float own_variance_m2(float growth_m_s, float map_growth_m_s) const {
    return (growth_m_s - map_growth_m_s) * (growth_m_s - map_growth_m_s) * covariance_[now][now];
  }

  /// Of this sweep: to be added to TiltSettings::latency_s, and its standard deviation.
  float offset_s() const { return offset_s_; }
  float sd_s() const;
  /// Of the servo: how much later than TiltSettings::latency_s it is in all. A sweep's own offset also takes up what
  /// else has it lie off the ground before, a mount that leans by a milliradian, ranges that are short, a first sweep
  /// that was late by another time: one sweep of that is too late and the next, of the other direction, as much too
  /// early. For a sweep after the servo's latency has changed it is that of before and after.
  struct Usual {
    float offset_s, sd_s;
  };
  Usual usual() const;
  /// The larger of this sweep's offset and the one that the next begins with: how far ahead of a line its readings may
  /// be wanted.
  float latest_offset_s() const;

 private:
  enum State : std::size_t { constant, now, earlier };  ///< offsets: of all sweeps, of this one, of the ground before
  static constexpr std::size_t states = 3;
  struct Known {
    float offset_s = 0.0f, variance_s2 = 0.0f;
  };

  struct Observation {
    float missing_s;  ///< this sweep's offset lacks so much more than ...
    float variance_s2;
    float mapped_share;  ///< ... this part of what the ground's lacks
  };
  /// Sightings of a line.
  struct Sums {
    float precision = 0.0f, weighted = 0.0f, mapped = 0.0f, growth = 0.0f, common_m2 = 0.0f, points = 0.0f;
    void add(const Sighting& seen);
    void add(const Sums& other);
  };

  void turn_standing();
  void turn_driving();
  void take_up_other_direction();
  Observation observation(const Sums& sums, float tilt_rate_rad_s) const;
  bool update(const Observation& seen, Correction& correction);
  void suspect(const Observation& seen);
  bool known(State state) const { return covariance_[state][state] == 0.0f; }

  bool drives_ = false;
  bool turned_ = false;  ///< this sweep is not the first
  SweepTurns turns_{};
  float prior_variance_s2_ = 0.0f;  ///< of an offset of which nothing has been seen
  float time_variance_s2_ = 0.0f, angle_variance_ = 0.0f, height_variance_m2_ = 0.0f;
  float largest_offset_s_ = 0.0f;  ///< five standard deviations: beyond, the settings are wrong and not the servo late

  float constant_s_ = 0.0f, offset_s_ = 0.0f, mended_s_ = 0.0f;
  std::array<std::array<float, states>, states> covariance_{};
  Known other_{};  ///< of the last sweep of the other direction; driving, its offset alone

  Sums seen_{};              ///< of the line in hand: what agrees with what is known ...
  Sums stepped_{};           ///< ... and what would after a step alone
  Observation suspected_{};  ///< of the last line, if it disagreed
  int lines_suspected_ = 0;  ///< on end, that agree with each other
  std::uint32_t steps_ = 0;
};

}  // namespace curbline
