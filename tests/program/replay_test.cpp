// simulate, replay and evaluate: logs through the program, and its results compared with the truth.
//
// Tolerances: a curb's position is known to half a cell of 0.1 m, its height depends on the planes beside it. The
// medians may be up to half a cell and 1 cm.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <random>
#include <sstream>

#include "evaluation/curbs.hpp"
#include "formats/csv.hpp"
#include "program.hpp"
#include "simulator/truth.hpp"

namespace curbline::tools::testing {
namespace {

constexpr double place_m = 0.05, height_m = 0.01;
constexpr double cell_m = 0.1;  ///< within this distance a curb counts as found
constexpr double least_step_m = 0.04;

Words results(const Recording& logs) {
  return {"--labels", logs.path("labels.csv"), "--curbs", logs.path("curbs.csv")};
}

void replay(const Recording& logs, const Words& more = {}) {
  const Outcome outcome = curbline(logs.replay() + results(logs) + more);
  INFO("standard error: " << outcome.err);
  REQUIRE(outcome.status == 0);
  CHECK(outcome.err.empty());
}

nlohmann::json evaluate(const Recording& logs, const Words& more = {}) {
  const Outcome outcome = curbline(Words{"evaluate", logs.folder(), "--json"} + more);
  INFO("standard error: " << outcome.err);
  REQUIRE(outcome.status == 0);
  return nlohmann::json::parse(outcome.out);
}

void check_curbs(const nlohmann::json& figures) {
  INFO(figures.dump(1));
  int high = 0;
  for (const nlohmann::json& curb : figures.value("curbs", nlohmann::json::array())) {
    if (curb.at("step_m") < least_step_m) continue;
    ++high;
    CHECK(curb.at("found") == true);
  }
  CHECK(high > 0);
  CHECK(figures.at("position_error_median_m").get<double>() <= place_m);
  CHECK(figures.at("height_error_median_m").get<double>() <= height_m);
}

TEST_CASE("program: curbs of 4 cm and more of the scenes are found, within half a cell and 1 cm") {
  for (const std::string scene : {"street", "straight_curb"}) {
    INFO(scene);
    const Recording logs(scene, "utm30lx");
    replay(logs);
    check_curbs(evaluate(logs));
  }
}

/// Stamps the lines of a CARMEN log as a host does on arrival: 5 ms late on average, most lines less, a few much more.
void stamp_on_arrival(const Recording& logs) {
  std::mt19937 random(2);
  double before_s = 0;
  std::ostringstream out;
  for (const std::string& line : lines_of(read_file(logs.path("scans.carmen")))) {
    const std::size_t host = line.rfind(' ', line.rfind(' ') - 1), time = line.rfind(' ', host - 1);
    const double late_s = -0.005 * std::log((static_cast<double>(random()) + 0.5) / 4294967296.0);
    before_s = std::max(before_s + 1e-6, std::stod(line.substr(time)) + late_s);
    out << line.substr(0, time) << std::fixed << std::setprecision(6) << ' ' << before_s << " host " << before_s
        << '\n';
  }
  logs.directory().write("scans.carmen", out.str());
}

TEST_CASE("program: scan lines stamped 5 ms late on the mean tell the heights of steps to 0.4 mm") {
  for (const std::string robot : {"utm30lx", "lms151"}) {
    INFO(robot);
    const Recording logs("street", robot);
    stamp_on_arrival(logs);
    const Outcome outcome = curbline(logs.replay() + results(logs));
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.err,
               Catch::StartsWith(logs.path("scans.carmen") + ": scan lines came late, each by another time: "));
    const nlohmann::json figures = evaluate(logs);
    check_curbs(figures);
    CHECK(figures.at("height_error_median_m").get<double>() <= 0.0004);
  }
}

/// The file of a shipped robot, with `lines` in place of its tilt signal.
std::string robot_with_signal(const TemporaryDirectory& dir, const std::string& shipped, const std::string& lines) {
  std::string text = read_file(shipped_robot(shipped));
  text.replace(text.find("node = 1\n"), 9, lines);
  return dir.write("signal.toml", text);
}

std::string with_key(std::string toml, const std::string& key, const std::string& value) {
  const std::size_t begin = toml.find("\n" + key + " = ") + 1;
  return toml.replace(begin, toml.find('\n', begin) - begin, key + " = " + value);
}

/// Labels of a recording by a robot whose description has `lines` as its tilt signal.
std::string labels_by_signal(const std::string& lines) {
  const TemporaryDirectory dir;
  const std::string robot = robot_with_signal(dir, "utm30lx", lines);
  const Words simulate{"simulate", "--scene",       "straight_curb", "--robot", robot,
                       "--out",    dir.path("run"), "--duration",    "2"};
  REQUIRE(curbline(simulate).status == 0);
  const Outcome outcome = curbline({"replay", "--scans", dir.path("run/scans.carmen"), "--can", dir.path("run/can.log"),
                                    "--robot", robot, "--labels", dir.path("labels.csv"), "--json"});
  INFO("standard error: " << outcome.err);
  REQUIRE(outcome.status == 0);
  const auto summary = nlohmann::json::parse(outcome.out);
  CHECK(summary.at("can_malformed") == 0);
  CHECK(summary.at("can_without_sync") == 0);
  CHECK(summary.at("tilt_readings") > 200);
  return read_file(dir.path("labels.csv"));
}

TEST_CASE("program: angles sampled on SYNC and sent later, or multiplexed, give the map of those sent at once") {
  const std::string at_once = labels_by_signal("node = 1\n");
  CHECK(lines_of(at_once).size() > 100);
  CHECK(labels_by_signal("node = 1\nsync_id = 0x80\n") == at_once);
  CHECK(labels_by_signal("node = 1\n[tilt.signal.multiplexor]\nlength = 4\nvalue = 9\n") == at_once);
}

TEST_CASE("program: positions without their SYNC are refused with what was expected") {
  const Recording logs("straight_curb", "clausius", {"--duration", "0.5"});
  const std::string robot = robot_with_signal(logs.directory(), "clausius", "node = 1\nsync_id = 0x80\n");
  check_refused(curbline(logs.replay("robot", robot)), logs.path("can.log") + ": none of ",
                "expected id 0x80 before each");
}

TEST_CASE("program: a multiplexed tilt signal without any frame is reported with the multiplexor's value") {
  const Recording logs("straight_curb", "clausius", {"--duration", "0.5"});
  const std::string robot =
      robot_with_signal(logs.directory(), "clausius", "node = 1\n[tilt.signal.multiplexor]\nlength = 4\nvalue = 9\n");
  check_refused(curbline(logs.replay("robot", robot)), logs.path("can.log") + ": none of ",
                "expected id 0x181 of 11 bits with multiplexor 9 as the robot's description has it");
}

TEST_CASE("program: a curb of 3 cm is found too") {
  const Recording logs("low_curb", "utm30lx");
  replay(logs);
  const nlohmann::json figures = evaluate(logs);
  CHECK(figures.at("curbs_found") == figures.at("curbs_visible"));
  CHECK(figures.at("height_error_median_m").get<double>() <= height_m);
}

//                              __|
//                     ________|    treads of 34 cm: seven cells of 5 cm or three of 10 cm, risers within one of them
//            ________|
//   ________|
//   0       1.2     1.54     1.88
void check_steps(const std::string& cell) {
  const Recording logs("steps", "utm30lx");
  replay(logs, {"--origin", "0.6", "-1.2", "--size", "1.5", "2.4", "--cell", cell});
  check_curbs(evaluate(logs));
}

TEST_CASE("program: each step of a flight is found with cells of 5 cm") {
  check_steps("0.05");
}

TEST_CASE("program: each step of a flight is found with cells of 10 cm") {
  check_steps("0.1");
}

//  ____             ____
//      |_    and  _|        seen by a laser whose spot is as long as a tread is deep
//        |_      |
TEST_CASE("program: the steps of stairs down and up are found with a wide spot, too") {
  const auto recall = [](const char* scene, const char* robot, const char* seed) {
    const nlohmann::json figures = evaluate(Recording(scene, robot, {"--seed", seed}));
    return figures.at("step_bands").at(1).at("recall").get<double>();
  };
  CHECK(recall("stairs_down", "lms200", "2") > 0.98);
  CHECK(recall("steps", "lms151", "37") > 0.9);
}

TEST_CASE("program: garden walls are no curbs, the pavement beside them has one") {
  const Recording logs("low_walls", "lms200");
  replay(logs);
  const nlohmann::json figures = evaluate(logs);
  check_curbs(figures);
  CHECK(figures.at("steps").at(1).at("tolerance_m") == 0.1);
  CHECK(figures.at("steps").at(1).at("precision").get<double>() > 0.95);
}

//   ____________
//               |       the first cells of the road lie in the step's shadow and contain points of the pavement
//               |_____
TEST_CASE("program: cells beside a step down have the label of the side of their middle") {
  const Recording logs("unfavourable_viewpoint", "utm30lx");
  CHECK(evaluate(logs).at("v").get<double>() > 0.95);
}

TEST_CASE("program: a ramp has edges and no step") {
  const Recording logs("ramp", "utm30lx");
  replay(logs);
  for (const MapCurb& curb : read_curbs(logs.path("curbs.csv"))) {
    CHECK(curb.kind == "ramp_edge");
    CHECK(std::abs(curb.height_m) < height_m);
  }
  CHECK(evaluate(logs).at("height_rmse_m").get<double>() < height_m);
}

/// The robot's servo lags by 15 ms more than its file states. The first turn reveals it, and what was mapped before is
/// corrected.
TEST_CASE("program: a servo that lags leaves one street, where it is") {
  const TemporaryDirectory directory;
  std::string robot = read_file(shipped_robot("utm30lx"));
  robot.replace(robot.find("tilt_rate_hz"), 0, "tilt_latency_s = 0.015\n");
  const std::string file = directory.path("robot.toml");
  std::ofstream(file) << robot;
  const Recording logs("street", file, {"--duration", "8"});
  const Outcome outcome = curbline(logs.replay() + Words{"--json"});
  REQUIRE(outcome.status == 0);
  const nlohmann::json figures = nlohmann::json::parse(outcome.out);
  CHECK(figures.at("tilt_latency_offset_s").get<double>() == Approx(0.015).margin(0.001));
  CHECK(figures.at("tilt_latency_sd_s").get<double>() < 0.002);  // a fifth of latency_sd_s, by which sweeps may differ
}

TEST_CASE("program: a laser at a fixed tilt maps as the robot drives, without a CAN log") {
  const Recording logs("city", "fixed_tilt", {"--duration", "8"});
  CHECK_FALSE(std::filesystem::exists(logs.path("can.log")));
  replay(logs);
  check_curbs(evaluate(logs));
}

TEST_CASE("program: a CAN log beside a laser at a fixed tilt is told as not read") {
  const Recording drive("city", "fixed_tilt", {"--duration", "0.5"});
  const Outcome outcome = curbline(drive.replay() + Words{"--can", drive.path("none.log")});
  CHECK(outcome.status == 0);
  CHECK(outcome.err == drive.path("none.log") + ": not read; the tilt is fixed\n");
}

TEST_CASE("program: a drive leaves its curbs in the map frame, also those behind the window") {
  const Recording logs("city", "utm30lx", {"--duration", "20"});
  replay(logs);
  const nlohmann::json figures = evaluate(logs);
  CHECK(figures.at("position_error_median_m").get<double>() <= place_m);
  CHECK(figures.at("height_error_median_m").get<double>() <= height_m);
  CHECK(figures.at("steps").at(1).at("tolerance_m") == 0.1);
  CHECK(figures.at("steps").at(1).at("precision").get<double>() > 0.95);

  const std::vector<MapCurb> found = read_curbs(logs.path("curbs.csv"));
  for (const MapCurb& c : found) CHECK(std::hypot(c.x1_m - c.x0_m, c.y1_m - c.y0_m) > 0.02);
  // The curb that the drive of `city` passes in its first 20 s: the near rim of a bed, 8 cm high, at the window's side.
  const Segment rim{10, 25, 13, 25};
  CHECK(curb_rates(found, std::span(&rim, 1), cell_m, [](double, double) { return true; }).recall > 0.9);
}

//  |___         ___|      9 cm lower at its gutters than at its crown
//      ---------
TEST_CASE("program: a cambered road is one surface, and its curbs are found, within half a cell and 1 cm") {
  for (const std::string robot : {"utm30lx", "lms151", "lms200"}) {
    INFO(robot);
    const nlohmann::json figures = evaluate(Recording("camber", robot));
    check_curbs(figures);
    CHECK(figures.at("v").get<double>() > 0.8);
  }
}

//  1.5 to 12 cm high, and changing along the footway
TEST_CASE("program: the curbs on both sides of a footway that falls to a crossing are found") {
  for (const std::string robot : {"utm30lx", "lms151", "lms200"}) {
    INFO(robot);
    const nlohmann::json figures = evaluate(Recording("parallel_ramp", robot));
    CHECK(figures.at("recall").get<double>() > 0.9);
    CHECK(figures.at("precision").get<double>() > 0.9);
  }
}

//    lawn _ footway
//   _____| |_______       8 cm of edging, 6 cm high
//                  |_____ road
TEST_CASE("program: a footway and a lawn of its height on either side of an edging narrower than a cell are two") {
  for (const std::string robot : {"utm30lx", "lms151", "lms200"}) {
    INFO(robot);
    CHECK(evaluate(Recording("edging", robot)).at("v").get<double>() > 0.8);
  }
}

//  ____        ____ 12 cm
//      \______/          over 8 cm: faces that lean
TEST_CASE("program: splayed curbs, down and up, are found as steps, and nothing else is") {
  for (const std::string robot : {"utm30lx", "lms151", "lms200"}) {
    INFO(robot);
    const nlohmann::json figures = evaluate(Recording("splayed_curbs", robot));
    check_curbs(figures);
    CHECK(figures.at("v").get<double>() > 0.9);
    for (const nlohmann::json& band : figures.at("step_bands")) {
      if (band.at("found_samples") > 0) CHECK(band.at("precision").get<double>() > 0.95);
    }
  }
}

//   y      y = 1: a curb along the path that rises from 2 cm to 10 cm
//   0      ->
//   0                        8 m
TEST_CASE("program: what a drive has left behind of a curb is as high as the curb is there") {
  const TemporaryDirectory dir;
  const std::string scene =
      dir.write("kerb.toml",
                "[ground]\nz = 0\n[[region]]\nrectangle = [-20, 1, 20, 20]\nz = 0.02\nslope = [0.01, 0]\n"
                "[robot]\npath = [[0, 0], [8, 0]]\n");
  const Recording logs(scene, "utm30lx");
  replay(logs);
  double behind_m = 0;
  for (const MapCurb& c : read_curbs(logs.path("curbs.csv"))) {
    const double length_m = std::hypot(c.x1_m - c.x0_m, c.y1_m - c.y0_m), x_m = 0.5 * (c.x0_m + c.x1_m);
    if (c.kind != "step_up" || x_m > 7.0 || std::abs(0.5 * (c.y0_m + c.y1_m) - 1.0) > place_m) continue;
    INFO("from " << c.x0_m << " to " << c.x1_m);
    CHECK(c.height_m == Approx(0.02 + 0.01 * x_m).margin(0.004));
    behind_m += length_m;
  }
  CHECK(behind_m > 4.0);
}

TEST_CASE("program: a localisation that corrects itself within a line leaves no ridge on level ground") {
  const TemporaryDirectory dir;
  const std::string scene = dir.write("level.toml", "[ground]\nz = 0\n[robot]\npath = [[0, 0], [6, 0]]\nspeed = 1\n");
  std::string robot = read_file(shipped_robot("utm30lx"));
  robot += "pose_jump_every_s = 1.5\npose_jump_height_m = 0.02\npose_jump_attitude_rad = 0.007\n";
  const Recording logs(scene, dir.write("robot.toml", robot));
  const Outcome outcome = curbline(logs.replay() + results(logs) + Words{"--json"});
  REQUIRE(outcome.status == 0);
  for (const MapCurb& c : read_curbs(logs.path("curbs.csv"))) CHECK_FALSE(is_step(c));
  CHECK(nlohmann::json::parse(outcome.out).at("lines_off_map") >= 2);
}

TEST_CASE("program: evaluate scores the whole way of a drive, not only what its last window saw") {
  const Recording logs("city", "utm30lx", {"--duration", "20"});
  nlohmann::json figures = evaluate(logs);  // the window has left the bed behind
  CHECK(figures.at("curbs").at(0).at("found") == true);
  CHECK(figures.at("curbs").at(0).at("distance_at_detection_m").get<double>() > 1.0);
  replay(logs);
  CHECK(evaluate(logs).at("curbs_visible") == figures.at("curbs_visible"));
}

TEST_CASE("program: evaluate has a list of curbs when none is visible") {
  const Recording logs("ramp", "utm30lx");
  const nlohmann::json figures = evaluate(logs);
  CHECK(figures.at("curbs") == nlohmann::json::array());
  CHECK(figures.at("curbs_visible") == 0);
  CHECK(figures.at("height_error_median_m").is_null());
}

TEST_CASE("program: evaluate says how many curbs are too short for its list, as those round an island") {
  const TemporaryDirectory dir;
  const std::string island = "[ground]\nz = 0.0\n[[region]]\nz = 0.1\ncircle = [2.2, 0.0, 1.0]\n";
  const Recording logs(dir.write("island.toml", island), "utm30lx");
  const Outcome outcome = curbline({"evaluate", logs.folder()});
  CHECK_THAT(outcome.out, Catch::Matchers::Contains("curbs found: 0 of 0, without 4") &&
                              Catch::Matchers::Contains("less than 0.3 m in view"));
  CHECK_THAT(curbline({"evaluate", Recording("straight_curb", "utm30lx").folder()}).out,
             Catch::Matchers::Contains("curbs found: 1 of 1\n"));
}

TEST_CASE("program: evaluate says what the reference makes of the same sweep, and the paper's figure") {
  const Recording logs("street", "utm30lx");
  const nlohmann::json figures = evaluate(logs);
  CHECK(figures.at("reference").at("v").get<double>() > 0.3);
  CHECK(figures.at("reference").at("height_rmse_m").get<double>() ==
        Approx(figures.at("height_rmse_m").get<double>()).margin(0.01));
  CHECK(figures.at("paper").at("v") == 0.88);
  const Outcome of_method = curbline({"evaluate", logs.folder(), "--json", "--method", "crf-em"});
  REQUIRE(of_method.status == 0);
  const nlohmann::json same = nlohmann::json::parse(of_method.out);
  CHECK(same.at("v") == figures.at("reference").at("v"));
  CHECK(same.at("steps") == figures.at("reference").at("steps"));
}

TEST_CASE("program: a curb between the robot's middle and its laser is up or down as the laser sees it") {
  const TemporaryDirectory dir;
  std::string robot = read_file(shipped_robot("utm30lx"));
  robot = with_key(with_key(robot, "from_rad", "0.6"), "to_rad", "1.5");  // looks down in front of its wheels
  const std::string scene = dir.write("beside.toml", R"(
[ground]
z = 0.12
[[region]]
name = "road"
polygon = [[-0.6, 0.0], [0.6, -2.4], [9.0, -2.4], [9.0, 9.0], [-0.6, 9.0]]
z = 0.0
[robot]
at = [-0.75, 0.0]
)");
  const Recording logs(scene, dir.write("robot.toml", robot));
  const nlohmann::json figures = evaluate(logs);
  INFO(figures.dump(1));
  CHECK(figures.at("curbs").at(0).at("found") == true);
  CHECK(figures.at("height_error_median_m").get<double>() < 0.01);
}

TEST_CASE("program: evaluate draws the map with the truth and the robot") {
  const Recording logs("street", "utm30lx");
  const Outcome outcome = curbline({"evaluate", logs.folder(), "--picture", logs.path("p.svg")});
  REQUIRE(outcome.status == 0);
  const std::string with = read_file(logs.path("p.svg"));
  replay(logs, {"--picture", logs.path("q.svg")});
  CHECK(with.find("<desc>curbs: ") != std::string::npos);
  CHECK(with.size() > read_file(logs.path("q.svg")).size());  // the one without truth
}

TEST_CASE("program: a method that takes a whole cloud is refused for a drive") {
  const Recording logs("city", "utm30lx", {"--duration", "2"});
  check_refused(curbline({"evaluate", logs.folder(), "--method", "crf-em"}), logs.folder(),
                "the robot drove; expected");
}

TEST_CASE("program: evaluate replays the logs itself, with the poses of a drive, and finds what replay does") {
  for (const auto& [robot, scene, duration] : {std::tuple{"utm30lx", "street", "4"}, {"utm30lx", "city", "8"}}) {
    INFO(scene);
    const Recording logs(scene, robot, {"--duration", duration});
    const nlohmann::json from_logs = evaluate(logs);
    replay(logs);
    const nlohmann::json from_results = evaluate(logs);
    CHECK(from_logs.at("height_rmse_m").get<double>() ==
          Approx(from_results.at("height_rmse_m").get<double>()).margin(1e-4));
    CHECK(from_logs.at("curbs_found") == from_results.at("curbs_found"));
  }
}

TEST_CASE("program: evaluate tells no time of detection of curbs that another method found, and draws none of them") {
  const Recording logs("street", "utm30lx");
  CHECK(evaluate(logs).at("time_to_detection_median_s").is_number());
  CHECK(evaluate(logs, {"--method", "em"}).at("time_to_detection_median_s").is_null());
  const Words results{"--labels", logs.path("labels.csv"), "--curbs", logs.path("curbs.csv")};
  REQUIRE(curbline(logs.replay() + Words{"--method", "em"} + results).status == 0);
  CHECK(evaluate(logs).at("time_to_detection_median_s").is_null());
  check_refused(curbline({"evaluate", logs.folder(), "--picture", logs.path("em.png")}),
                logs.folder() + "/curbs.csv: ", "not what replay gives of the logs beside it; expected");
  replay(logs);
  CHECK(evaluate(logs).at("time_to_detection_median_s").is_number());
  CHECK(curbline({"evaluate", logs.folder(), "--picture", logs.path("map.png")}).status == 0);
}

TEST_CASE("program: evaluate refuses a picture that cannot be written before it scores") {
  const Recording logs("street", "utm30lx", {"--duration", "0.5"});
  std::filesystem::remove(logs.path("scans.carmen"));
  const std::string nowhere = logs.path("none/map.png");
  check_refused(curbline({"evaluate", logs.folder(), "--picture", nowhere}), nowhere + ": ", "cannot be written");
}

TEST_CASE("program: replay of a drive without its poses says that the robot was taken to stand") {
  const Recording logs("city", "utm30lx", {"--duration", "2"});
  const Words without{"replay",
                      "--scans",
                      logs.path("scans.carmen"),
                      "--can",
                      logs.path("can.log"),
                      "--robot",
                      logs.path("robot.toml")};
  const Outcome outcome = curbline(without);
  CHECK(outcome.status == 0);
  CHECK(outcome.err == logs.path("poses.tum") + ": not read, the robot was taken to stand; expected --poses\n");
  CHECK(curbline(without + Words{"--poses", logs.path("poses.tum")}).err.empty());
}

TEST_CASE("program: --curbs - streams one JSON object a line, the last as in the file") {
  const Recording logs("straight_curb", "utm30lx");
  const Outcome outcome = curbline(logs.replay() + Words{"--curbs", "-"});
  REQUIRE(outcome.status == 0);
  const Words lines = lines_of(outcome.out);
  REQUIRE(lines.size() > 1);
  for (const std::string& line : lines) {
    const nlohmann::json curb = nlohmann::json::parse(line);
    for (const char* key :
         {"x0_m", "y0_m", "x1_m", "y1_m", "position_sd_m", "height_m", "height_sd_m", "probability", "face_width_m"})
      CHECK(curb.at(key).is_number());
    CHECK(curb.at("kind").is_string());
    CHECK(curb.at("id").get<int>() > 0);
    CHECK(curb.size() == 11);
  }
  CHECK(std::adjacent_find(lines.begin(), lines.end()) == lines.end());  // told when it changes
  replay(logs);
  const std::vector<MapCurb> curbs = read_curbs(logs.path("curbs.csv"));
  REQUIRE(curbs.size() == 1);
  CHECK(nlohmann::json::parse(lines.back()).at("height_m").get<double>() == Approx(curbs[0].height_m).margin(1e-6));
}

TEST_CASE("program: --curbs - gives each curb as it is found, not at the end") {
  const Recording logs("straight_curb", "utm30lx");
  const std::string fifo = logs.path("fifo"), out = logs.path("out"), during = logs.path("during");
  REQUIRE(std::system(("mkfifo " + fifo).c_str()) == 0);
  // The scan lines' pipe stays open until curbs have come, for 10 s at most.
  const std::string feed = "(cat " + logs.path("scans.carmen") + "; i=0; while [ ! -s " + out +
                           " ] && [ $i -lt 100 ]; do sleep 0.1; i=$((i+1)); done; sleep 0.5; cp " + out + " " + during +
                           ") > " + fifo + " & ";
  const std::string replay = line_of(logs.replay("scans", fifo) + Words{"--curbs", "-"}) + " > " + out;
  REQUIRE(std::system((feed + replay + "; status=$?; wait; exit $status").c_str()) == 0);
  const std::string then = read_file(during), all = read_file(out);
  CHECK(then.ends_with('\n'));  // whole lines, not as many as fill a buffer
  CHECK(all.starts_with(then));
  CHECK(lines_of(then).size() + 1 >= lines_of(all).size());  // one scan line is read ahead
}

TEST_CASE("program: replay sums up in one JSON object") {
  const Recording logs("street", "utm30lx", {"--duration", "1"});
  const Outcome outcome = curbline(logs.replay() + Words{"--json"});
  REQUIRE(outcome.status == 0);
  const nlohmann::json summary = nlohmann::json::parse(outcome.out);
  CHECK(summary.at("lines") == 40);
  CHECK(summary.at("lines_dropped") == 0);
  CHECK(summary.at("tilt_dropped") == 0);
  CHECK(summary.at("beams_without_tilt") == 0);
  CHECK(summary.at("points").get<int>() > 0);
  CHECK(summary.at("outside").get<int>() > 0);
  CHECK(summary.at("latency_steps") == 0);
  CHECK(summary.at("lean_rad") == 0);
}

/// A run of replay that must exit with 0, and its summary.
struct Replayed {
  explicit Replayed(const Recording& logs) : outcome(curbline(logs.replay() + Words{"--json"})) {
    INFO("standard error: " << outcome.err);
    REQUIRE(outcome.status == 0);
    summary = nlohmann::json::parse(outcome.out);
  }
  Outcome outcome;
  nlohmann::json summary;
};

TEST_CASE("program: scan lines that are dropped are told, with the last reason") {
  const Recording logs("street", "utm30lx", {"--duration", "2"});
  Words frames = lines_of(read_file(logs.path("can.log")));
  frames.resize(60);
  std::string cut;
  for (const std::string& frame : frames) cut += frame + "\n";
  logs.directory().write("can.log", cut);
  const Replayed replayed(logs);
  const int dropped = replayed.summary.at("lines_dropped");
  CHECK(dropped > 40);
  const std::string told = logs.path("scans.carmen") + ": " + std::to_string(dropped) +
                           " of 80 scan lines were dropped, the last for: no tilt angle near the scan line's time\n";
  CHECK(replayed.outcome.err == told);
  CHECK(curbline({"evaluate", logs.folder()}).err == told);
}

/// Moves the time of one frame of the log.
void move_frame(const Recording& logs, std::size_t number, double by_s) {
  const std::string log = read_file(logs.path("can.log"));
  std::string frame = lines_of(log).at(number - 1);
  const std::size_t end = frame.find(')');
  const double time_s = std::stod(frame.substr(1, end - 1)) + by_s;
  char moved[32];
  std::snprintf(moved, sizeof moved, "(%.6f", time_s);
  logs.directory().write("can.log", with_line(log, number, moved + frame.substr(end)));
}

TEST_CASE("program: a tilt frame of the future costs the lines beside it, not the rest of the log") {
  for (const double by_s : {3600.0, 0.5}) {
    INFO(by_s << " s");
    const Recording logs("street", "utm30lx", {"--duration", "4"});
    move_frame(logs, 201, by_s);
    const Replayed replayed(logs);
    CHECK(replayed.summary.at("lines").get<int>() + replayed.summary.at("lines_dropped").get<int>() == 160);
    CHECK(replayed.summary.at("lines_dropped") < 10);
    CHECK(replayed.summary.at("tilt_dropped") == 15);
    CHECK(replayed.outcome.err.starts_with(logs.path("can.log") + ": 15 of "));
    CHECK_FALSE(replayed.outcome.err.ends_with("\n\n"));
  }
}

TEST_CASE("program: tilt frames in another order than their times are dropped and told") {
  const Recording logs("street", "utm30lx", {"--duration", "2"});
  move_frame(logs, 100, 0.0101);
  const Replayed replayed(logs);
  CHECK(replayed.summary.at("lines_dropped") == 0);
  CHECK(replayed.outcome.err.starts_with(logs.path("can.log") + ": 1 of "));
  CHECK(replayed.outcome.err.ends_with(" tilt readings were dropped; expected times that rise\n"));
}

TEST_CASE("program: tilt frames further apart than max_gap_s are refused with that setting") {
  const Recording logs("street", "utm30lx", {"--duration", "1"});
  const std::string robot = with_key(read_file(shipped_robot("utm30lx")), "max_gap_s", "0.005");
  const Outcome outcome = curbline(logs.replay("robot", logs.directory().write("gap.toml", robot)));
  CHECK(outcome.status == 1);
  CHECK(outcome.err.find(", and tilt frames at most max_gap_s, 0.005 s, apart; the first scan line is of ") !=
        std::string::npos);
}

TEST_CASE("program: a window that no point falls in is told") {
  const Recording logs("street", "utm30lx", {"--duration", "1"});
  const Outcome outcome = curbline(logs.replay() + Words{"--origin", "1000", "1000", "--size", "4", "4"});
  CHECK(outcome.status == 0);
  CHECK(outcome.err.starts_with(logs.path("scans.carmen") + ": none of "));
  CHECK(outcome.err.ends_with(" points lies in the window\n"));
}

TEST_CASE("program: a window whose corner no float is near enough to is empty where nothing was mapped") {
  const Recording logs("street", "utm30lx", {"--duration", "0.5"});
  for (const Words& corner : {Words{"99999.999", "0"}, {"0", "99999.999"}, {"-99999.997", "99999.997"}}) {
    INFO(corner[0] << " " << corner[1]);
    const std::string labels = logs.path("labels.csv");
    const Words window = Words{"--origin"} + corner + Words{"--size", "0.04", "0.04", "--cell", "0.001"};
    const Outcome outcome = curbline(logs.replay() + window + Words{"--labels", labels});
    CHECK(outcome.status == 0);
    CHECK(read_labels(labels).empty());
  }
}

TEST_CASE("program: poses in millimetres, which carry the window away from all it has mapped, are told") {
  const TemporaryDirectory dir;
  const std::string scene =
      dir.write("level.toml", "[ground]\nz = 0.0\n[robot]\npath = [[0.0, 0.0], [2.0, 0.0]]\nspeed = 0.5\n");
  const Recording logs(scene, "utm30lx");
  std::istringstream poses(read_file(logs.path("poses.tum")));
  std::string millimetres, time, rest;
  for (double x, y, z; poses >> time >> x >> y >> z && std::getline(poses, rest);)
    millimetres += time + " " + std::to_string(1000 * x) + " " + std::to_string(1000 * y) + " " +
                   std::to_string(1000 * z) + rest + "\n";
  const Outcome outcome =
      curbline(logs.replay("poses", logs.directory().write("mm.tum", millimetres)) + Words{"--json"});
  CHECK(outcome.status == 0);
  const nlohmann::json summary = nlohmann::json::parse(outcome.out);
  CHECK(summary.at("cells") == 0);
  CHECK(summary.at("points") > 0);
  CHECK(outcome.err.starts_with(logs.path("scans.carmen") + ": the map is empty: "));
  CHECK(lines_of(outcome.err).size() == 1);
}

/// Text of a scan line with another stamp, of seconds.
std::string stamped(const std::string& line, const std::string& stamp) {
  const std::size_t before = line.rfind(" curbline "), at = line.rfind(' ', before - 1) + 1;
  return line.substr(0, at) + stamp + line.substr(before);
}

TEST_CASE("program: scan lines out of order are dropped and told, as on the robot, and cost only themselves") {
  const Recording logs("street", "utm30lx", {"--duration", "4"});
  const nlohmann::json undisturbed = Replayed(logs).summary;
  const std::string scans = read_file(logs.path("scans.carmen"));
  const Words lines = lines_of(scans);
  const auto replayed = [&](const std::string& text) {
    logs.directory().write("scans.carmen", text);
    return Replayed(logs);
  };
  const auto check = [&](const Replayed& disturbed, const std::string& why) {
    CHECK(disturbed.summary.at("lines_dropped") == 1);
    CHECK(disturbed.summary.at("lines").get<int>() == undisturbed.at("lines").get<int>() - 1);
    CHECK(disturbed.summary.at("curbs") == undisturbed.at("curbs"));
    CHECK(disturbed.outcome.err == logs.path("scans.carmen") + ": 1 of " + std::to_string(lines.size()) +
                                       " scan lines were dropped, the last for: " + why + "\n");
  };
  SECTION("two that are swapped") {
    check(replayed(with_line(with_line(scans, 60, lines[60]), 61, lines[59])),
          "scan line is not later than the one before");
  }
  SECTION("one with a stamp of the future") {
    const std::string hour_later = stamped(lines[59], "1700003600.0");
    check(replayed(with_line(scans, 60, hour_later)), "no tilt angle near the scan line's time");
  }
  SECTION("one with a stamp of the past") {
    check(replayed(with_line(scans, 60, stamped(lines[59], "1600000000.0"))),
          "scan line is not later than the one before");
  }
}

/// The recording's scan lines with `change` applied to all ranges.
std::string with_ranges(const Recording& logs, const std::function<double(double)>& change) {
  std::string text;
  for (const std::string& line : lines_of(read_file(logs.path("scans.carmen")))) {
    std::istringstream words(line);
    std::string word;
    for (int k = 0, beams = 0; words >> word; ++k) {
      if (k == 8) beams = std::stoi(word);
      const bool is_range = k > 8 && k <= 8 + beams;
      text += (k > 0 ? " " : "") + (is_range ? std::to_string(change(std::stod(word))) : word);
    }
    text += "\n";
  }
  return logs.directory().write("changed.carmen", text);
}

TEST_CASE("program: ranges in millimetres, or a laser that is covered, are told as beams that do not return") {
  const Recording logs("street", "lms200", {"--duration", "0.5"});
  for (const double factor : {1000.0, 0.0, 1e-3}) {
    const std::string scans = with_ranges(logs, [=](double range_m) { return factor * range_m; });
    const Outcome outcome = curbline(logs.replay("scans", scans));
    INFO("standard error: " << outcome.err);
    CHECK(outcome.status == 0);
    CHECK(outcome.err.starts_with(scans + ": none of "));
    CHECK(outcome.err.ends_with(" beams returned; expected ranges in metres from 0.1 to 8\n"));
  }
}

TEST_CASE("program: --line-costs has a row for each scan line, and their sums are the summary's") {
  const Recording logs("street", "lms200");
  const Outcome outcome = curbline(logs.replay() + Words{"--json", "--line-costs", logs.path("lines.csv")});
  REQUIRE(outcome.status == 0);
  const auto summary = nlohmann::json::parse(outcome.out);
  std::ifstream file(logs.path("lines.csv"));
  std::string row;
  std::getline(file, row);
  CHECK(row == "x_m,y_m,take_s,evidences,messages,dropped,full,deferred");
  long rows = 0, deferred = 0;
  double seconds = 0;
  while (std::getline(file, row)) {
    ++rows;
    deferred += std::stol(row.substr(row.rfind(',') + 1));
    seconds += std::stod(row.substr(row.find(',', row.find(',') + 1) + 1));
  }
  CHECK(rows == summary.at("lines"));
  CHECK(deferred == summary.at("cells_deferred"));
  CHECK(seconds > 0);
  CHECK(seconds < outcome.seconds);
}

TEST_CASE("program: --speed 1 takes as long as the log, max does not wait") {
  const Recording logs("straight_curb", "utm30lx", {"--duration", "1"});
  const Outcome slow = curbline(logs.replay() + Words{"--speed", "1"});
  CHECK(slow.status == 0);
  CHECK(slow.seconds >= 0.9);
  const Outcome twice = curbline(logs.replay() + Words{"--speed", "2"});
  CHECK(twice.seconds >= 0.45);
  CHECK(twice.seconds < 0.75 * slow.seconds);
  CHECK(curbline(logs.replay() + Words{"--speed", "max"}).seconds < 0.9);
}

TEST_CASE("program: the same logs give the same files, and the same seed the same logs") {
  const Recording first("street", "utm30lx", {"--duration", "2"}), second("street", "utm30lx", {"--duration", "2"});
  for (const Recording* logs : {&first, &second}) replay(*logs, {"--picture", logs->path("map.svg")});
  const std::string labels = read_file(first.path("labels.csv")), curbs = read_file(first.path("curbs.csv"));
  for (const std::string name : {"scans.carmen", "can.log", "truth.json", "labels.csv", "curbs.csv"}) {
    INFO(name);
    CHECK(read_file(first.path(name)) == read_file(second.path(name)));
  }
  replay(first);
  CHECK(read_file(first.path("labels.csv")) == labels);
  CHECK(read_file(first.path("curbs.csv")) == curbs);
}

TEST_CASE("program: with every tenth tilt frame lost the curbs are found") {
  const Recording logs("straight_curb", "utm30lx");
  std::mt19937 random(5);
  std::string left;
  int lost = 0;
  for (const std::string& line : lines_of(read_file(logs.path("can.log")))) {
    if (random() % 10 == 0) {
      ++lost;
    } else {
      left += line + "\n";
    }
  }
  REQUIRE(lost > 20);
  logs.directory().write("can.log", left);
  replay(logs);
  check_curbs(evaluate(logs));
}

TEST_CASE("program: frames of other devices on the bus change nothing") {
  const Recording logs("street", "utm30lx", {"--duration", "2"});
  replay(logs);
  const std::string labels = read_file(logs.path("labels.csv"));
  std::string busy;
  for (const std::string& line : lines_of(read_file(logs.path("can.log")))) {
    busy += line + "\n" + line.substr(0, line.find(' ')) + " can0 080#\n" + line.substr(0, line.find(' ')) +
            " can0 00000181#0011223344556677\n";
  }
  logs.directory().write("can.log", busy);
  replay(logs);
  CHECK(read_file(logs.path("labels.csv")) == labels);
}

TEST_CASE("program: replay takes the paper's methods") {
  const Recording logs("straight_curb", "utm30lx");
  for (const std::string method : {"segment", "em", "crf-em"}) {
    INFO(method);
    replay(logs, {"--method", method});
    CHECK(read_labels(logs.path("labels.csv")).size() > 1000);
  }
}

}  // namespace
}  // namespace curbline::tools::testing
