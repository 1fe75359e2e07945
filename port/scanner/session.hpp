// One conversation with a laser scanner over its own host protocol: bytes in, scan lines and commands out. Pure: no
// I/O, heap, clock or exceptions, so that a board with a UART or an lwIP socket can use it as the host does;
// scanner/live_scanner.hpp connects it to a socket or serial line. Not for interrupts: called from one context.
// Implementations: scip2/session.hpp, cola/session.hpp, lms200/session.hpp.
//
// Damaged input (a wrong checksum or length, a truncated telegram, bytes outside telegrams) is dropped and counted, and
// the session resynchronises to the next complete telegram. problem() says if a scanner refuses a command or reports a
// fault.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace curbline::scanner {

/// One moment on two clocks of the host: `host_ns` on the clock of tilt frames and poses, which may be set; `steady_ns`
/// on one that never jumps, which is used for time-outs and for comparison with a scanner's clock. They may be the same
/// clock if nobody sets it.
struct Now {
  std::int64_t host_ns = 0;
  std::int64_t steady_ns = 0;

  /// Converts a moment of the steady clock to the host's clock, as that is set now.
  std::int64_t to_host(std::int64_t moment_ns) const { return moment_ns + (host_ns - steady_ns); }
};

/// A complete scan line.
struct Line {
  std::int64_t host_ns = 0;    ///< time of beam 0, host's clock
  std::int64_t device_ns = 0;  ///< the same on the scanner's clock, continued where its counter wraps; 0: it has none
  float first_bearing_rad = 0.0f;  ///< counterclockwise, 0 ahead, as in LaserSettings
  float bearing_step_rad = 0.0f;
  std::span<const float> ranges_m;  ///< NaN: no return. Valid until the session takes more bytes
};

/// Totals since the session was created; restarts do not clear them.
struct Counters {
  std::uint64_t lines = 0;          ///< complete scan lines
  std::uint64_t bad_checksum = 0;   ///< telegrams or blocks
  std::uint64_t wrong_length = 0;   ///< telegrams whose length is impossible, or does not match their content
  std::uint64_t cut = 0;            ///< telegrams that were interrupted by another one
  std::uint64_t bytes_skipped = 0;  ///< while looking for the next telegram
  std::uint64_t malformed = 0;      ///< telegrams with a valid checksum whose fields are inconsistent
  std::uint64_t unsupported = 0;    ///< lines of an unsupported kind (interlaced partial scans, other units)
  std::uint64_t stamps_back = 0;    ///< lines whose time stamp went back
  std::uint64_t refused = 0;        ///< commands that the scanner refused
  std::uint64_t device_errors = 0;  ///< faults that the scanner reports about itself
  std::uint64_t resent = 0;         ///< commands without a reply in time
};

class Session {
 public:
  /// Called after every connection or reconnection: discards partial input and begins to set the scanner up.
  virtual void restart(const Now& now) = 0;

  /// The command that is due, or nothing. Call it after connecting, after every take() and ten times a second. Valid
  /// until the next call; send all of it.
  virtual std::span<const std::uint8_t> to_send(const Now& now) = 0;

  /// Reads bytes up to the end of the next scan line and removes those used from the front. True: line() is new; call
  /// again, with the rest of `bytes` or with none, since there may be another line. False: all bytes were used.
  virtual bool take(std::span<const std::uint8_t>& bytes, const Now& now) = 0;

  const Line& line() const { return line_; }
  const Counters& counters() const { return counters_; }
  /// The last refusal or report of the scanner, and what to do about it; empty if there is none. Static text.
  std::string_view problem() const { return problem_; }

  /// The time nearest to `near_ns` that the line's stamp can mean, if the scanner's counter is that of a log.
  virtual std::int64_t log_time_ns(std::int64_t near_ns) const = 0;

  /// The command that stops the scanner's stream before a connection is closed.
  virtual std::span<const std::uint8_t> farewell() const = 0;

  /// Bits a second that a serial line should have now; 0 without a serial line.
  virtual int baud() const { return 0; }

 protected:
  ~Session() = default;

  /// Is the command in question to be sent now: for the first time, or again, counted, as half a second has passed
  /// without a reply?
  bool is_due(const Now& now) {
    if (!due_) {
      if (now.steady_ns - sent_ns_ < patience_ns) return false;
      ++counters_.resent;
    }
    due_ = false;
    sent_ns_ = now.steady_ns;
    return true;
  }

  static constexpr std::int64_t patience_ns = 500'000'000;
  bool due_ = true;           ///< the command has not been sent
  std::int64_t sent_ns_ = 0;  ///< when it was, steady clock
  Line line_{};
  Counters counters_{};
  std::string_view problem_{};
};

}  // namespace curbline::scanner
