// Converts the scanner's clock to the host's. A scanner stamps its lines with its own counter, which starts at
// power-on, wraps around and drifts; tilt frames have the host's time. No I/O, heap or clock is used here: times are
// arguments, in nanoseconds. O(1) a call; not for interrupts.
//
// The scanner's clock is compared with the host's steady clock; Now::to_host() (session.hpp) then converts a line's
// time to the host's adjustable clock. The alternative, a comparison with the adjustable clock, fails when that clock
// is set forward: until the next line, this cannot be distinguished from a late line. A steady clock is never set.
//
// Transmission can only delay, so the smallest (arrival - device time) is the closest to the offset of the clocks: a
// lower envelope. It is taken over the last 5 to 10 s, in which a drift of 50 ppm moves it by half a millisecond.
#pragma once

#include <cstdint>
#include <optional>

namespace curbline::scanner {

/// Extends a counter that wraps around to one that does not: 24 bits of milliseconds (SCIP 2.0) wrap after 4.7 h, 32
/// bits of microseconds (CoLa) after 72 min. A silence may last up to half of that.
class StampCounter {
 public:
  StampCounter(int bits, std::int64_t tick_ns) : mask_((std::uint64_t{1} << bits) - 1), tick_ns_(tick_ns) {}

  void restart() {
    ticks_.reset();
    back_ = 0;
  }

  /// Nanoseconds of the counter, starting with the value first read. Nothing for a stamp that goes back.
  std::optional<std::int64_t> unwrap(std::uint32_t stamp);

  /// True after three consecutive stamps that went back: the scanner has restarted, so counter and clock should be
  /// restarted too.
  bool lost() const { return back_ >= 3; }

  /// For a counter that is known to be the time of a log modulo its width: the time nearest to `near_ns` that
  /// `device_ns` can mean.
  std::int64_t nearest_ns(std::int64_t device_ns, std::int64_t near_ns) const;

 private:
  std::uint64_t mask_;
  std::int64_t tick_ns_;
  std::optional<std::int64_t> ticks_;
  int back_ = 0;
};

/// The lowest value of the last one to two windows. Times never go back.
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
  /// `delay_ns`: the smallest delay from a line's stamp to its arrival, for a scanner that never gives an anchor.
  explicit DeviceClock(std::int64_t delay_ns) : delay_ns_(delay_ns) {}

  void restart();

  /// A time that the scanner reported as it was: in the reply to a time request, or as a time of transmission.
  void anchor(std::int64_t device_ns, std::int64_t steady_ns) { anchors_.add(steady_ns - device_ns, steady_ns); }

  /// A line's stamp and arrival. Their delay is unknown but constant: after the first 5 s, lines are used to follow the
  /// drift.
  void follow(std::int64_t device_ns, std::int64_t arrival_ns);

  /// Converts a scanner time to steady time. Call anchor() or follow() before.
  std::int64_t to_steady(std::int64_t device_ns) const;

 private:
  std::int64_t delay_ns_;
  LowerEnvelope anchors_{5'000'000'000}, lines_{5'000'000'000};
  std::int64_t first_lines_ns_ = 0;  ///< the envelope of the lines in their first window
};

}  // namespace curbline::scanner
