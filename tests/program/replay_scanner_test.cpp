// replay from simulated scanners on this machine, compared with replay of the log that they play.
#include <pty.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "formats/csv.hpp"
#include "program.hpp"
#include "robot/robot.hpp"
#include "scanner_simulator/server.hpp"

namespace curbline::tools::testing {
namespace {

/// A simulated scanner that plays a log in a thread.
class Playing {
 public:
  Playing(Protocol protocol, const std::string& scans, ServerOptions options = {.speed = 0})
      : server_(protocol, ScanFeed::from_log(scans), scans, std::move(options)),
        thread_([this] { server_.run(stop_); }) {}
  ~Playing() {
    stop_ = true;
    thread_.join();
  }
  std::string address() const { return server_.address(); }

 private:
  std::atomic<bool> stop_ = false;
  ScannerServer server_;
  std::thread thread_;
};

Words results(const Recording& logs, const std::string& name) {
  return {"--labels", logs.path(name + ".labels.csv"), "--curbs", logs.path(name + ".curbs.csv"), "--json"};
}

/// What replay writes to stderr after a scanner has played its log.
std::string played(const Playing& scanner, const nlohmann::json& summary) {
  return scanner.address() + ": closed the connection after " + summary.at("lines").dump() +
         " scan lines; taken as its end\n";
}

nlohmann::json replay(const Words& arguments, const Playing* scanner = nullptr) {
  const Outcome outcome = curbline(arguments);
  INFO("standard error: " << outcome.err);
  REQUIRE(outcome.status == 0);
  const nlohmann::json summary = nlohmann::json::parse(outcome.out);
  CHECK(outcome.err == (scanner == nullptr ? "" : played(*scanner, summary)));
  return summary;
}

void check_same(const Recording& logs, Protocol protocol) {
  const nlohmann::json from_log = replay(logs.replay() + results(logs, "log"));
  const Playing scanner(protocol, logs.path("scans.carmen"));
  const nlohmann::json live = replay(logs.replay("scans", scanner.address()) + results(logs, "live"), &scanner);
  CHECK(live == from_log);
  CHECK(live.at("lines") > 40);
  CHECK(read_file(logs.path("live.labels.csv")) == read_file(logs.path("log.labels.csv")));
  CHECK(read_file(logs.path("live.curbs.csv")) == read_file(logs.path("log.curbs.csv")));
}

TEST_CASE("program: a scanner refuses a log whose lines have other beams than the first, with the line") {
  const Recording logs("street", "utm30lx", {"--duration", "0.1"});
  const std::string scans = read_file(logs.path("scans.carmen")), line = lines_of(scans)[1];
  const auto refused = [&](const std::string& other) {
    const std::string path = logs.directory().write("other.carmen", with_line(scans, 2, other));
    CHECK(error_of([&] { ScanFeed::from_log(path).next(); }) ==
          "other.carmen:2: not the beams of the first scan line; expected the same number, start_angle and "
          "angular_resolution");
  };
  const std::string stamp = line.substr(line.find(" 0 1700"));
  refused(line.substr(0, line.find(" 1081 ")) + " 1 5.000" + stamp);
  refused("RAWLASER1 0 -1.5" + line.substr(line.find(' ', 12)));
}

TEST_CASE("program: a scanner refuses a log whose times go back, with the line") {
  const Recording logs("street", "utm30lx", {"--duration", "0.2"});
  const std::string scans = read_file(logs.path("scans.carmen"));
  const Words lines = lines_of(scans);
  const std::string path = logs.directory().write("back.carmen", with_line(with_line(scans, 4, lines[4]), 5, lines[3]));
  CHECK(error_of([&] {
          ScanFeed feed = ScanFeed::from_log(path);
          while (feed.next()) {
          }
        }) == "back.carmen:5: ipc_timestamp goes back; expected no less than that of the scan line before");
}

TEST_CASE("program: lines over SCIP 2.0, beside their CAN log, give the log's curbs byte for byte") {
  const Recording logs("street", "utm30lx");
  check_same(logs, Protocol::scip2);
  CHECK(read_curbs(logs.path("live.curbs.csv")).size() >= 2);
}

TEST_CASE("program: lines over CoLa B, beside their CAN log, give the log's curbs byte for byte") {
  const Recording logs("street", "lms151");
  check_same(logs, Protocol::cola);
  CHECK(read_curbs(logs.path("live.curbs.csv")).size() >= 2);
}

TEST_CASE("program: a scanner in a scene gives the lines that simulate writes") {
  const Recording logs("street", "utm30lx", {"--duration", "1"});
  ScanFeed log = ScanFeed::from_log(logs.path("scans.carmen"));
  ScanFeed scene = ScanFeed::from_scene(find_scene("street"), read_robot(shipped_robot("utm30lx")));
  for (int i = 0; i < 40; ++i) {
    const auto from_log = log.next(), from_scene = scene.next();
    REQUIRE(from_log);
    REQUIRE(from_scene);
    CHECK(from_log->time_ns == from_scene->time_ns);
    REQUIRE(from_log->ranges_m.size() == from_scene->ranges_m.size());
    for (std::size_t beam = 0; beam < from_log->ranges_m.size(); ++beam) {
      if (std::isnan(from_log->ranges_m[beam])) continue;  // out of range once rounded to the millimetre
      REQUIRE(std::abs(from_log->ranges_m[beam] - from_scene->ranges_m[beam]) < 6e-4f);
    }
  }
  CHECK(log.front() == nullptr);
}

TEST_CASE("program: curbline-scanner says what is wrong with its arguments and input") {
  const Recording logs("straight_curb", "utm30lx", {"--duration", "1"});
  const auto status_of = [](const std::string& arguments) {
    return WEXITSTATUS(std::system(("'" CURBLINE_SCANNER "' " + arguments + " >/dev/null 2>&1").c_str()));
  };
  const std::string scans = logs.path("scans.carmen");
  CHECK(status_of("") == 2);
  CHECK(status_of("cola") == 2);
  CHECK(status_of("udp --scans " + scans) == 2);
  CHECK(status_of("scip2 --speed 0 --scans " + scans) == 2);
  for (const std::string bad : {"inf", "5x"})
    check_wrong_usage(run(CURBLINE_SCANNER, {"scip2", "--scans", scans, "--speed", bad}),
                      "--speed: " + bad + "; expected max or a number from 0.001 to 1000\n");
  for (const std::string bad : {"99999", "-1", "x"})
    check_wrong_usage(run(CURBLINE_SCANNER, {"scip2", "--scans", scans, "--port", bad}),
                      "--port: " + bad + "; expected a whole number from 0 to 65535\n");
  check_wrong_usage(run(CURBLINE_SCANNER, {"lms200", "--scans", scans, "--port", "2112"}),
                    "--port: expected it with scip2 or cola; an LMS-200 has a serial line\n");
  CHECK(status_of("scip2 --scene street") == 2);
  CHECK(status_of("scip2 --scans /no/such/log") == 1);
  CHECK(status_of("lms200 --scans " + scans) == 1);  // 1081 beams
}

TEST_CASE("program: live lines join a CAN log, or poses, that come through a pipe") {
  const auto check_piped = [](const Recording& logs, const std::string& log, const std::string& file) {
    const nlohmann::json from_log = replay(logs.replay() + Words{"--json"});
    const Playing scanner(Protocol::scip2, logs.path("scans.carmen"));
    Words words = logs.replay("scans", scanner.address()) + Words{"--json"};
    std::replace(words.begin(), words.end(), logs.path(file), std::string("/dev/stdin"));
    const std::string out = logs.path("out"), piped = "cat " + logs.path(file) + " | timeout 20 " + line_of(words);
    INFO(log);
    CHECK(std::system((piped + " > " + out + " 2> /dev/null").c_str()) == 0);
    CHECK(nlohmann::json::parse(read_file(out)) == from_log);
  };
  check_piped(Recording("street", "utm30lx", {"--duration", "0.5"}), "CAN log", "can.log");
  check_piped(Recording("city", "fixed_tilt", {"--duration", "0.5"}), "poses", "poses.tum");
}

TEST_CASE("program: live lines join poses too") {
  const Recording logs("city", "fixed_tilt", {"--duration", "4"});
  check_same(logs, Protocol::scip2);
}

/// A stationary robot with a fixed tilt: its map needs no times.
TEST_CASE("program: lines of an LMS200 on a pty give the log's map") {
  const TemporaryDirectory directory;
  const std::string robot = directory.write(
      "lms200.toml",
      "[laser]\nmodel = \"lms-200\"\n[tilt]\nfixed = true\nfixed_tilt_rad = 0.6\n[tilt.mount]\nz_m = 1.0\n");
  REQUIRE(
      curbline({"simulate", "--scene", "street", "--robot", robot, "--out", directory.path("run"), "--duration", "2"})
          .status == 0);
  const std::string scans = directory.path("run/scans.carmen"), log_labels = directory.path("log.csv"),
                    live_labels = directory.path("live.csv");
  const auto from_log = replay({"replay", "--scans", scans, "--robot", robot, "--labels", log_labels, "--json"});
  const Playing scanner(Protocol::lms200, scans);
  CHECK(replay({"replay", "--scans", scanner.address(), "--robot", robot, "--labels", live_labels, "--json"},
               &scanner) == from_log);
  CHECK(read_file(live_labels) == read_file(log_labels));
}

TEST_CASE("program: poses in the folder from which a live scanner is read are no poses of its scan lines") {
  const Recording logs("street", "utm30lx", {"--duration", "1"});
  logs.directory().write("poses.tum", "1700000000.0 0 0 0 0 0 0 1\n");
  const Playing scanner(Protocol::scip2, logs.path("scans.carmen"));
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(logs.folder());
  const Outcome outcome =
      curbline({"replay", "--scans", scanner.address(), "--can", "can.log", "--robot", "robot.toml", "--json"});
  std::filesystem::current_path(before);
  CHECK(outcome.status == 0);
  CHECK(outcome.err == played(scanner, nlohmann::json::parse(outcome.out)));
}

TEST_CASE("program: Ctrl-C ends a live scan as the end of a log does") {
  const Recording logs("street", "utm30lx");
  const std::string pid = logs.path("pid"), out = logs.path("summary.json");
  const auto press_ctrl_c = [&](auto&, long sent) {
    if (sent == 80) ::kill(std::stoi(read_file(pid)), SIGINT);
  };
  const Playing scanner(Protocol::scip2, logs.path("scans.carmen"), {.speed = 1, .damage = press_ctrl_c});
  const std::string replay = line_of(logs.replay("scans", scanner.address()) + Words{"--json"});
  CHECK(std::system(("echo $$ > '" + pid + "'; exec " + replay + " > '" + out + "'").c_str()) == 0);
  const auto summary = nlohmann::json::parse(read_file(out));
  CHECK(summary.at("lines") > 20);
  CHECK(summary.at("lines") <= 81);
}

TEST_CASE("program: a scanner that is not there, or has other beams than the robot, is refused") {
  const Recording logs("straight_curb", "utm30lx", {"--duration", "1"});
  check_refused(curbline(logs.replay("scans", "scip2:127.0.0.1:1")), "scip2:127.0.0.1:1: ", "expected a scanner there");
  check_refused(curbline(logs.replay("scans", "cola:127.0.0.1:66000")),
                "cola:127.0.0.1:66000: ", "expected a number from 1 to 65535");
  check_refused(curbline(logs.replay("scans", "cola:")), "cola:: ", "expected cola:HOST");
  check_refused(curbline(logs.replay("scans", "scip2:no.such.host.invalid")),
                "scip2:no.such.host.invalid: ", "expected the name or address");
  check_refused(curbline(logs.replay("scans", "lms200:")), "lms200:: ", "no device; expected lms200:DEVICE");
  check_refused(curbline(logs.replay("scans", "lms200:/dev/null")), "lms200:/dev/null: ", "have no time stamps");
  const Playing scanner(Protocol::cola, logs.path("scans.carmen"));
  const Outcome outcome = curbline(
      {"replay", "--scans", scanner.address(), "--can", logs.path("can.log"), "--robot", shipped_robot("lms151")});
  check_refused(outcome, scanner.address() + ":1: ", "1081 ranges; expected 541");
}

TEST_CASE("program: replay refuses a serial line that another program has locked") {
  const TemporaryDirectory dir;
  const std::string robot =
      dir.write("r.toml", "[laser]\nmodel = \"lms-200\"\n[tilt]\nfixed = true\nfixed_tilt_rad = 0.3\n");
  int ours = -1, theirs = -1;
  std::array<char, 64> name{};
  REQUIRE(::openpty(&ours, &theirs, name.data(), nullptr, nullptr) == 0);
  REQUIRE(::flock(theirs, LOCK_EX) == 0);
  const std::string address = std::string("lms200:") + name.data();
  check_refused(curbline({"replay", "--scans", address, "--robot", robot}), address + ": ",
                "expected a line that no other program uses");
  ::close(theirs);
  ::close(ours);
}

TEST_CASE("program: a scanner that speaks another protocol is given up after some seconds, in one line") {
  const Recording logs("straight_curb", "utm30lx", {"--duration", "1"});
  const Playing scanner(Protocol::scip2, logs.path("scans.carmen"));
  const std::string cola = "cola:" + scanner.address().substr(6);
  const Outcome outcome = curbline(logs.replay("scans", cola));
  check_refused(outcome, cola + ": ", "no scan line for 5 s");
  CHECK(outcome.seconds < 8);
}

}  // namespace
}  // namespace curbline::tools::testing
