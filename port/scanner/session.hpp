// One conversation with a laser scanner over its own host protocol: bytes in, scan lines and commands out. Pure: no
// I/O, heap, clock or exceptions, so that a board with a UART or a lwIP socket uses it as the host does;
// scanner/live_scanner.hpp joins it to a socket or serial line. Not for interrupts: one context calls it.
// Implementations: scip2/session.hpp, cola/session.hpp, lms200/session.hpp.
//
// What is damaged (a wrong sum or length, a telegram that is cut, bytes that belong to none) is dropped and counted,
// and the next whole telegram is found again. A scanner that refuses a command, or reports a fault of its own, is a
// `problem()`.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace curbline::scanner {

/// One moment on two clocks of the host: `host_ns` on that of tilt frames and poses, which may be set to another time;
/// `steady_ns` on one that never jumps, which serves the time-outs and is what a scanner's own clock is compared with.
/// They may be the same clock, if nobody sets it.
struct Now {
  std::int64_t host_ns = 0;
  std::int64_t steady_ns = 0;

  /// A moment of the steady clock on the host's, as that is set now.
  std::int64_t to_host(std::int64_t moment_ns) const { return moment_ns + (host_ns - steady_ns); }
};

/// A whole scan line.
struct Line {
  std::int64_t host_ns = 0;        ///< of beam 0, on the host's clock
  std::int64_t device_ns = 0;      ///< the same on the scanner's, counting on where its counter wraps; 0: it gives none
  float first_bearing_rad = 0.0f;  ///< counterclockwise, 0 ahead: as LaserSettings has it
  float bearing_step_rad = 0.0f;
  std::span<const float> ranges_m;  ///< NaN: no return. Valid until the session takes more bytes
};

/// Since the session was made; restarts do not clear them.
struct Counters {
  std::uint64_t lines = 0;          ///< whole scan lines
  std::uint64_t bad_checksum = 0;   ///< telegrams or blocks
  std::uint64_t wrong_length = 0;   ///< telegrams whose length is impossible, or not that of what they hold
  std::uint64_t cut = 0;            ///< telegrams that another one interrupted
  std::uint64_t bytes_skipped = 0;  ///< while looking for the next telegram
  std::uint64_t malformed = 0;      ///< well-summed telegrams whose fields do not fit together
  std::uint64_t unsupported = 0;    ///< lines of a kind that is not read (interlaced partial scans, other units)
  std::uint64_t stamps_back = 0;    ///< lines whose time stamp went back
  std::uint64_t refused = 0;        ///< commands that the scanner refused
  std::uint64_t device_errors = 0;  ///< faults that the scanner reports of itself
  std::uint64_t resent = 0;         ///< commands without a reply in time
};

class Session {
 public:
  /// A connection was made, or made again: forgets what was half read, and begins to set the scanner up.
  virtual void restart(const Now& now) = 0;

  /// The command that is due, or nothing. Ask when a connection is made, after every take() and ten times a second.
  /// Valid until the next call; send all of it.
  virtual std::span<const std::uint8_t> to_send(const Now& now) = 0;

  /// Reads bytes up to the end of the next scan line and takes those it used from the front. True: line() is new; call
  /// again, with what is left of `bytes` or none, since it may hold more. False: all bytes were used.
  virtual bool take(std::span<const std::uint8_t>& bytes, const Now& now) = 0;

  virtual const Line& line() const = 0;
  virtual const Counters& counters() const = 0;

  /// The time nearest to `near_ns` that the line's stamp can mean, if the scanner's counter is that of a log.
  virtual std::int64_t log_time_ns(std::int64_t near_ns) const = 0;

  /// What the scanner refused or reported last, and what to do about it; empty if nothing. Static text.
  virtual std::string_view problem() const = 0;

  /// What stops the scanner's stream before a connection is closed.
  virtual std::span<const std::uint8_t> farewell() const = 0;

  /// Bits a second that a serial line should have now; 0 where there is none.
  virtual int baud() const { return 0; }

 protected:
  ~Session() = default;
};

}  // namespace curbline::scanner
