// curbline-drive-log: converts logs to the input of boards, and the output of boards to curbs.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>

#include "drive_log/drive_log.hpp"
#include "program.hpp"

namespace curbline::tools::testing {
namespace {

Outcome drive_log(const Words& arguments, const std::string& out_file = {}) {
  return run(CURBLINE_DRIVE_LOG, arguments, out_file);
}

/// Arguments with the logs of a recording, without --out.
Words write_of(const Recording& logs) {
  Words arguments = logs.replay();
  arguments.front() = "write";
  return arguments;
}

TEST_CASE("drive log: the output never overwrites one of its input logs") {
  const Recording logs("street", "utm30lx", {"--duration", "0.1"});
  const Words names = names_in(logs.folder());
  for (const auto& [option, name] :
       {std::pair{"--scans", "scans.carmen"}, {"--can", "can.log"}, {"--robot", "robot.toml"}}) {
    const std::string input = logs.path(name), before = read_file(input);
    check_wrong_usage(drive_log(write_of(logs) + Words{"--out", input}),
                      "--out: " + input + " is also " + option + "; expected another file");
    CHECK(read_file(input) == before);
  }
  const Recording drive("city", "utm30lx", {"--duration", "0.1"});
  check_wrong_usage(drive_log(write_of(drive) + Words{"--out", drive.path("poses.tum")}), "is also --poses");
  CHECK(names_in(logs.folder()) == names);
  CHECK(drive_log(write_of(logs) + Words{"--out", logs.path("drive")}).status == 0);
}

TEST_CASE("drive log: the same logs make the same bytes") {
  const Recording logs("city", "utm30lx", {"--duration", "0.5"});
  CHECK(drive_log(write_of(logs) + Words{"--out", logs.path("once")}).status == 0);
  CHECK(drive_log(write_of(logs) + Words{"--out", logs.path("again")}).status == 0);
  CHECK(read_file(logs.path("once")) == read_file(logs.path("again")));
}

TEST_CASE("drive log: a laser that nods wants its tilt log, a robot that drives its poses") {
  const Recording logs("city", "utm30lx", {"--duration", "0.5"});
  const auto refused = [&](const std::string& robot, const std::string& expected) {
    const Outcome outcome =
        drive_log({"write", "--robot", robot, "--scans", logs.path("scans.carmen"), "--out", logs.path("drive")});
    check_refused(outcome, robot + ": ", expected);
  };
  refused(logs.path("robot.toml"), "expected --can LOG");
  const std::string fixed = logs.directory().write("r.toml", "[tilt]\nfixed = true\n[pose]\nstill = false\n");
  refused(fixed, "expected --poses FILE");
}

TEST_CASE("drive log: tilt frames of a second interface, or none at all, are refused as by replay") {
  const Recording logs("street", "utm30lx", {"--duration", "0.5"});
  const auto refused = [&](const std::string& can, const std::string& where, const std::string& expected) {
    const std::string log = logs.directory().write("changed.log", can);
    Words words = logs.replay("can", log);
    const Outcome by_replay = curbline(words);
    words.front() = "write";
    const Outcome outcome = drive_log(words + Words{"--out", logs.path("drive")});
    check_refused(outcome, log + where, expected);
    CHECK(outcome.err == by_replay.err);
    CHECK_FALSE(std::filesystem::exists(logs.path("drive")));
  };
  std::string both, other, cut;
  for (const std::string& line : lines_of(read_file(logs.path("can.log")))) {
    const std::string time = line.substr(0, line.find(' ')), data = line.substr(line.find('#')) + "\n";
    both += line + "\n" + time + " can1 181" + data;
    other += time + " can0 182" + data;
    cut += time + " can0 181#00\n";
  }
  refused(both, ":2: ", "tilt frames of can1 after those of can0; expected one interface\n");
  refused(other, ": none of ", "expected id 0x181 of 11 bits as the robot's description has it\n");
  refused(cut, ": ", "none holds an angle; expected 6 bytes or more and at most 1e+06 rad\n");
}

TEST_CASE("drive log: frames behind one with a damaged stamp reach the board in time") {
  const Recording logs("street", "utm30lx", {"--duration", "2"});
  const std::string can = read_file(logs.path("can.log")), frame = lines_of(can)[50];
  const std::string damaged = with_line(can, 51, "(1700009999" + frame.substr(frame.find('.')));
  const auto written = [&](const std::string& log) {
    Words words = logs.replay("can", logs.directory().write("changed.log", log));
    words.front() = "write";
    REQUIRE(drive_log(words + Words{"--out", logs.path("drive")}).status == 0);
    return read_file(logs.path("drive"));
  };
  const std::string sound = written(can), with_damage = written(damaged);
  std::size_t changed = 0;
  REQUIRE(sound.size() == with_damage.size());
  for (std::size_t k = 0; k < sound.size(); ++k) changed += sound[k] != with_damage[k];
  CHECK(changed > 0);
  CHECK(changed <= sizeof(std::int64_t));
}

TEST_CASE("drive log: what replay tells of the logs themselves is told when they are written, too") {
  const Recording logs("city", "utm30lx", {"--duration", "2"});
  const std::string can = read_file(logs.path("can.log")), scans = read_file(logs.path("scans.carmen"));
  const auto told = [&](Words words) {
    const Outcome by_replay = curbline(words);
    words.front() = "write";
    const Outcome outcome = drive_log(words + Words{"--out", logs.path("drive")});
    CHECK(by_replay.status == 0);
    CHECK(outcome.status == 0);
    return std::pair{by_replay.err, outcome.err};
  };
  SECTION("nothing of sound ones") {
    CHECK(told(logs.replay()).second.empty());
  }
  SECTION("frames lost by candump") {
    const auto [by_replay, err] = told(logs.replay(
        "can", logs.directory().write("lost.log", "DROPCOUNT: dropped 3 CAN frames on 'can0' socket\n" + can)));
    CHECK(err == logs.path("lost.log") + ": 3 frames lost by candump\n");
    CHECK(err == by_replay);
  }
  SECTION("poses that lie beside") {
    const auto [by_replay, err] = told({"replay", "--scans", logs.path("scans.carmen"), "--can", logs.path("can.log"),
                                        "--robot", logs.path("robot.toml")});
    CHECK(err == logs.path("poses.tum") + ": not read, the robot was taken to stand; expected --poses\n");
    CHECK(err == by_replay);
  }
  SECTION("a CAN log beside a fixed tilt") {
    const std::string robot = logs.directory().write("fixed.toml", "[tilt]\nfixed = true\n");
    const auto [by_replay, err] = told(logs.replay("robot", robot));
    CHECK(err == logs.path("can.log") + ": not read; the tilt is fixed\n");
    CHECK(err == by_replay);
  }
  SECTION("a tilt that rests, as by an encoder that is stuck") {
    const std::string robot =
        logs.directory().write("stuck.toml", "[tilt.signal]\nscale = 1e-9\n[sweep]\nperiod_s = 1.5\n");
    const auto [by_replay, err] = told(logs.replay("robot", robot));
    CHECK(err == logs.path("can.log") +
                     ": the tilt rests for more than 1.5 s, a sweep there and back; expected a servo that nods, and an "
                     "encoder that is not stuck\n");
    CHECK(by_replay.find(err) != std::string::npos);
  }
  SECTION("tilt angles in degrees") {
    const std::string robot = logs.directory().write("degrees.toml", "[tilt.signal]\nscale = 0.0054931640625\n");
    const auto [by_replay, err] = told(logs.replay("robot", robot));
    const std::string start = logs.path("can.log") + ": ", end = " see scale of tilt.signal\n";
    CHECK(err.starts_with(start));
    CHECK(err.ends_with(" tilt angles are more than a turn from where their sweep began; expected radians," + end));
    CHECK(std::count(err.begin(), err.end(), '\n') == 1);
    CHECK(by_replay.find(" tilt angles are more than a turn from where their sweep began;") != std::string::npos);
  }
  SECTION("tilt frames and scan lines that go back") {
    const Words frames = lines_of(can), lines = lines_of(scans);
    const auto swapped = [](const std::string& text, const Words& all, std::size_t k) {
      return with_line(with_line(text, k, all[k]), k + 1, all[k - 1]);
    };
    const std::string back = logs.directory().write("back.log", swapped(can, frames, 100));
    logs.directory().write("scans.carmen", swapped(scans, lines, 60));
    const auto [by_replay, err] = told(logs.replay("can", back));
    const std::string order = " are out of order; expected times that rise\n";
    CHECK(std::count(by_replay.begin(), by_replay.end(), '\n') == 2);
    CHECK(std::count(err.begin(), err.end(), '\n') == 2);
    CHECK(err.starts_with(back + ": 1 of "));
    CHECK(err.find(" tilt readings" + order + logs.path("scans.carmen") + ": 1 of 80 scan lines" + order) !=
          std::string::npos);
  }
  SECTION("a scan line of the future") {
    const Words lines = lines_of(scans);
    const std::size_t name = lines[59].rfind(" curbline "), stamp = lines[59].rfind(' ', name - 1) + 1;
    logs.directory().write("scans.carmen",
                           with_line(scans, 60, lines[59].substr(0, stamp) + "1700003600.0" + lines[59].substr(name)));
    CHECK(told(logs.replay()).second ==
          logs.path("scans.carmen") + ": 1 of 80 scan lines are out of order; expected times that rise\n");
  }
}

/// Calls `take` with each record of a stream: its kind and its bytes.
void for_each_record(const std::string& stream, const std::function<void(drive_log::RecordKind, const char*)>& take) {
  for (std::size_t at = 0; at < stream.size();) {
    drive_log::RecordHeader header;
    REQUIRE(stream.size() - at >= sizeof header);
    std::memcpy(&header, stream.data() + at, sizeof header);
    at += sizeof header;
    REQUIRE(stream.size() - at >= header.bytes);
    take(header.kind, stream.data() + at);
    at += header.bytes;
  }
}

TEST_CASE("drive log: a scan line comes after the first pose at or behind its last beam, and no later one") {
  const Recording logs("city", "utm30lx", {"--duration", "2"});
  REQUIRE(drive_log(write_of(logs) + Words{"--out", logs.path("drive")}).status == 0);
  drive_log::Setup setup;
  std::int64_t before_ns = 0, newest_ns = 0;
  int poses = 0, lines = 0;
  for_each_record(read_file(logs.path("drive")), [&](drive_log::RecordKind kind, const char* bytes) {
    if (kind == drive_log::RecordKind::setup) std::memcpy(&setup, bytes, sizeof setup);
    if (kind == drive_log::RecordKind::pose) {
      Pose pose;
      std::memcpy(&pose, bytes, sizeof pose);
      before_ns = newest_ns;
      newest_ns = pose.time_ns;
      ++poses;
    }
    if (kind != drive_log::RecordKind::scan_line) return;
    drive_log::ScanLineHead head;
    std::memcpy(&head, bytes, sizeof head);
    const auto beams = static_cast<std::size_t>(setup.settings.laser.beams);
    const std::int64_t last_beam_ns = head.time_ns + setup.settings.laser.duration_ns(beams);
    CHECK(newest_ns >= last_beam_ns);
    CHECK(before_ns < last_beam_ns);
    ++lines;
  });
  CHECK(lines == 80);
  CHECK(poses > 90);  // 50 a second
}

TEST_CASE("drive log: an empty file name is wrong usage") {
  check_wrong_usage(drive_log({"write", "--robot", "r", "--scans", "s", "--out", "o", "--can", ""}),
                    "--can: empty; expected a file name\n");
}

TEST_CASE("drive log: nothing is left of what a signal ends") {
  const Recording logs("street", "utm30lx", {"--duration", "0.5"});
  const TemporaryDirectory dir;
  // The scan lines come through a pipe that stays open after the last line.
  const std::string fifo = dir.path("scans");
  std::filesystem::create_directory(dir.path("out"));
  REQUIRE(std::system(("mkfifo " + fifo).c_str()) == 0);
  const std::string write = "'" CURBLINE_DRIVE_LOG "' write --robot " + logs.path("robot.toml") + " --can " +
                            logs.path("can.log") + " --scans " + fifo + " --out " + dir.path("out/drive");
  const std::string feed = "(cat " + logs.path("scans.carmen") + "; sleep 2) > " + fifo + " & ";
  const std::string run = "{ " + feed + write + " & program=$!; sleep 1; ls " + dir.path("out") + " > " +
                          dir.path("during") + "; kill -TERM $program; wait $program; echo $? > " + dir.path("status") +
                          "; wait; } 2> " + dir.path("err");
  REQUIRE(std::system(run.c_str()) == 0);
  CHECK(read_file(dir.path("during")).find(".part") != std::string::npos);
  CHECK(read_file(dir.path("status")) == "143\n");
  CHECK(names_in(dir.path("out")) == Words{});
}

TEST_CASE("drive log: results that cannot be read or are none are refused") {
  const TemporaryDirectory dir;
  check_refused(drive_log({"curbs", dir.path("none")}), dir.path("none") + ": ",
                "cannot be read: No such file or directory");
  check_refused(drive_log({"curbs", dir.path("")}), dir.path("") + ": ", "cannot be read: Is a directory");
  check_refused(drive_log({"curbs", dir.write("empty", "")}), dir.path("empty") + ": ", "empty");
  check_refused(drive_log({"curbs", dir.write("cut", "1234")}), dir.path("cut") + ": ", "cut");
}

/// Result of a board for a line without curbs.
std::string result_without_curbs() {
  const drive_log::Result<0> result({}, Status::ok, {}, {});
  return {reinterpret_cast<const char*>(result.bytes().data()), result.bytes().size()};
}

TEST_CASE("drive log: standard output that cannot be written is an error") {
  const TemporaryDirectory dir;
  const std::string results = dir.write("results", result_without_curbs());
  CHECK(drive_log({"curbs", results}).out == "x0_m,y0_m,x1_m,y1_m,height_m,height_sd_m,probability,kind\n");
  if (std::filesystem::exists("/dev/full"))
    check_refused(drive_log({"curbs", results}, "/dev/full"), "standard output: ", "cannot be written");
}

}  // namespace
}  // namespace curbline::tools::testing
