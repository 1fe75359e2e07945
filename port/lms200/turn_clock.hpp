// The time of scan lines that bear none, from their arrival and the mirror's steady turning. Lines come a whole number
// of turns after each other; the count of turns is a clock, which the lower envelope of the arrivals ties to the host's
// steady one (device_clock.hpp says why that). Bytes that wait in a driver, and are then read at once, so do not shift
// the lines. Pure; O(1) a line.
#pragma once

#include <cstdint>

#include "scanner/device_clock.hpp"

namespace curbline::lms200 {

inline constexpr std::int64_t turn_ns = 13'333'333;  ///< 75 turns a second

class TurnClock {
 public:
  void restart();

  /// When the last byte of a line left the scanner. `turns` after the line before, or more if it is late by more than
  /// eight such lines: then some were lost. Times go up.
  std::int64_t sent_ns(std::int64_t arrival_ns, std::int64_t turns);

 private:
  static constexpr std::int64_t window_ns = 1'000'000'000;

  scanner::LowerEnvelope offset_{window_ns};
  std::int64_t turns_ = 0, last_ns_ = INT64_MIN;
};

}  // namespace curbline::lms200
