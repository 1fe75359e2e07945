// Times of scan lines without time stamps, from their arrival and the steady turning of the mirror. Lines are a whole
// number of turns apart; the count of turns is a clock, which the lower envelope of the arrivals ties to the host's
// steady clock (device_clock.hpp gives the reason). Lines that are held back in a driver and then read together are
// therefore not shifted. Pure; O(1) a line.
#pragma once

#include <cstdint>

#include "scanner/device_clock.hpp"

namespace curbline::lms200 {

inline constexpr std::int64_t turn_ns = 13'333'333;  ///< 75 turns a second

class TurnClock {
 public:
  void restart();

  /// The time at which the last byte of a line left the scanner. The line comes `turns` after the previous one, or more
  /// if it is late by more than eight such lines: then lines were lost. Times increase.
  std::int64_t sent_ns(std::int64_t arrival_ns, std::int64_t turns);

 private:
  static constexpr std::int64_t window_ns = 1'000'000'000;

  scanner::LowerEnvelope offset_{window_ns};
  std::int64_t turns_ = 0, last_ns_ = INT64_MIN;
};

}  // namespace curbline::lms200
