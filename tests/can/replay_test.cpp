// `curbline replay --can can:vcan0` beside canplayer, as a user runs it.
#include <fstream>
#include <thread>

#include "program.hpp"
#include "vcan/link.hpp"

namespace curbline::tools::testing {
namespace {

/// Does a program listen on the interface, according to the kernel's lists of receivers?
bool heard(const std::string& interface_name) {
  for (const char* list : {"rcvlist_sff", "rcvlist_eff", "rcvlist_fil"}) {
    std::ifstream text(std::string("/proc/net/can/") + list);
    for (std::string line; std::getline(text, line);) {
      if (line.find(" " + interface_name + " ") != std::string::npos) return true;
    }
  }
  return false;
}

/// Replays on vcan0 while canplayer plays a log there.
Outcome beside_canplayer(const Words& replay, const std::string& log) {
  Outcome outcome;
  std::thread replaying([&] { outcome = curbline(replay); });
  for (int i = 0; i < 200 && !heard("vcan0"); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  CHECK(heard("vcan0"));
  CHECK(std::system(("canplayer -I '" + log + "' vcan0=can0").c_str()) == 0);
  replaying.join();
  return outcome;
}

/// Scan lines with their CAN log beside them, as in a recording.
struct Drive {
  std::string scans, can, robot;
};

Words replay_of(const Drive& drive, const std::string& can, const std::string& curbs, const std::string& labels) {
  return {"replay",    "--scans", drive.scans, "--can",    can,    "--robot",
          drive.robot, "--curbs", curbs,       "--labels", labels, "--json"};
}

/// Compares curbs, labels and counters of the log `read` with those of the bus while the log `played` is played on it.
Outcome check_same(const Drive& drive, const std::string& played, const std::string& read) {
  const TemporaryDirectory out;
  const Outcome direct = curbline(replay_of(drive, read, out.path("log.csv"), out.path("log-labels.csv")));
  REQUIRE(direct.status == 0);
  const Outcome live = beside_canplayer(
      replay_of(drive, "can:vcan0", out.path("live.csv"), out.path("live-labels.csv")) + Words{"--speed", "1"}, played);
  INFO("standard error: " << live.err);
  REQUIRE(live.status == 0);
  CHECK(read_file(out.path("live.csv")) == read_file(out.path("log.csv")));
  CHECK(read_file(out.path("live-labels.csv")) == read_file(out.path("log-labels.csv")));
  CHECK(lines_of(read_file(out.path("live-labels.csv"))).size() > 100);
  CHECK(live.out == direct.out);
  return live;
}

Drive drive_of(const Recording& recording) {
  return {recording.path("scans.carmen"), recording.path("can.log"), recording.path("robot.toml")};
}

/// The lines of a log for which `keep(number)` is true.
template <typename Keep>
std::string some_lines(const std::string& log, Keep&& keep) {
  std::string text;
  std::size_t number = 0;
  for (const std::string& line : lines_of(read_file(log))) {
    if (keep(number++)) text += line + "\n";
  }
  return text;
}

TEST_CASE("replay: a simulated street through vcan gives the curbs of its log, byte for byte", "[replay]") {
  const Recording recording("straight_curb", "utm30lx", {"--duration", "3"});
  const Drive drive = drive_of(recording);
  const Outcome live = check_same(drive, drive.can, drive.can);
  CHECK(live.err.empty());
  CHECK(live.seconds > 3.0);
}

TEST_CASE("replay: angles that a servo samples on SYNC give the curbs of their log, byte for byte", "[replay]") {
  const TemporaryDirectory directory;
  std::string robot = read_file(shipped_robot("utm30lx"));
  robot.replace(robot.find("node = 1\n"), 9, "node = 1\nsync_id = 0x80\n");
  const Recording recording("straight_curb", directory.write("sampled.toml", robot), {"--duration", "2"});
  const Drive drive = drive_of(recording);
  CHECK(check_same(drive, drive.can, drive.can).err.empty());
}

TEST_CASE("replay: a recorded street through vcan gives the curbs of its log, byte for byte", "[replay]") {
  const std::string data = CURBLINE_SOURCE_DIR "/../shared/data/clausius/scan-03";
  if (!std::filesystem::exists(data + ".carmen")) {
    WARN("SKIPPED: no recorded data at " << data);
    return;
  }
  const Drive drive{data + ".carmen", data + ".candump", shipped_robot("clausius")};
  CHECK(check_same(drive, drive.can, drive.can).err.empty());
}

TEST_CASE("replay: frames that do not come over the bus are missing in the curbs too, and the user is told",
          "[replay]") {
  const Recording recording("straight_curb", "utm30lx", {"--duration", "2"});
  const Drive drive = drive_of(recording);
  const std::string holey = recording.directory().write(
      "holey.log", some_lines(drive.can, [](std::size_t n) { return n < 50 || n > 150 || n % 7 != 0; }));
  const auto lost = lines_of(read_file(drive.can)).size() - lines_of(read_file(holey)).size();
  REQUIRE(lost > 10);
  const Outcome live = check_same(drive, holey, holey);
  CHECK(live.err == "can:vcan0: " + std::to_string(lost) + " tilt frames of " + drive.can + " did not come\n");
}

TEST_CASE("replay: frames of other devices on the bus change nothing", "[replay]") {
  const Recording recording("straight_curb", "utm30lx", {"--duration", "2"});
  const Drive drive = drive_of(recording);
  std::string busy;
  for (const std::string& line : lines_of(read_file(drive.can))) {
    const std::string time = line.substr(0, line.find(' '));
    busy += line + "\n" + time + " can0 080#\n" + time + " can0 00000181#0011223344556677\n" + time + " can0 181#R\n";
  }
  CHECK(check_same(drive, recording.directory().write("busy.log", busy), drive.can).err.empty());
}

TEST_CASE("replay: frames with bits flipped are read as they came, at the time of their arrival, and the user is told",
          "[replay]") {
  const Recording recording("straight_curb", "utm30lx", {"--duration", "2"});
  const Drive drive = drive_of(recording);
  std::string flipped;
  int number = 0, flips = 0;
  for (std::string line : lines_of(read_file(drive.can))) {
    char& digit = line[line.find('#') + 5];  // in the angle's lowest byte
    if (number++ % 20 == 10 && number < 150) ++flips, digit = digit == '0' ? '1' : '0';
    flipped += line + "\n";
  }
  const TemporaryDirectory out;
  const Words words = replay_of(drive, "can:vcan0", out.path("curbs.csv"), out.path("labels.csv"));
  const Outcome live = beside_canplayer(words, out.write("flipped.log", flipped));
  CHECK(live.status == 0);
  const std::string told = std::to_string(flips);
  CHECK(live.err == "can:vcan0: " + told + " tilt frames of " + drive.can + " did not come, " + told +
                        " came that it does not have\n");
}

TEST_CASE("replay: without the recording's CAN log a frame's time is that of its arrival, and the user is told",
          "[replay]") {
  const Recording recording("straight_curb", "utm30lx", {"--duration", "4"});
  const TemporaryDirectory alone;
  const std::string start = "1700000000";  // time of the scan lines; the bus begins with them
  std::string log;
  for (const std::string& line : lines_of(read_file(recording.path("can.log")))) {
    if (line.substr(1, start.size()) >= start) log += line + "\n";
  }
  REQUIRE(lines_of(read_file(recording.path("scans.carmen"))).front().find(start + ".") != std::string::npos);
  const Drive drive{
      alone.write("lines.carmen", read_file(recording.path("scans.carmen"))), {}, recording.path("robot.toml")};
  const TemporaryDirectory out;
  const Outcome live = beside_canplayer(replay_of(drive, "can:vcan0", out.path("curbs.csv"), out.path("labels.csv")),
                                        out.write("played.log", log));
  INFO("standard error: " << live.err);
  REQUIRE(live.status == 0);
  CHECK(live.err == drive.scans +
                        ": no lines.candump or can.log beside it; expected one, to know when tilt frames were "
                        "recorded: the first is taken for one of the first scan line's time, and curbs are wrong if it "
                        "is not\n");
  // How accurate the curbs are depends on how evenly a busy machine lets canplayer send.
  CHECK(nlohmann::json::parse(live.out).at("lines") > 140);
  CHECK(lines_of(read_file(out.path("labels.csv"))).size() > 500);
}

TEST_CASE("replay: a bus that falls silent ends it with one line", "[replay]") {
  const Recording recording("straight_curb", "utm30lx", {"--duration", "2"});
  const Drive drive = drive_of(recording);
  const TemporaryDirectory out;
  const std::string half = out.write("half.log", some_lines(drive.can, [](std::size_t n) { return n < 100; }));
  const Words words{"replay", "--scans", drive.scans, "--can", "can:vcan0", "--robot", drive.robot};
  check_refused(beside_canplayer(words, half), "can:vcan0: ", "no tilt frame for 2 s; expected id 0x181");

  const std::string other = out.write("other.log", "(1290682980.000000) can0 123#00\n");
  check_refused(beside_canplayer(words, other), "can:vcan0: ", "no tilt frame for 10 s; expected id 0x181");
}

TEST_CASE("replay: an interface that is not there ends it with one line, another speed than 1 is wrong usage",
          "[replay]") {
  const Recording recording("straight_curb", "utm30lx", {"--duration", "1"});
  const Drive drive = drive_of(recording);
  const Words words{"replay", "--scans", drive.scans, "--robot", drive.robot, "--can"};
  check_refused(curbline(words + Words{"can:vcan7"}), "can:vcan7: ", "no such interface");
  check_refused(curbline(words + Words{"can:lo"}), "can:lo: ", "not a CAN interface");
  check_wrong_usage(curbline(words + Words{"can:vcan0", "--speed", "2"}), "a live CAN interface has the speed 1");
  check_wrong_usage(curbline(words + Words{"can:vcan0", "--speed", "max"}), "a live CAN interface has the speed 1");
}

}  // namespace
}  // namespace curbline::tools::testing
