// A live scanner that stops in the middle of its lines, though its connection stays.
#include "scanner_thread.hpp"

#include <catch2/catch.hpp>
#include <cerrno>
#include <chrono>
#include <thread>

#include "formats/decimals.hpp"
#include "scanner_simulator/server.hpp"
#include "tools/formats_support.hpp"

namespace curbline::daemon {
namespace {

using namespace std::chrono_literals;
using tools::testing::TemporaryDirectory;

/// A log of `lines` lines of a UTM-30LX, 40 a second.
std::string scan_log(const TemporaryDirectory& directory, int lines) {
  std::string ranges = "RAWLASER1 0 -2.3561945 4.712389 0.004363323 60.000 0.030 0 1081", log;
  for (int i = 0; i < 1081; ++i) ranges += " 1.500";
  for (std::int64_t i = 0; i < lines; ++i) {
    const std::string time = tools::seconds(1'700'000'000'000'000'000 + i * 25'000'000, 6);
    log += ranges + " 0 " + time + " host " + time + "\n";
  }
  return directory.write("scans.carmen", log);
}

TEST_CASE("scanner thread: a scanner without lines for half a second is lost, though connected, until the next line") {
  const TemporaryDirectory directory;
  const std::string log = scan_log(directory, 120);
  tools::ServerOptions options;
  options.damage = [](tools::Bytes& telegram, long line) {
    if (line >= 20 && line < 80) telegram.clear();  // for 1.5 s
  };
  tools::ScannerServer server(tools::Protocol::scip2, tools::ScanFeed::from_log(log), log, options);
  std::atomic<bool> stop{false};
  std::thread serving([&] { server.run(stop); });

  const tools::Robot robot;
  const auto inbox = std::make_unique<LineInbox>();
  inbox->init(robot, 1.0f);
  ScannerThread scanner(server.address(), tools::scanner_link(server.address(), robot.laser), robot.laser, *inbox,
                        0.5f);
  scanner.start();
  std::vector<ScannerState> changes{scanner.state()};
  std::vector<std::chrono::steady_clock::time_point> at{std::chrono::steady_clock::now()};
  for (int i = 0; i < 1000 && changes.size() < 5; ++i) {
    std::this_thread::sleep_for(10ms);
    const ScannerState now = scanner.state();
    if (now.connected == changes.back().connected) continue;
    changes.push_back(now);
    at.push_back(std::chrono::steady_clock::now());
  }
  stop = true;
  serving.join();
  REQUIRE(changes.size() == 5);  // not yet, lines, silent, lines, the end of the feed
  CHECK(changes[2].error == ETIMEDOUT);
  CHECK(changes[3].connections == 1);
  CHECK(changes[4].error == 0);
  CHECK(at[2] - at[1] > 0.9s);  // 20 lines and half a second
  CHECK(at[2] - at[1] < 1.9s);
}

TEST_CASE("scanner thread: damaged telegrams of every kind are counted, and cost their lines alone") {
  const TemporaryDirectory directory;
  const std::string log = scan_log(directory, 40);
  tools::ServerOptions options;
  options.damage = [](tools::Bytes& telegram, long line) {
    const auto first_block = telegram.begin() + 16 + 4 + 6;  // behind echo, status and stamp
    if (line == 10) *(first_block + 5) ^= 1;
    if (line == 20) telegram.erase(first_block, first_block + 66);  // whole, with its checksum
  };
  tools::ScannerServer server(tools::Protocol::scip2, tools::ScanFeed::from_log(log), log, options);
  std::atomic<bool> stop{false};
  std::thread serving([&] { server.run(stop); });
  const tools::Robot robot;
  const auto inbox = std::make_unique<LineInbox>();
  inbox->init(robot, 1.0f);
  ScannerThread scanner(server.address(), tools::scanner_link(server.address(), robot.laser), robot.laser, *inbox,
                        0.5f);
  scanner.start();
  for (int i = 0; i < 500 && inbox->counters().pushed < 38; ++i) std::this_thread::sleep_for(10ms);
  stop = true;
  serving.join();
  CHECK(inbox->counters().pushed == 38);
  CHECK(scanner.state().damaged == 2);
}

TEST_CASE("scanner thread: a scanner with other beams than the robot's laser gives no scan lines") {
  const TemporaryDirectory directory;
  const std::string log = scan_log(directory, 40);
  tools::ScannerServer server(tools::Protocol::scip2, tools::ScanFeed::from_log(log), log, {});
  std::atomic<bool> stop{false};
  std::thread serving([&] { server.run(stop); });
  tools::Robot robot;
  robot.laser.beams = 541;
  const auto inbox = std::make_unique<LineInbox>();
  inbox->init(robot, 1.0f);
  ScannerThread scanner(server.address(), tools::scanner_link(server.address(), robot.laser), robot.laser, *inbox,
                        0.5f);
  scanner.start();
  bool connected = false;
  for (int i = 0; i < 500 && scanner.state().other_beams < 20; ++i) {
    std::this_thread::sleep_for(10ms);
    connected = connected || scanner.state().connected;
  }
  stop = true;
  serving.join();
  CHECK(scanner.state().other_beams >= 20);
  CHECK_FALSE(connected);
  CHECK(inbox->empty());
}

}  // namespace
}  // namespace curbline::daemon
