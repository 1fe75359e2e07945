// A live scanner's connection: how long calls wait, when it is made again, what is reported, and how it is closed.
#include <pty.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "cola/session.hpp"
#include "lms200/session.hpp"
#include "scanner/live_scanner.hpp"
#include "scanner_listener.hpp"
#include "scanner_support.hpp"
#include "scip2/session.hpp"

namespace curbline::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using scanner::LiveScanner;
using Event = scanner::LiveScanner::Event;

port::ByteStream stream_to(std::uint16_t port) {
  std::string error;
  return *port::ByteStream::tcp("127.0.0.1", port, error);
}

/// The scanner's end of a connection.
class Accepted {
 public:
  explicit Accepted(const Listener& listener) : fd_(::accept(listener.fd(), nullptr, nullptr)) { REQUIRE(fd_ >= 0); }
  ~Accepted() { close(); }
  Accepted(const Accepted&) = delete;
  Accepted& operator=(const Accepted&) = delete;

  void send(const Bytes& bytes) const { ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }

  /// Receives until the other side closes.
  Bytes rest() const {
    Bytes bytes(1000);
    std::size_t size = 0;
    for (ssize_t got = 1; got > 0 && size < bytes.size(); size += static_cast<std::size_t>(std::max<ssize_t>(got, 0)))
      got = ::recv(fd_, bytes.data() + size, bytes.size() - size, 0);
    bytes.resize(size);
    return bytes;
  }

  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
};

/// A line that a CoLa session accepts at any time.
Bytes cola_line() {
  Scanner scanner = std::move(small_scanners()[1]);
  start(scanner);
  return telegrams_of(scanner, 1)[0];
}

TEST_CASE("connection: a scanner's stream is stopped before it is closed") {
  scip2::Session scip2;
  cola::Session cola;
  lms200::Session lms200(181);
  const Bytes stop_cola = from_hex("02 02 02 02 00 00 00 11 73 45 4E 20 4C 4D 44 73 63 61 6E 64 61 74 61 20 00 32");
  for (const auto& [session, stop] : {std::pair<scanner::Session*, Bytes>{&scip2, {'Q', 'T', '\n'}},
                                      {&cola, stop_cola},
                                      {&lms200, from_hex("02 00 02 00 20 25 35 08")}}) {
    const Listener listener;
    { CHECK(LiveScanner(*session, stream_to(listener.port()), {}).open() == 0); }
    CHECK(Accepted(listener).rest() == stop);
  }
}

TEST_CASE("connection: attempts keep the given interval, even if they succeed and the scanner is lost at once") {
  const Listener listener;
  cola::Session session;
  LiveScanner live(session, stream_to(listener.port()), {.retry_after = 200ms, .silence = 1ms});
  const auto before = Clock::now();
  while (live.connections() < 3 && Clock::now() - before < 10s) live.read(5ms);
  CHECK(live.connections() == 3);
  CHECK(Clock::now() - before >= 400ms);
}

TEST_CASE("connection: a scanner is silent when its last line is long ago, not its connection") {
  const Listener listener;
  const Bytes line = cola_line();
  cola::Session session;
  LiveScanner live(session, stream_to(listener.port()), {.silence = 600ms});
  REQUIRE(live.open() == 0);
  const Accepted scanner(listener);
  for (int i = 0; i < 8; ++i) {
    scanner.send(line);
    CHECK(live.read(500ms) == Event::line);
    CHECK(live.read(100ms) == Event::nothing);
  }
  CHECK(live.connections() == 1);
}

TEST_CASE("connection: a loss is told once, and again when there has been a line since") {
  std::uint16_t free_port = 0;
  {
    const Listener gone;
    free_port = gone.port();
  }
  const Bytes line = cola_line();
  cola::Session session;
  LiveScanner live(session, stream_to(free_port), {.retry_after = 5ms, .silence = 10s});
  CHECK(live.read(20ms) == Event::lost);
  for (int i = 0; i < 10; ++i) CHECK(live.read(20ms) == Event::nothing);
  CHECK(live.last_error() == ECONNREFUSED);
  const Listener listener("127.0.0.1", free_port);
  for (int connection = 0; connection < 2; ++connection) {
    for (int i = 0; i < 100 && !live.is_open(); ++i) CHECK(live.read(20ms) == Event::nothing);
    REQUIRE(live.is_open());
    Accepted scanner(listener);
    scanner.send(line);
    CHECK(live.read(5s) == Event::line);
    scanner.close();
    CHECK(live.read(5s) == Event::lost);
    CHECK(live.last_error() == 0);
  }
}

/// A protocol in which only reading matters.
class ReadingSession final : public scanner::Session {
 public:
  using Take = bool (*)(std::span<const std::uint8_t>& bytes);
  explicit ReadingSession(Take how) : take_(how) {}

  void restart(const scanner::Now&) override {}
  std::span<const std::uint8_t> to_send(const scanner::Now&) override { return {}; }
  bool take(std::span<const std::uint8_t>& bytes, const scanner::Now&) override { return take_(bytes); }
  std::int64_t log_time_ns(std::int64_t near_ns) const override { return near_ns; }
  std::span<const std::uint8_t> farewell() const override { return {}; }

 private:
  Take take_;
};

/// Finds no line and is slow, so that more bytes are always available.
bool no_line(std::span<const std::uint8_t>& bytes) {
  std::this_thread::sleep_for(2ms);
  bytes = {};
  return false;
}

