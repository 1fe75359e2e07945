// The latency of the tilt readings, estimated on line: a servo's stamps lag or lead the beams by some milliseconds, and
// not by the same amount in every sweep. Where a sweep sees ground that an earlier one has mapped, its heights deviate
// from the map's by the errors of both offsets, each times the growth of a height with a second of latency. A Kalman
// filter estimates the offset of this sweep and those of the ground mapped before, by the last two; a correction of
// these corrects the map (Correction).
//   - For a robot that stands, the first two sweeps, of opposite direction, are taken to be equally late. Their
//     ground is the datum of all later ones: each has its own offset, starting from that of the last sweep of its
//     direction. As later ones replace that ground, both directions are taken to be equally late in the long run, too.
//   - A robot that drives leaves its datum behind. The ground before is always that of the last two sweeps, and every
//     offset is a constant plus a small random difference, with a fifth of the prior's standard deviation: else
//     upward and downward sweeps would come to agree on tilted ground. The laser's lean (laser_lean.hpp) is estimated
//     beside them.
// The ground's growth is kept apart by direction, since where both have seen it growths cancel, but errors do not
// (lib/formulas.md); points of older sweeps count as those of the last one of their direction.
// A latency that steps by more than either allows (the servo was restarted, a clock was set) contradicts the estimate:
// after ten consecutive lines that do, and agree with each other, it is as uncertain as at the beginning.
// Cost: 50 operations a point, and a pass over the window for each line that corrects the map.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "curbline/intake/laser_lean.hpp"
#include "curbline/intake/sweep_turns.hpp"
#include "curbline/settings.hpp"
#include "curbline/sweeps.hpp"

namespace curbline {

class TiltLatency {
 public:
  void init(const TiltSettings& tilt, const PoseSettings& pose);

  using Turn = SweepTurns::Turn;
  /// A line begins; see SweepTurns::follow().
  Turn begin_line(float angle_rad, float rate_rad_s, std::uint32_t reading);

  /// A point of the line, on ground mapped by an earlier sweep.
  struct Sighting {
    float above_m;             ///< its height above that ground
    float variance_m2;         ///< the independent part of its variance
    float common_variance_m2;  ///< the part shared with the line's other points: by the ground's slope
    BySweep growth_m_s;        ///< of above_m with the latency of each sweep: the point's, and less the ground's
    float farther_m = 0.0f;    ///< how much farther ahead it lies than when that ground was seen
  };
  void compare(const Sighting& seen);

  /// By how much latencies are greater than those with which heights were mapped, and the lean.
  struct Correction {
    BySweep later_s{};
    float lean_rad = 0.0f;
    bool any() const { return later_s.now != 0.0f || later_s.last != 0.0f; }
  };
  /// The line ends: its points together are one observation. Returns the correction of the map.
  Correction end_line(float tilt_rate_rad_s);

  /// How many steps of the latency were found.
  std::uint32_t steps() const { return steps_; }

  /// Sum of Correction::later_s.last over all lines, but for what brings the directions of a robot that stands
  /// together.
  float mended_s() const { return mended_s_; }

  /// What is not known of the latencies.
  LatencyDoubt doubt() const {
    const auto& p = covariance_;
    return {
        {p[now][now], p[last][last], p[before][before]}, p[now][last], p[now][before], p[last][before], sweep_rates_};
  }
  float height_variance_m2(const BySweep& growth_m_s) const { return doubt().height_variance_m2(growth_m_s); }

  /// How fast the last two sweeps were; those before the first one, as fast as it.
  const SweepRates& sweep_rates() const { return sweep_rates_; }

  /// By how much the laser looks farther down than mount and poses say, as taken off: 0 until it is known. Of a mount
  /// in which a greater tilt looks up, less far down.
  float lean_rad() const { return lean_.taken_off_rad(); }

  /// Of this sweep: the offset to add to TiltSettings::latency_s, and its standard deviation.
  float offset_s() const { return offset_s_; }
  float sd_s() const;
  /// Of the servo as a whole: how much later it is than TiltSettings::latency_s. A sweep's own offset also absorbs
  /// anything else that lifts it off the ground before (a mount that leans by a milliradian, ranges that are short, a
  /// first sweep with another latency), and the next sweep, of the other direction, absorbs the same with the other
  /// sign. For one sweep after the servo's latency has changed, the value lies between the old one and the new one.
  struct Usual {
    float offset_s, sd_s;
  };
  Usual usual() const;
  /// The larger of this sweep's offset and the next sweep's initial one: how much later than a line its readings may
  /// come.
  float latest_offset_s() const;

 private:
  enum State : std::size_t { constant, now, last, before };  ///< offsets of: all sweeps, and BySweep
  static constexpr std::size_t states = 4;
  using States = std::array<float, states>;
  struct Known {
    float offset_s = 0.0f, variance_s2 = 0.0f;
  };

  /// Of a line: missing_s = a + last_share b + before_share c - farther_share lean, plus noise, where a, b and c are
  /// what the offsets of this sweep, the last and the one before still lack.
  struct Observation {
    float missing_s, variance_s2;
    float last_share, before_share, farther_share;
    /// The sum of what it consists of.
    float sum(const States& of) const { return of[now] + last_share * of[last] + before_share * of[before]; }
  };
  /// Sightings of a line.
  struct Sums {
    float precision = 0.0f, weighted = 0.0f, last = 0.0f, before = 0.0f, farther = 0.0f;
    float growth = 0.0f, common_m2 = 0.0f, points = 0.0f;
    void add(const Sighting& seen);
    void add(const Sums& other);
  };

  void turn_standing();
  void turn_driving();
  void follow_rate(Turn turn, float rate_rad_s);
  void take_up_other_direction();
  std::optional<Observation> observation(const Sums& sums, float tilt_rate_rad_s) const;
  bool update(const Observation& seen, Correction& correction);
  void take_off_lean(Correction& correction);
  void suspect(const Observation& seen);
  bool known(State state) const { return covariance_[state][state] == 0.0f; }

  bool drives_ = false;
  bool turned_ = false;                         ///< this sweep is not the first
  float rate_sum_rad_s_ = 0.0f, lines_ = 0.0f;  ///< sum over the lines of this sweep, and their number
  SweepRates sweep_rates_{};
  SweepTurns turns_{};
  float prior_variance_s2_ = 0.0f;  ///< of an offset before any observation
  float time_variance_s2_ = 0.0f, angle_variance_ = 0.0f, height_variance_m2_ = 0.0f;
  float largest_offset_s_ = 0.0f;  ///< five standard deviations: beyond, the settings are wrong

  float constant_s_ = 0.0f, offset_s_ = 0.0f, mended_s_ = 0.0f;
  float approach_s_ = 0.0f;  ///< by which both directions came together at this turn: the map has yet to follow
  std::array<States, states> covariance_{};
  LaserLean lean_{};
  States by_lean_s_rad_{};  ///< what each offset lacks for a radian of lean that is left
  Known other_{};           ///< of the last sweep, of the other direction; driving, only its offset

  Sums seen_{};              ///< of the current line: points that agree with the estimate ...
  Sums stepped_{};           ///< ... and those that would only after a step
  Observation suspected_{};  ///< of the last line, if it disagreed
  int lines_suspected_ = 0;  ///< consecutive lines that disagreed, and agree with each other
  std::uint32_t steps_ = 0;
};

}  // namespace curbline
