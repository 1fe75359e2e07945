// The scanner's clock to the host's. A scanner stamps its lines with a counter of its own, which starts at power-on,
// wraps around and drifts; tilt frames bear the host's time. No I/O, heap or clock is used here: times come as
// arguments, nanoseconds. O(1) a call; not for interrupts.
//
// It is the host's steady clock that the scanner's is compared with; Now::to_host() (session.hpp) then gives a line the
// time to which the host's clock is set. A host's clock that is set forward looks like a line that is late, and until
// the line after it nothing tells the one from the other; a steady clock is not set.
//
// What travels only ever comes late, so the lowest of (arrival - device time) is the nearest to the offset of the
// clocks: a lower envelope. It is taken over the last 5 to 10 s, which a drift of 50 ppm moves by half a millisecond.
#pragma once

#include <cstdint>
#include <optional>

namespace curbline::scanner {

/// A counter that wraps around, as a number that does not: 24 bits of milliseconds (SCIP 2.0) wrap after 4.7 h, 32 bits
/// of microseconds (CoLa) after 72 min. A silence may last up to half of that.
class StampCounter {
 public:
  StampCounter(int bits, std::int64_t tick_ns) : mask_((std::uint64_t{1} << bits) - 1), tick_ns_(tick_ns) {}

  void restart() {
    ticks_.reset();
    back_ = 0;
  }

  /// Nanoseconds of the counter, the first as it is read. Nothing for a stamp that goes back.
  std::optional<std::int64_t> unwrap(std::uint32_t stamp);

  /// True when three in a row went back: the scanner has started anew, and so should the counter and the clock.
  bool lost() const { return back_ >= 3; }

  /// A counter that is known to be the time of a log, modulo its width: the time nearest to `near_ns` that `device_ns`
  /// can mean.
  std::int64_t nearest_ns(std::int64_t device_ns, std::int64_t near_ns) const;

 private:
  std::uint64_t mask_;
  std::int64_t tick_ns_;
  std::optional<std::int64_t> ticks_;
  int back_ = 0;
};

/// Lowest value of the last one to two windows. Times never go back.
class LowerEnvelope {
 public:
  explicit LowerEnvelope(std::int64_t window_ns) : window_ns_(window_ns) {}

  void restart() { now_ = before_ = none; }
  void add(std::int64_t value_ns, std::int64_t now_ns);
  bool empty() const { return now_ == none; }
  bool first_window() const { return before_ == none; }
  std::int64_t value_ns() const { return now_ < before_ ? now_ : before_; }

 private:
  static constexpr std::int64_t none = INT64_MAX;
  std::int64_t window_ns_;
  std::int64_t now_ = none, before_ = none, window_start_ns_ = 0;
};

class DeviceClock {
 public:
  /// `delay_ns`: from a line's stamp to its arrival at the least, for a scanner that never gives an anchor.
  explicit DeviceClock(std::int64_t delay_ns) : delay_ns_(delay_ns) {}

  void restart();

  /// A moment that the scanner told as it was: the reply to a question of the time, the time of transmission.
  void anchor(std::int64_t device_ns, std::int64_t steady_ns) { anchors_.add(steady_ns - device_ns, steady_ns); }

  /// A line's stamp and arrival. Their delay is not known, but constant: lines after the first 5 s follow the drift.
  void follow(std::int64_t device_ns, std::int64_t arrival_ns);

  /// Steady time of a moment of the scanner. Call anchor() or follow() before.
  std::int64_t to_steady(std::int64_t device_ns) const;

 private:
  std::int64_t delay_ns_;
  LowerEnvelope anchors_{5'000'000'000}, lines_{5'000'000'000};
  std::int64_t first_lines_ns_ = 0;  ///< envelope of the lines' first window
};

}  // namespace curbline::scanner
