// A live scanner that stops in the middle of its lines, though its connection stays, and one that closes each
// connection.
#include "scanner_thread.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cerrno>
#include <chrono>
#include <thread>

#include "error_pipe.hpp"
#include "scan_log.hpp"
#include "scanner_simulator/server.hpp"
#include "troubles.hpp"

namespace curbline::daemon {
namespace {

using namespace std::chrono_literals;
using tools::testing::TemporaryDirectory;

/// A scanner that plays so many lines, 40 a second, and the thread that reads it.
class LiveScan {
 public:
  using Damage = decltype(tools::ServerOptions::damage);

  explicit LiveScan(int lines, Damage damage = {}, const LaserSettings& laser = tools::Robot{}.laser,
                    tools::Protocol protocol = tools::Protocol::scip2)
      : log_(write_scan_log(directory_, lines)),
        server_(protocol, tools::ScanFeed::from_log(log_), log_, {.damage = std::move(damage)}),
        serving_([this] { server_.run(stop_); }),
        thread(server_.address(), tools::scanner_link(server_.address(), laser), laser, *inbox, 0.5f) {
    inbox->init(tools::Robot{}, 1.0f);
    thread.start();
  }
  ~LiveScan() { end(); }
  LiveScan(const LiveScan&) = delete;
  LiveScan& operator=(const LiveScan&) = delete;

  void end() {
    stop_ = true;
    if (serving_.joinable()) serving_.join();
  }

 private:
  const TemporaryDirectory directory_;
  const std::string log_;
  tools::ScannerServer server_;
  std::atomic<bool> stop_{false};
  std::thread serving_;

 public:
  const std::unique_ptr<LineInbox> inbox = std::make_unique<LineInbox>();
  ScannerThread thread;
};

TEST_CASE("scanner thread: a scanner without lines for half a second is lost, though connected, until the next line") {
  LiveScan scan(120, [](tools::Bytes& telegram, long line) {
    if (line >= 20 && line < 80) telegram.clear();  // for 1.5 s
  });
  std::vector<ScannerState> changes{scan.thread.state()};
  std::vector<std::chrono::steady_clock::time_point> at{std::chrono::steady_clock::now()};
  for (int i = 0; i < 1000 && changes.size() < 5; ++i) {
    std::this_thread::sleep_for(10ms);
    const ScannerState now = scan.thread.state();
    if (now.connected == changes.back().connected) continue;
    changes.push_back(now);
    at.push_back(std::chrono::steady_clock::now());
  }
  REQUIRE(changes.size() == 5);  // not yet, lines, silent, lines, the end of the feed
  CHECK(changes[2].error == ETIMEDOUT);
  CHECK(changes[3].connections == 1);
  CHECK(changes[4].error == 0);
  CHECK(at[2] - at[1] > 0.9s);  // 20 lines and half a second
  CHECK(at[2] - at[1] < 1.9s);
}

/// Something that is no scanner, or one that serves another client: closes each connection at once.
class Closing {
 public:
  Closing() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{.sin_family = AF_INET, .sin_port = 0, .sin_addr = {htonl(INADDR_LOOPBACK)}, .sin_zero = {}};
    socklen_t size = sizeof address;
    REQUIRE(::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) == 0);
    REQUIRE(::listen(listener_, 4) == 0);
    REQUIRE(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0);
    name = "scip2:127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    closing_ = std::thread([this] {
      for (int client = 0; (client = ::accept(listener_, nullptr, nullptr)) >= 0;) ::close(client);
    });
  }
  ~Closing() {
    ::shutdown(listener_, SHUT_RDWR);
    closing_.join();
    ::close(listener_);
  }
  Closing(const Closing&) = delete;
  Closing& operator=(const Closing&) = delete;

  std::string name;

 private:
  int listener_;
  std::thread closing_;
};

TEST_CASE("scanner thread: a scanner that closes each connection from the first on is told, once") {
  const Closing closing;
  const LaserSettings laser = tools::Robot{}.laser;
  const auto inbox = std::make_unique<LineInbox>();
  inbox->init(tools::Robot{}, 1.0f);
  ScannerThread thread(closing.name, tools::scanner_link(closing.name, laser), laser, *inbox, 0.5f);
  Report report;
  ScannerState state = thread.state();
  report.scanner = &state;
  Troubles troubles;
  ErrorPipe standard_error;
  troubles.tell(report, {}, 0);
  CHECK(standard_error.read().empty());  // it has not been tried yet
  thread.start();
  for (int i = 0; i < 300 && state.connections < 3; ++i) {
    std::this_thread::sleep_for(10ms);
    state = thread.state();
    troubles.tell(report, {}, 0);
  }
  CHECK(state.connections >= 3);
  CHECK(standard_error.read() ==
        "curblined: no scan lines from the scanner " + closing.name + ": it closed the connection\n");
}

TEST_CASE("scanner thread: damaged telegrams of every kind are counted, and cost their lines alone") {
  LiveScan scan(40, [](tools::Bytes& telegram, long line) {
    const auto first_block = telegram.begin() + 16 + 4 + 6;  // behind echo, status and stamp
    if (line == 10) *(first_block + 5) ^= 1;
    if (line == 20) telegram.erase(first_block, first_block + 66);  // whole, with its checksum
  });
  for (int i = 0; i < 500 && scan.inbox->counters().pushed < 38; ++i) std::this_thread::sleep_for(10ms);
  scan.end();
  CHECK(scan.inbox->counters().pushed == 38);
  CHECK(scan.thread.state().damaged == 2);
}

TEST_CASE("scanner thread: a scanner that reports a front screen too dirty to measure is told, though its lines come") {
  constexpr std::size_t status_at = 8 + 16 + 8 + 1;  // behind frame, name of the telegram, version and serial number
  constexpr std::uint8_t too_dirty = 4;
  LiveScan scan(
      40,
      [](tools::Bytes& telegram, long line) {
        if (line < 10) return;
        telegram[status_at] ^= too_dirty;
        telegram.back() ^= too_dirty;  // the checksum
      },
      tools::Robot{}.laser, tools::Protocol::cola);
  for (int i = 0; i < 500 && scan.inbox->counters().pushed < 40; ++i) std::this_thread::sleep_for(10ms);
  scan.end();
  CHECK(scan.inbox->counters().pushed == 40);
  CHECK(scan.thread.state().damaged == 0);
  CHECK(scan.thread.state().device_errors == 30);
}

TEST_CASE(
    "scanner thread: a scanner with other beams than the robot's laser, or as many elsewhere, gives no scan lines") {
  LaserSettings fewer, turned, closer;
  fewer.beams = 541;
  turned.first_bearing_rad += turned.bearing_step_rad;
  closer.bearing_step_rad *= 0.999f;
  for (const LaserSettings& other : {fewer, turned, closer}) {
    INFO(other.beams << " beams from " << other.first_bearing_rad << " rad, " << other.bearing_step_rad
                     << " rad apart");
    LiveScan scan(40, {}, other);
    bool connected = false;
    for (int i = 0; i < 500 && scan.thread.state().other_beams < 20; ++i) {
      std::this_thread::sleep_for(10ms);
      connected = connected || scan.thread.state().connected;
    }
    scan.end();
    CHECK(scan.thread.state().other_beams >= 20);
    CHECK_FALSE(connected);
    CHECK(scan.inbox->empty());
  }
}

}  // namespace
}  // namespace curbline::daemon