bool line_a_byte(std::span<const std::uint8_t>& bytes) {
  if (bytes.empty()) return false;
  bytes = bytes.subspan(1);
  return true;
}

TEST_CASE("connection: bytes without a line do not hold a reader longer than its timeout") {
  const Listener listener;
  ReadingSession session(no_line);
  LiveScanner live(session, stream_to(listener.port()), {.silence = 2s});
  REQUIRE(live.open() == 0);
  Accepted scanner(listener);
  std::atomic<bool> stop = false, stopped = false;
  std::thread noise([&] {
    const Bytes bytes(1000, 0x55);
    while (!stop) scanner.send(bytes);
    stopped = true;
  });
  std::this_thread::sleep_for(20ms);
  const auto before = Clock::now();
  CHECK(live.read(50ms) == Event::nothing);
  const auto took = Clock::now() - before;
  CHECK(took >= 45ms);
  CHECK(took < 1s);
  stop = true;
  while (!stopped) live.read(0ms);  // it may be waiting for space in the socket
  noise.join();
}

TEST_CASE("connection: a command to a scanner that has closed fails, and no SIGPIPE ends the program") {
  const Listener listener;
  port::ByteStream stream = stream_to(listener.port());
  REQUIRE(stream.connect(1s) == 0);
  Accepted(listener).close();
  const Bytes command{1, 2, 3};
  bool written = true;
  for (int i = 0; i < 100 && written; ++i) {  // the first may still be taken
    written = stream.write(command, 1s);
    std::this_thread::sleep_for(10ms);
  }
  CHECK_FALSE(written);
  CHECK_FALSE(stream.is_open());
}

TEST_CASE("connection: a look without waiting gives the line that is there") {
  const Listener listener;
  cola::Session session;
  LiveScanner live(session, stream_to(listener.port()), {});
  REQUIRE(live.open() == 0);
  const Accepted scanner(listener);
  scanner.send(cola_line());
  std::this_thread::sleep_for(50ms);
  CHECK(live.read(0ms) == Event::line);
}

TEST_CASE("connection: one that is opened anew gives nothing of what came before") {
  const Listener listener;
  ReadingSession session(line_a_byte);
  LiveScanner live(session, stream_to(listener.port()), {});
  REQUIRE(live.open() == 0);
  const Accepted scanner(listener);
  scanner.send({1, 2});
  CHECK(live.read(5s) == Event::line);
  REQUIRE(live.open() == 0);
  CHECK(live.read(50ms) == Event::nothing);
}

TEST_CASE("connection: a serial line that is opened anew has the scanner's speed, whatever it had become") {
  int ours = -1, theirs = -1;
  std::array<char, 64> name{};
  REQUIRE(::openpty(&ours, &theirs, name.data(), nullptr, nullptr) == 0);
  lms200::Session session(181);
  LiveScanner live(session, port::ByteStream::serial(name.data()), {.retry_after = 1ms, .silence = 100ms});
  const auto speed = [theirs] {
    termios line{};
    ::tcgetattr(theirs, &line);
    return ::cfgetospeed(&line);
  };
  REQUIRE(live.open() == 0);
  CHECK(live.read(1ms) == Event::nothing);
  CHECK(speed() == B500000);
  termios line{};
  ::tcgetattr(theirs, &line);
  ::cfsetspeed(&line, B9600);
  ::tcsetattr(theirs, TCSANOW, &line);
  for (int i = 0; i < 100 && (live.connections() < 2 || speed() != B500000); ++i) live.read(10ms);
  CHECK(live.connections() == 2);
  CHECK(speed() == B500000);
  ::close(theirs);
  ::close(ours);
}

TEST_CASE("connection: a serial line is raw, whatever was set before: no flow control, one stop bit, no echo") {
  int ours = -1, theirs = -1;
  std::array<char, 64> name{};
  REQUIRE(::openpty(&ours, &theirs, name.data(), nullptr, nullptr) == 0);
  termios line{};
  constexpr tcflag_t control = CRTSCTS | CSTOPB, local = ECHO | ICANON;
  ::tcgetattr(theirs, &line);
  line.c_cflag |= control;
  line.c_lflag |= local;
  ::tcsetattr(theirs, TCSANOW, &line);
  ::tcgetattr(theirs, &line);
  REQUIRE((line.c_cflag & control) == control);
  REQUIRE((line.c_lflag & local) == local);
  port::ByteStream stream = port::ByteStream::serial(name.data());
  REQUIRE(stream.connect(1s) == 0);
  ::tcgetattr(theirs, &line);
  CHECK((line.c_cflag & control) == 0);
  CHECK((line.c_lflag & local) == 0);
  ::close(theirs);
  ::close(ours);
}

TEST_CASE("connection: a serial line that another program has locked is refused as busy, and free once that is gone") {
  int ours = -1, theirs = -1;
  std::array<char, 64> name{};
  REQUIRE(::openpty(&ours, &theirs, name.data(), nullptr, nullptr) == 0);
  port::ByteStream first = port::ByteStream::serial(name.data()), second = port::ByteStream::serial(name.data());
  REQUIRE(first.connect(1s) == 0);
  CHECK(second.connect(1s) == EBUSY);
  CHECK_FALSE(second.is_open());
  CHECK(first.connect(1s) == 0);  // anew, in spite of its own lock
  first.close();
  CHECK(second.connect(1s) == 0);
  ::close(theirs);
  ::close(ours);
}

}  // namespace
}  // namespace curbline::test
