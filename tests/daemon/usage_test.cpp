// What curblined refuses: bad input with one line and exit status 1, wrong usage with status 2.
#include <cstdlib>

#include "formats/decimals.hpp"
#include "program.hpp"

namespace curbline::tools::testing {
namespace {

const std::string nodding = shipped_robot("utm30lx");

/// Scan lines of the robot's laser, 25 ms apart.
std::string scan_log(const TemporaryDirectory& directory, int lines = 1, std::int64_t second = 1'700'000'000) {
  std::string ranges = "RAWLASER1 0 -2.3561945 4.712389 0.004363323 60.000 0.030 0 1081", log;
  for (int i = 0; i < 1081; ++i) ranges += " 5.000";
  for (int i = 0; i < lines; ++i) {
    const std::string time = seconds(second * 1'000'000'000 + i * 25'000'000, 6);
    log += ranges + " 0 " + time + " host " + time + "\n";
  }
  return directory.write("scans.carmen", log);
}

TEST_CASE("curblined: what it cannot run with is refused with one line") {
  const TemporaryDirectory directory;
  const std::string scans = scan_log(directory), curbs = "unix:" + directory.path("curbs");
  const Words words{"--scans", scans, "--curbs", curbs, "--robot"};
  check_refused(curbline(words + Words{nodding}), nodding + ": ", "the laser nods");
  const std::string driving = shipped_robot("fixed_tilt");
  check_refused(curbline(words + Words{driving}), driving + ": ", "the robot drives; expected --poses");
  check_refused(curbline(words + Words{driving, "--poses", "none.tum"}), "none.tum: ", "cannot be opened");
  check_refused(curbline(words + Words{driving, "--poses", scans}), scans + ":1: ", "time is \"RAWLASER1\"");
  check_refused(
      curbline({"--robot", driving, "--curbs", curbs, "--scans", "scip2:127.0.0.1:7", "--poses", "poses.tum"}),
      "poses.tum: ", "no FIFO; expected one, or -, beside a live scanner");
  check_refused(curbline(words + Words{nodding, "--can", "none7"}), "none7: ", "expected a CAN interface");
  check_refused(curbline({"--robot", nodding, "--can", "none7", "--curbs", curbs, "--scans", "none.carmen"}),
                "none.carmen: ", "");
  check_refused(curbline({"--robot", nodding, "--can", "none7", "--curbs", curbs, "--scans", "scip2:"}),
                "scip2:", "no host");
  const std::string odrive = directory.write("odrive.toml", "[tilt.signal]\nservo = \"odrive\"\nnode = 53\n");
  check_refused(curbline(words + Words{odrive, "--can", "none7", "--can-out"}), odrive + ": ", "as those of --can-out");
  const std::string fixed = directory.write("fixed.toml", "[tilt]\nfixed = true\nfixed_tilt_rad = 0.5\n");
  const auto at = [&](const std::string& address) {
    return curbline({"--robot", fixed, "--scans", scans, "--curbs", address});
  };
  check_refused(at("here"), "here: ", "unix:PATH");
  for (const std::string none : {"tcp:", "tcp::7000", "tcp:localhost", "unix:"})
    check_refused(at(none), none + ": no address", "unix:PATH or tcp:HOST:PORT");
  for (const std::string port : {"65536", "72345", "-1", "abc", "80x", ""})
    check_refused(at("tcp:127.0.0.1:" + port), "tcp:127.0.0.1:" + port + ": ",
                  "port is \"" + port + "\"; expected a number from 0 to 65535");
  check_refused(curbline({"--robot", fixed, "--scans", "lms200:", "--curbs", curbs}),
                "lms200:: ", "no device; expected lms200:DEVICE");
}

TEST_CASE("curblined: a signal ends it while it waits for its logs, too") {
  const TemporaryDirectory directory;
  const std::string fixed = directory.write("fixed.toml", "[tilt]\nfixed = true\n"), fifo = directory.path("scans");
  REQUIRE(std::system(("mkfifo " + fifo).c_str()) == 0);
  const std::string waits = line_of({"--robot", fixed, "--scans", fifo, "--curbs", "unix:" + directory.path("curbs")});
  const auto ended_by = [&](const std::string& signal) {
    return WEXITSTATUS(std::system(("timeout --preserve-status -k 5 -s " + signal + " 0.3 " + waits).c_str()));
  };
  CHECK(ended_by("TERM") == 128 + 15);
  CHECK(ended_by("INT") == 128 + 2);
  CHECK(names_in(directory.path("")) == Words{"fixed.toml", "scans"});
}

TEST_CASE("curblined: wrong usage is told") {
  check_wrong_usage(curbline({"--robot", nodding}), "--scans");
  check_wrong_usage(curbline({"--robot", nodding, "--scans", "a", "--curbs", "b", "--can-out"}), "--can");
  const auto empty = [](const Words& others, const std::string& option, const std::string& expected) {
    check_wrong_usage(curbline(others + Words{option, ""}), option + ": empty; expected " + expected + "\n");
  };
  empty({"--robot", nodding, "--curbs", "b"}, "--scans", "a scanner or a log");
  empty({"--robot", nodding, "--scans", "a"}, "--curbs", "unix:PATH or tcp:HOST:PORT");
  empty({"--scans", "a", "--curbs", "b"}, "--robot", "a file name");
  empty({"--robot", nodding, "--scans", "a", "--curbs", "b"}, "--can", "a CAN interface");
}

TEST_CASE("curblined: a laser at a fixed tilt needs no CAN, and the end of its log is the end") {
  const TemporaryDirectory directory;
  const std::string fixed = directory.write("fixed.toml", "[tilt]\nfixed = true\nfixed_tilt_rad = 0.5\n");
  const Outcome outcome =
      curbline({"--robot", fixed, "--scans", scan_log(directory), "--curbs", "unix:" + directory.path("curbs")});
  INFO("standard error: " << outcome.err);
  REQUIRE(outcome.status == 0);
  const nlohmann::json status = nlohmann::json::parse(outcome.out).at("status");
  CHECK(status.at("state") == "ok");
  CHECK(status.at("pipeline").at("lines") == 1);
  CHECK(status.at("heap_calls").at("since_start") == 0);
  CHECK_FALSE(status.contains("tilt"));
}

TEST_CASE("curblined: scan lines with a damaged stamp are reported as such, not as too fast") {
  const TemporaryDirectory directory;
  const std::string fixed = directory.write("fixed.toml", "[tilt]\nfixed = true\nfixed_tilt_rad = 0.5\n");
  const Outcome outcome = curbline({"--robot", fixed, "--scans", scan_log(directory, 8, 5'000'000'000), "--curbs",
                                    "unix:" + directory.path("curbs")});
  REQUIRE(outcome.status == 0);
  INFO("standard error: " << outcome.err);
  CHECK(outcome.err.find("curblined: scan lines with a damaged stamp, dropped (") != std::string::npos);
  CHECK(outcome.err.find("faster") == std::string::npos);
  const nlohmann::json scans = nlohmann::json::parse(outcome.out).at("status").at("scans");
  CHECK(scans.at("bad_time") == 8);
  CHECK(scans.at("dropped") == 0);
}

}  // namespace
}  // namespace curbline::tools::testing
