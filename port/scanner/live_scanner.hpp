// A scanner on the wire: a session (the protocol) over a byte stream, with the host's clocks. What replay and the
// daemon read scan lines from. Nothing is allocated after it is made. One thread; not for interrupts.
//
//   scip2::Session session;
//   LiveScanner scanner(session, std::move(stream), {.reconnect = true});
//   while (running) if (scanner.read(100ms) == LiveScanner::Event::line) use(session.line());
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "byte_stream/byte_stream.hpp"
#include "scanner/session.hpp"

namespace curbline::scanner {

/// For one attempt to connect.
inline constexpr port::Milliseconds connect_patience{2'000};

struct LiveOptions {
  bool reconnect = true;                ///< false: a connection that ends is the end
  port::Milliseconds retry_after{500};  ///< from one attempt to connect to the next, at the least
  port::Milliseconds silence{3'000};    ///< without a line: the scanner is taken as lost, and connected anew
};

class LiveScanner {
 public:
  enum class Event : unsigned char {
    line,     ///< session.line() is new
    nothing,  ///< not within the time given, or a signal came
    lost,  ///< the connection ended, could not be made, or the scanner is silent. Told once until a line comes again;
           ///< read() goes on. Where a connection that ended is the end, told each time
  };

  /// `session` must outlive it.
  LiveScanner(Session& session, port::ByteStream stream, const LiveOptions& options)
      : session_(session), stream_(std::move(stream)), options_(options) {}
  LiveScanner(const LiveScanner&) = delete;
  LiveScanner& operator=(const LiveScanner&) = delete;

  /// Stops the scanner's stream, for which it waits half a second at most, and closes (ByteStream::close()).
  ~LiveScanner();

  /// Connects now: waits `connect_patience` at most. 0, or the errno of what failed. read() does it by itself where it
  /// may reconnect.
  int open();

  /// Waits `patience` at most; where it has to connect, `connect_patience` instead. Each command that the connection
  /// does not take at once adds half a second at most. A serial line that is lost is closed, which may wait too.
  Event read(port::Milliseconds patience);

  bool is_open() const { return stream_.is_open(); }
  std::uint64_t connections() const { return connections_; }  ///< made so far: one more than restarts survived
  int last_error() const { return last_error_; }  ///< errno of the last attempt that failed, 0: the other side closed

 private:
  Event reopen(port::Milliseconds patience);
  Event lose(int error);
  Event tell_lost();
  std::optional<Event> send_what_is_due();

  Session& session_;
  port::ByteStream stream_;
  LiveOptions options_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::span<const std::uint8_t> left_{};                 ///< of buffer_, not yet read by the session
  bool more_ = false;                                    ///< the session may hold another line
  bool told_lost_ = false;                               ///< and no line since
  std::int64_t last_line_ns_ = 0, next_attempt_ns_ = 0;  ///< steady
  Now received_{};
  std::uint64_t connections_ = 0;
  int last_error_ = 0;
  int baud_ = 0;
};

/// The host's clocks now: CLOCK_REALTIME, which stamps CAN frames too, and CLOCK_MONOTONIC.
Now host_now();

/// CLOCK_MONOTONIC alone.
std::int64_t steady_now_ns();

}  // namespace curbline::scanner
