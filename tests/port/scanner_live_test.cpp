// Scanners over real TCP connections and ptys on this machine: set-up, restarts, closing, time.
#include <sys/socket.h>
#include <unistd.h>
#include <catch2/catch.hpp>

#include <atomic>
#include <thread>

#include "cola/session.hpp"
#include "lms200/session.hpp"
#include "scanner/live_scanner.hpp"
#include "scanner_listener.hpp"
#include "scanner_support.hpp"
#include "support/heap_count.hpp"
#include "tools/formats_support.hpp"

namespace curbline::test {
namespace {

using namespace std::chrono_literals;
using scanner::LiveScanner;

/// A simulated scanner that runs in a thread.
class Running {
 public:
  Running(const Scanner& s, int lines, tools::ServerOptions options)
      : server_(s.protocol, tools::ScanFeed::from_log(directory_.write("scans.carmen", carmen_text(s.first, lines))),
                s.name, std::move(options)),
        thread_([this] { server_.run(stop_); }) {}
  ~Running() {
    stop_ = true;
    thread_.join();
  }

  port::ByteStream stream() const {
    std::string error;
    return server_.path().empty() ? *port::ByteStream::tcp("127.0.0.1", server_.port(), error)
                                  : port::ByteStream::serial(server_.path());
  }

