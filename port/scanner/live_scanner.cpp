#include "scanner/live_scanner.hpp"

#include <time.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>

namespace curbline::scanner {
namespace {

constexpr port::Milliseconds send_patience{500}, look_again{50};

std::int64_t nanoseconds(port::Milliseconds time) {
  return std::chrono::nanoseconds(time).count();
}

std::int64_t read_clock(clockid_t clock) {
  timespec t{};
  ::clock_gettime(clock, &t);
  return std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec;
}

}  // namespace

std::int64_t steady_now_ns() {
  return read_clock(CLOCK_MONOTONIC);
}

Now host_now() {
  Now now;
  std::int64_t least_ns = INT64_MAX;
  for (int i = 0; i < 2; ++i) {  // an interruption between the clock readings is unlikely twice in a row
    const std::int64_t before_ns = steady_now_ns(), host_ns = read_clock(CLOCK_REALTIME);
    const std::int64_t took_ns = steady_now_ns() - before_ns;
    if (took_ns >= least_ns) continue;
    least_ns = took_ns;
    now = {host_ns, before_ns};
  }
  return now;
}

LiveScanner::~LiveScanner() {
  if (stream_.is_open()) stream_.write(session_.farewell(), send_patience);
}

int LiveScanner::open() {
  left_ = {};
  more_ = false;
  baud_ = 0;
  const int failed = stream_.connect(connect_patience);
  const Now now = host_now();
  next_attempt_ns_ = now.steady_ns + nanoseconds(options_.retry_after);
  if (failed != 0) return last_error_ = failed;
  ++connections_;
  last_line_ns_ = now.steady_ns;
  session_.restart(now);
  return 0;
}

LiveScanner::Event LiveScanner::read(port::Milliseconds patience) {
  const std::int64_t until_ns = steady_now_ns() + nanoseconds(patience);
  for (bool looked = false;; looked = true) {
    if (!stream_.is_open()) return reopen(patience);
    if (more_) {
      more_ = session_.take(left_, received_);
      if (more_) {
        last_line_ns_ = received_.steady_ns;
        told_lost_ = false;
        return Event::line;
      }
    }
    if (const auto lost = send_what_is_due()) return *lost;
    const std::int64_t now_ns = steady_now_ns();
    if (now_ns - last_line_ns_ > nanoseconds(options_.silence)) return lose(ETIMEDOUT);
    const auto rest = std::chrono::duration_cast<port::Milliseconds>(std::chrono::nanoseconds(until_ns - now_ns));
    if (looked && rest.count() <= 0) return Event::nothing;
    std::size_t count = 0;
    const auto got = stream_.read(buffer_, count, std::clamp(rest, port::Milliseconds{0}, look_again));
    if (got == port::ByteStream::Read::closed) return lose(0);
    if (got == port::ByteStream::Read::bytes) {
      received_ = host_now();
      left_ = std::span(buffer_).first(count);
      more_ = true;
    } else if (rest > look_again && steady_now_ns() - now_ns < nanoseconds(look_again) / 2) {
      return Event::nothing;  // a signal ended the wait early
    }
  }
}

/// Sets the speed first: the command must be sent at the speed that the session has chosen.
std::optional<LiveScanner::Event> LiveScanner::send_what_is_due() {
  const auto command = session_.to_send(host_now());
  if (session_.baud() != baud_) {
    baud_ = session_.baud();
    if (const int failed = stream_.set_baud(baud_); failed != 0) return lose(failed);
  }
  if (!stream_.write(command, send_patience)) return lose(0);
  return std::nullopt;
}

LiveScanner::Event LiveScanner::reopen(port::Milliseconds patience) {
  if (!options_.reconnect && connections_ > 0) return Event::lost;
  const std::int64_t wait_ns = next_attempt_ns_ - steady_now_ns();
  if (wait_ns > 0) {
    std::this_thread::sleep_for(std::min(std::chrono::nanoseconds(wait_ns), std::chrono::nanoseconds(patience)));
    return Event::nothing;
  }
  return open() == 0 ? Event::nothing : tell_lost();
}

LiveScanner::Event LiveScanner::lose(int error) {
  stream_.close();
  last_error_ = error;
  return tell_lost();
}

LiveScanner::Event LiveScanner::tell_lost() {
  return std::exchange(told_lost_, true) ? Event::nothing : Event::lost;
}

}  // namespace curbline::scanner
