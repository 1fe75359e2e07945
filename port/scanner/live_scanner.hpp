// A connected scanner: a session (the protocol) over a byte stream, with the host's clocks. replay and the daemon read
// scan lines from it. Nothing is allocated after construction. One thread; not for interrupts.
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

/// Time limit of one attempt to connect.
inline constexpr port::Milliseconds connect_patience{2'000};

struct LiveOptions {
  bool reconnect = true;                ///< false: the end of a connection is final
  port::Milliseconds retry_after{500};  ///< at least this long between attempts to connect
  port::Milliseconds silence{3'000};    ///< without a line: the scanner is taken to be lost and is reconnected
};

class LiveScanner {
 public:
  enum class Event : unsigned char {
    line,     ///< session.line() is new
    nothing,  ///< no line within the time limit, or a signal came
    lost,     ///< the connection ended, could not be made, or the scanner is silent. Reported once until the next line
              ///< comes; read() retries. Without reconnection, reported by every call
  };

  /// `session` must outlive it.
  LiveScanner(Session& session, port::ByteStream stream, const LiveOptions& options)
      : session_(session), stream_(std::move(stream)), options_(options) {}
  LiveScanner(const LiveScanner&) = delete;
  LiveScanner& operator=(const LiveScanner&) = delete;

  /// Stops the scanner's stream, waiting half a second at most, and closes (ByteStream::close()).
  ~LiveScanner();

  /// Connects now, waiting `connect_patience` at most. Returns 0, or the errno of the failure. If it may reconnect,
  /// read() does this by itself.
  int open();

  /// Waits `patience` at most, or `connect_patience` if it has to connect. Each command that the connection does not
  /// accept at once adds half a second at most. A lost serial line is closed, which may wait too.
  Event read(port::Milliseconds patience);

  bool is_open() const { return stream_.is_open(); }
  std::uint64_t connections() const { return connections_; }  ///< made so far: one more than restarts survived
  int last_error() const { return last_error_; }  ///< errno of the last failed attempt, 0: closed by the other side

 private:
  Event reopen(port::Milliseconds patience);
  Event lose(int error);
  Event tell_lost();
  std::optional<Event> send_what_is_due();

  Session& session_;
  port::ByteStream stream_;
  LiveOptions options_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::span<const std::uint8_t> left_{};                 ///< part of buffer_ that the session has not read yet
  bool more_ = false;                                    ///< the session may hold another line
  bool told_lost_ = false;                               ///< and no line came since
  std::int64_t last_line_ns_ = 0, next_attempt_ns_ = 0;  ///< steady clock
  Now received_{};
  std::uint64_t connections_ = 0;
  int last_error_ = 0;
  int baud_ = 0;
};

/// The current time of the host's clocks: CLOCK_REALTIME, which also stamps CAN frames, and CLOCK_MONOTONIC.
Now host_now();

/// CLOCK_MONOTONIC only.
std::int64_t steady_now_ns();

}  // namespace curbline::scanner
