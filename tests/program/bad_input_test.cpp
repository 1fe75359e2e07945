// Bad input: exit status 1, one line that says where and why, and no file that was not there before.
#include <cstdlib>

#include "program.hpp"

namespace curbline::tools::testing {
namespace {

/// Runs replay with one log replaced. Everything else in the directory must stay as it was.
Outcome replay_with(const Recording& logs, const std::string& replaced, const std::string& by) {
  const std::string curbs = logs.directory().write("curbs-before.csv", "as it was\n");
  const Words before = names_in(logs.folder());
  const Outcome outcome =
      curbline(logs.replay(replaced, by) + Words{"--labels", logs.path("new-labels.csv"), "--curbs", curbs, "--picture",
                                                 logs.path("new.svg"), "--json"});
  CHECK(names_in(logs.folder()) == before);
  CHECK(read_file(curbs) == "as it was\n");
  return outcome;
}

Outcome map_of(const std::string& cloud, const TemporaryDirectory& dir) {
  const Words before = names_in(dir.path(""));
  const Outcome outcome =
      curbline({"map", cloud, "--labels", dir.path("l.csv"), "--curbs", dir.path("c.csv"), "--json"});
  CHECK(names_in(dir.path("")) == before);
  return outcome;
}

Recording standing() {
  return Recording("street", "utm30lx", {"--duration", "0.5"});
}

Recording driving() {
  return Recording("city", "utm30lx", {"--duration", "0.5"});
}

TEST_CASE("program: an empty log or cloud is refused") {
  const Recording logs = driving();
  for (const std::string log : {"scans", "can", "poses"}) {
    const std::string empty = logs.directory().write("empty", "");
    check_refused(replay_with(logs, log, empty), empty + ": ", "empty");
  }
  const TemporaryDirectory dir;
  for (const std::string name : {"a.xyz", "a.csv", "a.pcd", "a.bin"}) {
    const std::string empty = dir.write(name, "");
    check_refused(map_of(empty, dir), empty + ": ", name == "a.bin" ? "no points" : "empty");
  }
}

TEST_CASE("program: an empty robot description is the default robot") {
  const Recording logs = standing();
  CHECK(curbline(logs.replay("robot", logs.directory().write("empty.toml", ""))).status == 0);
}

TEST_CASE("program: a file that is not there is named") {
  const Recording logs = driving();
  for (const std::string log : {"scans", "can", "poses", "robot"}) {
    const std::string none = logs.path("none");
    check_refused(replay_with(logs, log, none), none + ": cannot be ", ": No such file or directory; expected");
  }
  const TemporaryDirectory dir;
  check_refused(map_of(dir.path("none.xyz"), dir), dir.path("none.xyz") + ": ", "No such file");
  check_refused(curbline({"evaluate", dir.path("none")}), dir.path("none"), "expected");
  check_refused(curbline({"evaluate", "--paper", dir.path("none")}), dir.path("none"), "expected");
}

TEST_CASE("program: a cut scan line is refused with its line number") {
  const Recording logs = standing();
  const std::string scans = read_file(logs.path("scans.carmen"));
  const std::string second = lines_of(scans)[1];
  const std::string in_ranges = logs.directory().write("cut", with_line(scans, 2, second.substr(0, 400)));
  check_refused(replay_with(logs, "scans", in_ranges), in_ranges + ":2: ", "a range");
  const std::string at_end =
      logs.directory().write("cut", with_line(scans, 2, second.substr(0, second.rfind(" curbline"))));
  check_refused(replay_with(logs, "scans", at_end), at_end + ":2: ", "host");
  const std::string of_file = logs.directory().write("cut", scans.substr(0, scans.size() - 3000));
  check_refused(replay_with(logs, "scans", of_file), of_file + ":20: ", "the file ends within this line");
}

TEST_CASE("program: NaN and infinity in poses are refused with line and field") {
  const Recording drive = driving();
  std::string pose = lines_of(read_file(drive.path("poses.tum")))[3];
  pose.replace(pose.find(' ') + 1, 8, "nan");
  const std::string poses = drive.directory().write("bad", with_line(read_file(drive.path("poses.tum")), 4, pose));
  check_refused(replay_with(drive, "poses", poses), poses + ":4: tx is ", "expected a finite number");
}

TEST_CASE("program: a time that goes back is refused in poses") {
  const Recording logs = driving();
  const std::string text = read_file(logs.path("poses.tum"));
  const Words lines = lines_of(text);
  const std::string back = logs.directory().write("back", with_line(with_line(text, 4, lines[4]), 5, lines[3]));
  check_refused(replay_with(logs, "poses", back), back + ":5: ", "goes back; expected");
}

TEST_CASE("program: a CAN log whose times go back or stand is refused for its times") {
  const Recording logs = standing();
  std::string back, still;
  for (const std::string& line : lines_of(read_file(logs.path("can.log")))) {
    back = line + "\n" + back;
    still += "(0.500000" + line.substr(line.find(')')) + "\n";
  }
  for (const std::string& text : {back, still}) {
    const std::string log = logs.directory().write("can", text);
    check_refused(replay_with(logs, "can", log), log + ": the times do not rise: ", "; expected times that rise\n");
  }
}

TEST_CASE("program: a pose of the future is refused with the line behind it") {
  const Recording logs = driving();
  const std::string poses = read_file(logs.path("poses.tum"));
  std::string pose = lines_of(poses)[9];
  pose.replace(0, 10, std::to_string(std::stol(pose.substr(0, 10)) + 3600));
  const std::string future = logs.directory().write("future", with_line(poses, 10, pose));
  check_refused(replay_with(logs, "poses", future), future + ":11: ", "goes back; expected");
}

TEST_CASE("program: a laser that nods wants its tilt log, a robot that drives its poses") {
  const Recording logs = standing();
  check_refused(replay_with(logs, "can", ""), logs.path("robot.toml") + ": ", "expected --can");
  const Recording drive("city", "fixed_tilt", {"--duration", "0.5"});
  check_refused(replay_with(drive, "poses", ""), drive.path("robot.toml") + ": ", "expected --poses");
}

TEST_CASE("program: a CAN log without a frame of the servo is refused, with the id that was expected") {
  const Recording logs = standing();
  std::string log = read_file(logs.path("can.log"));
  for (std::size_t at = log.find("181#"); at != std::string::npos; at = log.find("181#", at))
    log.replace(at, 4, "182#");
  const std::string wrong = logs.directory().write("wrong.log", log);
  check_refused(replay_with(logs, "can", wrong), wrong + ": none of ", "expected id 0x181");
}

TEST_CASE("program: a servo whose ids have 11 bits for 29, or 29 for 11, is refused with the bits that were expected") {
  const Recording logs = standing();
  const std::string robot = logs.directory().write("r.toml", "[tilt.signal]\nextended = true\n");
  check_refused(replay_with(logs, "robot", robot), logs.path("can.log") + ": none of ", "expected id 0x181 of 29 bits");
  std::string log = read_file(logs.path("can.log"));
  for (std::size_t at = log.find(" 181#"); at != std::string::npos; at = log.find(" 181#", at))
    log.insert(at + 1, "00000");
  const std::string wide = logs.directory().write("wide.log", log);
  check_refused(replay_with(logs, "can", wide), wide + ": none of ", "expected id 0x181 of 11 bits");
}

TEST_CASE("program: logs of two clocks are refused with a time of each") {
  const Recording logs = standing();
  std::string log;
  for (const std::string& line : lines_of(read_file(logs.path("can.log"))))
    log += "(1500000000" + line.substr(line.find('.')) + "\n";
  const std::string earlier = logs.directory().write("earlier.log", log.substr(0, log.find('\n') + 1));
  const Outcome outcome = replay_with(logs, "can", earlier);
  check_refused(outcome, logs.path("scans.carmen") + ": no scan line could be used, ",
                "; expected times that agree with the tilt log and the poses");
  CHECK(outcome.err.find("; the first scan line is of 1700000000.0") != std::string::npos);
  CHECK(outcome.err.find(", the first tilt angle of 1500000000.") != std::string::npos);
  const Recording drive("city", "utm30lx", {"--duration", "0.5"});
  std::string poses;
  for (const std::string& line : lines_of(read_file(drive.path("poses.tum")))) poses += line.substr(1) + "\n";
  const Outcome of_drive = replay_with(drive, "poses", drive.directory().write("earlier.tum", poses));
  CHECK(of_drive.err.find(", the first pose of 699999999.") != std::string::npos);
}

TEST_CASE("program: tilt angles in degrees for radians are told") {
  const Recording logs = standing();
  const auto told = [&](const std::string& scale) {
    const std::string robot = logs.directory().write("r.toml", "[tilt.signal]\nscale = " + scale + "\n");
    return curbline(logs.replay("robot", robot)).err;
  };
  const std::string degrees =
      " tilt angles are more than a turn from where their sweep began; expected radians, see scale of tilt.signal\n";
  CHECK(told("9.587379924285257e-05").empty());
  CHECK(told("0.0054931640625").find(degrees) != std::string::npos);
}

TEST_CASE("program: a first tilt frame that is damaged does not make degrees of the rest") {
  const Recording logs = standing();
  const std::string log = read_file(logs.path("can.log")), first = lines_of(log).front();
  const std::size_t data = first.find('#') + 1;
  const std::string damaged = first.substr(0, data + 4) + "7FFFFF7F";
  REQUIRE(first.size() == damaged.size());
  const Outcome outcome =
      curbline(logs.replay("can", logs.directory().write("damaged.log", with_line(log, 1, damaged))));
  CHECK(outcome.status == 0);
  CHECK(outcome.err.empty());
}

TEST_CASE("program: a scale at which no frame can hold an angle is refused with the possible angles") {
  const Recording logs = standing();
  const std::string robot = logs.directory().write("r.toml", "[tilt.signal]\nscale = 1000.0\n");
  check_refused(replay_with(logs, "robot", robot), logs.path("can.log") + ": ",
                "none holds an angle; expected 6 bytes or more and at most 1e+06 rad\n");
}

TEST_CASE("program: tilt frames of a second interface are refused, other frames of it are not") {
  const Recording logs = standing();
  const auto with_twin = [&](const std::string& id) {
    std::string both;
    for (const std::string& line : lines_of(read_file(logs.path("can.log"))))
      both += line + "\n" + line.substr(0, line.find(' ')) + " can1 " + id + line.substr(line.find('#')) + "\n";
    return logs.directory().write("both.log", both);
  };
  check_refused(replay_with(logs, "can", with_twin("181")),
                logs.path("both.log") + ":2: ", "tilt frames of can1 after those of can0; expected one interface");
  CHECK(curbline(logs.replay("can", with_twin("182"))).status == 0);
}

TEST_CASE("program: an unknown key and a wrong type in a robot's description are named with their line") {
  const Recording logs = standing();
  const std::string unknown = logs.directory().write("r.toml", "name = \"r\"\n[laser]\nbeems = 1081\n");
  check_refused(replay_with(logs, "robot", unknown), unknown + ":3: ", "laser.beems; expected");
  const std::string type = logs.directory().write("r.toml", "name = \"r\"\n[laser]\n\nbeams = \"many\"\n");
  check_refused(replay_with(logs, "robot", type), type + ":4: laser.beams ", "expected a whole number");
  const std::string syntax = logs.directory().write("r.toml", "name = \"r\"\n[laser\n");
  check_refused(replay_with(logs, "robot", syntax), syntax + ":2: ", "expected");
}

TEST_CASE("program: a line of 100 MB is refused and not kept") {
  constexpr long buffers_kib = 20'000;
  const Recording logs = driving();
  const auto check_bounded = [&](const Outcome& outcome, const Outcome& of_short_line, const std::string& start) {
    check_refused(outcome, start, "expected");
    CHECK(outcome.peak_kib < of_short_line.peak_kib + buffers_kib);
  };
  for (const auto& [log, start] :
       {std::pair{"scans", "RAWLASER1 "}, {"can", "("}, {"poses", "1.0 "}, {"robot", "name = "}}) {
    const std::string path = logs.directory().write("long", start);
    const Outcome of_short_line = replay_with(logs, log, path);
    long_line(logs.directory(), "long", start);
    check_bounded(replay_with(logs, log, path), of_short_line, path + ":");
  }
  const TemporaryDirectory dir;
  for (const std::string name : {"a.xyz", "a.csv", "a.pcd"}) {
    const std::string path = dir.write(name, "1 2 ");
    const Outcome of_short_line = map_of(path, dir);
    long_line(dir, name, "1 2 ");
    check_bounded(map_of(path, dir), of_short_line, path + ":1: ");
  }
}

TEST_CASE("program: a robot that is larger than the host's limits is refused with its file, line and key") {
  const Recording logs = standing();
  const std::string many =
      logs.directory().write("r.toml", "[laser]\nbeams = 5000\nbeam_interval_s = 0.0\nbearing_step_rad = 0.001\n");
  check_refused(replay_with(logs, "robot", many),
                many + ":2: ", "laser.beams is 5000; expected a whole number from 1 to 2881");
}

TEST_CASE("program: a scene file is refused with its line and key") {
  const TemporaryDirectory dir;
  const auto error = [&](const std::string& text, const std::string& at) {
    const std::string scene = dir.write("s.toml", text);
    check_refused(curbline({"simulate", "--scene", scene, "--robot", shipped_robot("utm30lx"), "--out", dir.path("o")}),
                  scene + at, "expected");
  };
  error("", ":");
  error("[ground]\nz = \"low\"\n", ":2: ground.z is 'low'");
  error("[ground]\nz = 0\n[robot]\nat = [0, 0]\nspeed = 1\n",
        ":5: robot.speed is without path; expected robot.path beside it");
  error("[robot]\npath = [[0, 0], [1, 0]]\nattitude = \"a\\nb\"\n", ":3: robot.attitude is \"a\\nb\"; expected level");
  error("[robot]\nattitude = \"level\"\n", ":2: robot.attitude is without path; expected robot.path");
  error("[robot]\nturn_rate_deg_s = 9\n", ":2: robot.turn_rate_deg_s is without path; expected robot.path");
  error("[robot]\npath = [[0, 0], [1, 0]]\nat = [0, 0]\n", ":3: robot.at is beside path; expected one of the two");
  error("grond = 1\n", ":1: unknown key grond; expected one of about, box, cylinder, ground, region, robot, wall");
  error("[[region]]\nz = 0\nrectangle = [5, 5, 6, 6]\n", ": ");  // the robot stands on nothing
  check_refused(curbline({"simulate", "--scene", dir.path("none.toml"), "--robot", shipped_robot("utm30lx"), "--out",
                          dir.path("o")}),
                dir.path("none.toml") + ": cannot be read: No such file or directory; expected a scene (TOML)\n", "");
}

TEST_CASE("program: scan lines of another laser are refused") {
  const Recording logs = standing();
  check_refused(replay_with(logs, "robot", shipped_robot("lms151")),
                logs.path("scans.carmen") + ":1: ", "1081 ranges; expected 541");
  const std::string turned = logs.directory().write("r.toml", "[laser]\nfirst_bearing_rad = -2.0\n");
  check_refused(replay_with(logs, "robot", turned), logs.path("scans.carmen") + ":1: start_angle ", "expected -2.0");
}

TEST_CASE("program: a file that cannot be written is named and none is left") {
  const TemporaryDirectory dir;
  const std::string cloud = cloud_with_a_step(dir);
  const std::string before = dir.write("before.csv", "as it was\n");
  std::filesystem::create_directory(dir.path("folder"));
  const Words names = names_in(dir.path(""));
  for (const std::string option : {"--labels", "--curbs", "--picture"}) {
    const std::string other = option == "--labels" ? "--curbs" : "--labels";
    const std::string nowhere = dir.path("none/out.svg");
    check_refused(curbline({"map", cloud, other, before, option, nowhere}), nowhere + ": ", "cannot be written");
    const std::string folder = dir.path("folder");
    if (option != "--picture")
      check_refused(curbline({"map", cloud, other, before, option, folder}), folder + ": ", "directory");
  }
  if (std::filesystem::exists("/dev/full")) {
    check_refused(curbline({"map", cloud, "--labels", before, "--curbs", "/dev/full"}),
                  "/dev/full: ", "cannot be written: No space left on device; expected room for it\n");
  }
  const std::string bitmap = dir.path("map.bmp");
  check_refused(curbline({"map", cloud, "--labels", before, "--picture", bitmap}), bitmap + ": ",
                "expected a name that ends in");
  CHECK(names_in(dir.path("")) == names);
  CHECK(read_file(before) == "as it was\n");
}

TEST_CASE("program: a file that cannot be written is refused before the work begins") {
  const Recording logs = standing();
  const std::string none = logs.path("none"), nowhere = logs.path("nowhere/out.svg"), bitmap = logs.path("map.bmp");
  for (const std::string option : {"--labels", "--curbs", "--picture", "--line-costs"})
    check_refused(curbline(logs.replay("scans", none) + Words{option, nowhere}), nowhere + ": ", "cannot be written");
  check_refused(curbline(logs.replay("scans", none) + Words{"--picture", bitmap}), bitmap + ": ", "ends in .png");
  check_refused(curbline({"map", none + ".xyz", "--picture", bitmap}), bitmap + ": ", "ends in .png");
  std::filesystem::remove(logs.path("scans.carmen"));
  check_refused(curbline({"evaluate", logs.folder(), "--picture", bitmap}), bitmap + ": ", "ends in .png");
}

TEST_CASE("program: a pipe to write is opened when there is something to write") {
  const Recording logs = standing();
  const std::string in = logs.path("in"), out = logs.path("out");
  REQUIRE(std::system(("mkfifo " + in + " " + out).c_str()) == 0);
  const std::string replay = "timeout 20 " + line_of(logs.replay("scans", in) + Words{"--labels", out});
  const std::string feed = "timeout 10 sh -c 'cat " + logs.path("scans.carmen") + " > " + in + "'";
  CHECK(std::system((replay + " & " + feed + " && timeout 10 grep -q x_m " + out).c_str()) == 0);
}

TEST_CASE("program: a robot's description that simulate reads from a pipe is kept beside the logs") {
  const TemporaryDirectory dir;
  const std::string simulate = line_of(
      {"simulate", "--scene", "street", "--robot", "/dev/stdin", "--out", dir.path("run"), "--duration", "0.1"});
  REQUIRE(std::system(("cat " + shipped_robot("lms151") + " | timeout 20 " + simulate + " > /dev/null").c_str()) == 0);
  CHECK(read_file(dir.path("run/robot.toml")) == read_file(shipped_robot("lms151")));
}

TEST_CASE("program: nothing is left of what a signal ends, and it ends by that signal") {
  const TemporaryDirectory dir;
  const Recording logs("street", "utm30lx", {"--duration", "2"});
  const Words before = names_in(logs.folder());
  std::filesystem::create_directory(dir.path("run"));
  for (const auto& [signal, number] : {std::pair{"HUP", 1}, {"INT", 2}, {"QUIT", 3}, {"PIPE", 13}, {"TERM", 15}}) {
    INFO(signal);
    const std::string timeout = "ulimit -c 0; timeout --preserve-status -s " + std::string(signal) + " 0.5 ";
    const auto status_of = [&](const Words& arguments) {
      return WEXITSTATUS(std::system((timeout + line_of(arguments) + " > /dev/null 2>&1").c_str()));
    };
    CHECK(status_of({"simulate", "--scene", "street", "--robot", shipped_robot("utm30lx"), "--out", dir.path("run"),
                     "--duration", "86400"}) == 128 + number);
    CHECK(names_in(dir.path("run")) == Words{});
    CHECK(status_of(logs.replay() + Words{"--speed", "1", "--line-costs", logs.path("lines.csv")}) == 128 + number);
    CHECK(names_in(logs.folder()) == before);
  }
}

TEST_CASE("program: a replay that is killed leaves nothing beside the files that it has not begun") {
  const Recording logs("street", "utm30lx", {"--duration", "2"});
  const Words before = names_in(logs.folder());
  const std::string replay = line_of(logs.replay() + Words{"--speed", "1", "--labels", logs.path("labels.csv")});
  CHECK(WEXITSTATUS(std::system(("ulimit -c 0; timeout -s KILL 0.5 " + replay).c_str())) == 128 + 9);
  CHECK(names_in(logs.folder()) == before);
}

TEST_CASE("program: a reader that closes the pipe leaves nothing half-written") {
  const Recording logs("street", "utm30lx");
  const Words before = names_in(logs.folder());
  const std::string replay = line_of(logs.replay() + Words{"--curbs", "-", "--line-costs", logs.path("lines.csv")});
  CHECK(std::system((replay + " 2> /dev/null | head -n 1 > /dev/null").c_str()) == 0);
  CHECK(names_in(logs.folder()) == before);
}

TEST_CASE("program: a limit on the size of files is an error of writing") {
  const TemporaryDirectory dir;
  const std::string simulate = line_of({"simulate", "--scene", "street", "--robot", shipped_robot("utm30lx"), "--out",
                                        dir.path("run"), "--duration", "1"});
  CHECK(WEXITSTATUS(std::system(("ulimit -f 100; " + simulate + " 2> " + dir.path("err")).c_str())) == 1);
  CHECK(names_in(dir.path("run")) == Words{});
  CHECK(read_file(dir.path("err")) ==
        dir.path("run/scans.carmen") + ": cannot be written: File too large; expected room for it\n");
}

TEST_CASE("program: standard output that cannot be written is an error") {
  if (!std::filesystem::exists("/dev/full")) return;
  const TemporaryDirectory dir;
  const std::string cloud = cloud_with_a_step(dir);
  for (const Words& option : {Words{"--json"}, {"--curbs", "-"}}) {
    const Outcome outcome = curbline(Words{"map", cloud} + option, "/dev/full");
    check_refused(outcome, "standard output: ", "cannot be written");
  }
  for (const Words& words : {Words{"--help"}, {"map", "--help"}, {"--version"}})
    check_refused(curbline(words, "/dev/full"), "standard output: ", "cannot be written");
}

TEST_CASE("program: a replay whose curbs cannot be written ends with the first, as one whose reader has gone") {
  if (!std::filesystem::exists("/dev/full")) return;
  const Recording logs("street", "utm30lx");
  const Words before = names_in(logs.folder());
  const Words outputs{"--curbs", "-", "--labels", logs.path("labels.csv"), "--line-costs", logs.path("lines.csv")};
  check_refused(curbline(logs.replay() + outputs, "/dev/full"), "standard output: ", "cannot be written");
  CHECK(names_in(logs.folder()) == before);
  // A service manager may have the signal ignored that would end it.
  const std::string replay = line_of(logs.replay() + outputs) + " 2> /dev/null";
  CHECK(std::system(("(trap '' PIPE; " + replay + ") | true").c_str()) == 0);
  CHECK(names_in(logs.folder()) == before);
}

TEST_CASE("program: a scanner whose address cannot be told does not wait for readers that will not find it") {
  if (!std::filesystem::exists("/dev/full")) return;
  const Recording logs = standing();
  const Words scanner{"10", CURBLINE_SCANNER, "scip2", "--port", "0", "--scans", logs.path("scans.carmen")};
  check_refused(run("/usr/bin/timeout", scanner, "/dev/full"), "standard output: ", "cannot be written");
}

TEST_CASE("program: a cloud of an unknown kind is refused") {
  const TemporaryDirectory dir;
  const std::string cloud = dir.write("a.ply", "1 2 3\n");
  check_refused(map_of(cloud, dir), cloud + ": ", "expected a name that ends in .xyz");
}

TEST_CASE("program: an unknown scene is refused with those that ship, and no directory is made") {
  const TemporaryDirectory dir;
  check_refused(curbline({"simulate", "--scene", "moon", "--robot", shipped_robot("utm30lx"), "--out", dir.path("o")}),
                "", "street");
  check_refused(curbline({"simulate", "--scene", "street", "--robot", dir.path("none"), "--out", dir.path("o")}),
                dir.path("none"), "expected");
  CHECK(names_in(dir.path("")).empty());
}

TEST_CASE("program: a name that is too long for any file is refused like that of a missing one") {
  const TemporaryDirectory dir;
  const std::string name(300, 'a');  // longer than the 255 bytes of Linux
  check_refused(curbline({"simulate", "--scene", name, "--robot", shipped_robot("utm30lx"), "--out", dir.path("o")}),
                "no scene '" + name + "'; expected", "street");
  check_refused(curbline({"evaluate", name}), name + "/truth.json: ", "expected what simulate wrote");
}

TEST_CASE("program: evaluate prints nothing where its picture is refused") {
  const Recording logs = standing();
  for (const std::string name : {"none/map.png", "map.gif"})
    check_refused(curbline({"evaluate", logs.folder(), "--picture", logs.path(name)}), logs.path(name) + ": ", "");
}

TEST_CASE("program: a label far from the others is refused with the file and line") {
  const Recording logs = standing();
  const std::string labels = logs.path("labels.csv");
  REQUIRE(curbline(logs.replay() + Words{"--labels", labels, "--curbs", logs.path("curbs.csv")}).status == 0);
  std::string row = lines_of(read_file(labels))[3];
  row.replace(0, row.find(','), "9e7");
  logs.directory().write("labels.csv", with_line(read_file(labels), 4, row));
  check_refused(curbline({"evaluate", logs.folder()}), labels + ":4: ", "x_m lies too far from that of the other rows");
}

TEST_CASE("program: truth that is cut is refused") {
  const Recording logs = standing();
  const std::string truth = read_file(logs.path("truth.json"));
  logs.directory().write("truth.json", truth.substr(0, truth.size() / 2));
  check_refused(curbline({"evaluate", logs.folder(), "--json"}), logs.path("truth.json"), "no JSON, or cut");
}

TEST_CASE("program: truth in another format is refused with the field") {
  const Recording logs = standing();
  const std::string truth = read_file(logs.path("truth.json"));
  const auto error = [&](const std::string& text, const std::string& expected) {
    logs.directory().write("truth.json", text);
    check_refused(curbline({"evaluate", logs.folder()}), logs.path("truth.json") + ": " + expected,
                  "what simulate wrote");
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    REQUIRE(truth.find(from) != std::string::npos);
    return std::string(truth).replace(truth.find(from), from.size(), to);
  };
  error("[]", "start_time_s is missing;");
  error("{\"start_time_s\": \"now\"}", "start_time_s is not a number;");
  error(with("\"planes\": [", "\"planes\": 3, \"p\": ["), "planes is not a list;");
  error(with("\"x0_m\"", "\"x9_m\""), "curbs[0].x0_m is missing;");
  error(with("\"x0_m\": ", "\"x0_m\": -1e300, \"x9_m\": "), "curbs[0].x0_m is not a place within 100 km;");
  error(with("\"start_time_s\": ", "\"start_time_s\": 1e10, \"t\": "), "start_time_s is not a time;");
  error(with("\"plane\": ", "\"plane\": 99"), "regions[0].plane is not the index of a plane;");
  std::filesystem::remove(logs.path("truth.json"));
  check_refused(curbline({"evaluate", logs.folder()}), logs.path("truth.json") + ": cannot be read: No such file", "");
}

}  // namespace
}  // namespace curbline::tools::testing