 private:
  tools::testing::TemporaryDirectory directory_;
  std::atomic<bool> stop_ = false;
  tools::ScannerServer server_;
  std::thread thread_;
};

struct Heard {
  std::vector<int> lines;
  std::vector<std::int64_t> host_ns, device_ns;
};

/// Reads until line `last` has arrived or, if `last` is negative, the scanner has ended; for at most ten seconds.
Heard listen(const Scanner& s, LiveScanner& live, int last) {
  Heard heard;
  const auto give_up = std::chrono::steady_clock::now() + 10s;
  while (std::chrono::steady_clock::now() < give_up && (heard.lines.empty() || heard.lines.back() != last)) {
    const auto event = live.read(100ms);
    if (event == LiveScanner::Event::line) {
      heard.lines.push_back(index_of(s.first, s.session->line().ranges_m));
      heard.host_ns.push_back(s.session->line().host_ns);
      heard.device_ns.push_back(s.session->line().device_ns);
    } else if (event == LiveScanner::Event::lost && live.connections() > 0 && last < 0) {
      break;
    }
  }
  return heard;
}

std::vector<int> numbers(int count, const std::set<int>& without = {}) {
  std::vector<int> all;
  for (int i = 0; i < count; ++i) {
    if (!without.contains(i)) all.push_back(i);
  }
  return all;
}

TEST_CASE("live: every line of a simulated scanner arrives, and its end is told") {
  for (Scanner& s : whole_scanners()) {
    INFO(s.name);
    const Running running(s, 60, {.speed = 0});
    LiveScanner live(*s.session, running.stream(), {.reconnect = false});
    REQUIRE(live.open() == 0);
    CHECK(listen(s, live, -2).lines == numbers(60));
    CHECK_FALSE(live.is_open());
    CHECK(s.session->counters().resent == 0);
    CHECK(live.read(10ms) == LiveScanner::Event::lost);
  }
}

TEST_CASE("live: a scanner that is switched off and on is set up again, and costs the lines of that time") {
  for (Scanner& s : small_scanners()) {
    INFO(s.name);
    const Running running(s, 60, {.speed = 0, .restart_before = {20, 40}});
    LiveScanner live(*s.session, running.stream(), {.retry_after = 20ms});
    const Heard heard = listen(s, live, 59);
    CHECK(heard.lines == numbers(60, {20, 40}));
    if (s.name != "lms200") CHECK(live.connections() == 3);
  }
}

TEST_CASE("live: damaged telegrams on the wire cost their lines and are counted") {
  for (Scanner& s : small_scanners()) {
    INFO(s.name);
    const auto damage = [](Bytes& telegram, long line) {
      if (line == 10) telegram[telegram.size() / 2] ^= 0x04;
      if (line == 20) telegram.resize(telegram.size() / 2);
    };
    const Running running(s, 40, {.speed = 0, .damage = damage});
    LiveScanner live(*s.session, running.stream(), {});
    const Heard heard = listen(s, live, 39);
    CHECK(heard.lines == numbers(40, {10, 20}));
    CHECK(s.session->counters().bad_checksum + s.session->counters().wrong_length + s.session->counters().cut >= 2);
  }
}

TEST_CASE("live: times are the host's, go up, and keep the lines' distance") {
  for (Scanner& s : small_scanners()) {
    INFO(s.name);
    const std::int64_t before_ns = scanner::host_now().host_ns;
    const Running running(s, 40, {.speed = 1});
    LiveScanner live(*s.session, running.stream(), {});
    const Heard heard = listen(s, live, 39);
    REQUIRE(heard.lines.size() == 40);
    for (std::size_t i = 1; i < heard.host_ns.size(); ++i) CHECK(heard.host_ns[i] > heard.host_ns[i - 1]);
    CHECK(heard.host_ns.front() > before_ns - 20'000'000);
    CHECK(heard.host_ns.back() < scanner::host_now().host_ns);
    const double period_s = static_cast<double>(line_of(s.first, 1).time_ns - line_of(s.first, 0).time_ns) * 1e-9;
    const double measured_s = static_cast<double>(heard.host_ns[39] - heard.host_ns[9]) * 1e-9 / 30;
    CHECK(measured_s == Approx(period_s).margin(1e-3));
  }
}

TEST_CASE("live: an LMS200 is found at each of its speeds, and brought to 38400 baud from the lower ones") {
  for (const auto& [baud, end] : {std::pair{38'400, 38'400}, {9'600, 38'400}, {19'200, 38'400}, {500'000, 500'000}}) {
    INFO(baud);
    Scanner s = std::move(small_scanners()[2]);
    const Running running(s, 40, {.speed = 0, .baud = baud});
    LiveScanner live(*s.session, running.stream(), {.silence = 10s});
    REQUIRE(live.open() == 0);
    const Heard heard = listen(s, live, -2);
    CHECK(heard.lines.size() == (end == 500'000 ? 40 : 8));  // at 38400 baud, 212 bytes take 4.1 turns on the wire
    CHECK(s.session->baud() == end);
  }
}

TEST_CASE("live: what is not there cannot be opened, and why is told") {
  std::string error;
  cola::Session session;
  auto stream = port::ByteStream::tcp("127.0.0.1", 1, error);
  REQUIRE(stream);
  LiveScanner live(session, std::move(*stream), {.retry_after = 10ms});
  CHECK(live.open() == ECONNREFUSED);
  CHECK(live.read(20ms) != LiveScanner::Event::line);
  CHECK_FALSE(port::ByteStream::tcp("no host has this name", 1, error));
  CHECK_FALSE(error.empty());
  lms200::Session serial_session(181);
  LiveScanner serial(serial_session, port::ByteStream::serial("/no/such/device"), {});
  CHECK(serial.open() == ENOENT);
}

/// A server that sends the same telegram again and again and closes after every fifth. It does not use the heap.
class FiveAndOut {
 public:
  explicit FiveAndOut(Bytes telegram) : telegram_(std::move(telegram)), thread_([this] { run(); }) {}
  ~FiveAndOut() {
    stop_ = true;
    ::shutdown(listener_.fd(), SHUT_RDWR);
    thread_.join();
  }

  std::uint16_t port() const { return listener_.port(); }

 private:
  void run() {
    while (!stop_) {
      const int reader = ::accept(listener_.fd(), nullptr, nullptr);
      if (reader < 0) return;
      std::array<std::uint8_t, 64> command{};
      if (::recv(reader, command.data(), command.size(), 0) > 0) {
        for (int i = 0; i < 5; ++i) ::send(reader, telegram_.data(), telegram_.size(), MSG_NOSIGNAL);
      }
      ::close(reader);
    }
  }

  Bytes telegram_;
  Listener listener_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST_CASE("live: connecting, reading and connecting again ask the heap for nothing") {
  Scanner s = std::move(whole_scanners()[1]);
  start(s);
  const FiveAndOut server(telegrams_of(s, 1)[0]);
  std::string error;
  auto stream = port::ByteStream::tcp("127.0.0.1", server.port(), error);
  REQUIRE(stream);
  cola::Session session;
  LiveScanner live(session, std::move(*stream), {.retry_after = 1ms});
  const long before = heap_count();
  int lines = 0;
  for (int i = 0; i < 2000 && lines < 50; ++i) lines += live.read(100ms) == LiveScanner::Event::line;
  const long after = heap_count();
  CHECK(lines == 50);
  CHECK(live.connections() >= 10);
  CHECK(after == before);
}

TEST_CASE("live: a scanner that falls silent is connected anew") {
  const Listener listener;
  std::string error;
  cola::Session session;
  LiveScanner live(session, *port::ByteStream::tcp("127.0.0.1", listener.port(), error),
                   {.retry_after = 10ms, .silence = 200ms});
  int lost = 0;
  for (int i = 0; i < 40 && live.connections() < 3; ++i) lost += live.read(50ms) == LiveScanner::Event::lost;
  CHECK(lost == 1);
  CHECK(live.connections() == 3);
  CHECK(live.last_error() == ETIMEDOUT);
}

}  // namespace
}  // namespace curbline::test
