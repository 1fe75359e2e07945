// Where the tilt servo reverses, and a new sweep begins: by its rate or, where that is too slow to be told from errors
// of the angle, by the angle, once it has come back by as much as the smallest sweep. Needs two consecutive lines
// between different readings, since one damaged reading misleads all lines before it or after it. O(1) a line.
#pragma once

#include <cstdint>

namespace curbline {

class SweepTurns {
 public:
  /// Smaller than any real sweep: reversals closer together come from damaged readings and from play.
  static constexpr float least_sweep_rad = 0.05f;

  /// A rate of slow_rad_s or less says nothing about the direction. With 0 every rate of a servo that turns does.
  void init(float slow_rad_s) {
    *this = SweepTurns{};
    slow_rad_s_ = slow_rad_s;
  }

  enum class Turn : std::uint8_t {
    none,
    back,  ///< by play: the old sweep goes on
    new_sweep,
  };
  /// Has the servo reversed? Given the angle and its rate at the beginning of a line, and the number of the next
  /// reading.
  Turn follow(float angle_rad, float rate_rad_s, std::uint32_t reading);

 private:
  bool downward(float angle_rad, float rate_rad_s) const;

  float slow_rad_s_ = 0.0f;
  bool begun_ = false;
  bool downward_ = false;            ///< the angle grows
  float furthest_rad_ = 0.0f;        ///< in that direction, of this sweep
  bool turns_ = false;               ///< the last line has the other direction, first seen ...
  std::uint32_t turns_reading_ = 0;  ///< ... before this reading
  float turned_at_rad_ = 0.0f;       ///< where the sweep began
};

inline bool SweepTurns::downward(float angle_rad, float rate_rad_s) const {
  if (rate_rad_s > slow_rad_s_ || rate_rad_s < -slow_rad_s_) return rate_rad_s > 0.0f;
  return angle_rad > furthest_rad_ + (downward_ ? -least_sweep_rad : least_sweep_rad);
}

inline SweepTurns::Turn SweepTurns::follow(float angle_rad, float rate_rad_s, std::uint32_t reading) {
  if (!begun_) {
    begun_ = true;
    downward_ = rate_rad_s > 0.0f;
    turned_at_rad_ = furthest_rad_ = angle_rad;
  }
  const bool turned_before = turns_ && reading != turns_reading_;
  if (!turns_) turns_reading_ = reading;
  turns_ = downward(angle_rad, rate_rad_s) != downward_;
  if (!turns_ && (angle_rad > furthest_rad_) == downward_) furthest_rad_ = angle_rad;
  if (!turns_ || !turned_before) return Turn::none;
  turns_ = false;
  downward_ = !downward_;
  furthest_rad_ = angle_rad;
  const float swept = angle_rad - turned_at_rad_;
  if (swept < least_sweep_rad && swept > -least_sweep_rad) return Turn::back;
  turned_at_rad_ = angle_rad;
  return Turn::new_sweep;
}

}  // namespace curbline
