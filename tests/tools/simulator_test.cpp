// The simulated sensors, and the directory to which their data are written.
#include "curbline/can/signal.hpp"
#include "curbline/can/tilt_decoder.hpp"
#include "formats/bad_input.hpp"
#include "formats/can_log.hpp"
#include "formats/carmen.hpp"
#include "formats/regions.hpp"
#include "formats/trajectory.hpp"
#include "simulator/simulate.hpp"
#include "simulator/simulation.hpp"
#include "simulator/truth.hpp"
#include "tools/simulator_support.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

using namespace curbline;
using namespace curbline::tools;
namespace fs = std::filesystem;

namespace {

Robot plain_robot() {
  Robot robot;
  robot.tilt.T_base_tilt.x_m = 0.2f;
  robot.tilt.T_base_tilt.z_m = 1.0f;
  robot.tilt.T_tilt_laser.z_m = 0.05f;
  robot.laser.range_sd_m = 0.0f;
  robot.laser.bearing_sd_rad = 0.0f;
  robot.sweep = {0.2, 1.0, 2.0};
  return robot;
}

struct Samples {
  std::vector<Eigen::Vector3d> points;  // in the map frame, with the true pose and tilt
  std::vector<can::Frame> frames;
  std::vector<SimulatedPose> poses;
  std::vector<std::int64_t> line_times_ns;
};

double seconds_of(std::int64_t time_ns) {
  return static_cast<double>(time_ns - simulated_start_ns) * 1e-9;
}

void add_points(const ScanLine& line, const Robot& robot, const Simulation& simulation, Samples& out) {
  for (std::size_t i = 0; i < line.ranges_m.size(); ++i) {
    const auto beam = static_cast<double>(i);
    const double t = seconds_of(line.time_ns) + beam * static_cast<double>(robot.laser.beam_interval_s);
    const double bearing =
        static_cast<double>(robot.laser.first_bearing_rad) + beam * static_cast<double>(robot.laser.bearing_step_rad);
    const MountSettings mast = robot.tilt.T_base_tilt, arm = robot.tilt.T_tilt_laser;
    const Eigen::Vector3d ray(std::cos(bearing), std::sin(bearing), 0);
    const Eigen::Vector3d p_tilt =
        static_cast<double>(line.ranges_m[i]) * ray + Eigen::Vector3f(arm.x_m, arm.y_m, arm.z_m).cast<double>();
    const Eigen::AngleAxisd tilt(simulation.true_tilt_rad(t), Eigen::Vector3d::UnitY());
    const Eigen::Vector3d p =
        simulation.true_T_map_base(t) * (tilt * p_tilt + Eigen::Vector3f(mast.x_m, mast.y_m, mast.z_m).cast<double>());
    if (p.allFinite()) out.points.push_back(p);
  }
}

Samples run(const Scene& scene, const Robot& robot, double duration_s, std::uint64_t seed = 1) {
  Simulation simulation(scene, robot, seed, duration_s);
  Samples out;
  while (const auto event = simulation.next()) {
    if (const auto* line = std::get_if<ScanLine>(&*event)) {
      out.line_times_ns.push_back(line->time_ns);
      add_points(*line, robot, simulation, out);
    } else if (const auto* frame = std::get_if<can::Frame>(&*event)) {
      out.frames.push_back(*frame);
    } else {
      out.poses.push_back(std::get<SimulatedPose>(*event));
    }
  }
  return out;
}

const std::string flat = "[ground]\nz = 0\n";
const std::string step = flat + "[[region]]\nname = 'pavement'\nrectangle = [2, -20, 20, 20]\nz = 0.12\n";
const std::string drive = "[robot]\npath = [[0, 0], [10, 0]]\n";
const std::string robots = CURBLINE_SOURCE_DIR "/tools/robots/";

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("simulation: without noise every beam on a flat ground lies on it") {
  const Samples samples = run(scene_of(flat), plain_robot(), 1.0);
  REQUIRE(samples.line_times_ns.size() == 40);
  REQUIRE(samples.points.size() > 10000);
  for (const Eigen::Vector3d& p : samples.points) {
    REQUIRE(std::abs(p.z()) < 1e-5 * (1 + p.norm()));
  }
}

TEST_CASE("simulation: range noise has the laser's standard deviation") {
  Robot robot = plain_robot();
  robot.laser.range_sd_m = 0.02f;
  robot.tilt.fixed = true;
  robot.tilt.fixed_tilt_rad = 1.5707963f;  // the ground below is straight ahead
  robot.laser.first_bearing_rad = 0;
  robot.laser.bearing_step_rad = 1e-9f;
  double sum = 0, squares = 0;
  const Samples samples = run(scene_of(flat), robot, 1.0);
  for (const Eigen::Vector3d& p : samples.points) {
    sum += p.z(), squares += p.z() * p.z();
  }
  const auto n = static_cast<double>(samples.points.size());
  CHECK(std::abs(sum / n) < 4 * 0.02 / std::sqrt(n));
  CHECK(std::sqrt(squares / n) == Approx(0.02).epsilon(0.03));
}

//            _______ 0.12
//  _________|
TEST_CASE("simulation: a step of 12 cm is seen with its height, its face and its place") {
  const Samples samples = run(scene_of(step), plain_robot(), 2.0);
  int below = 0, face = 0, above = 0;
  for (const Eigen::Vector3d& p : samples.points) {
    const bool on_ground = std::abs(p.z()) < 1e-4 && p.x() < 2 + 1e-4;
    const bool on_pavement = std::abs(p.z() - 0.12) < 1e-4 && p.x() > 2 - 1e-4;
    const bool on_face = std::abs(p.x() - 2) < 1e-4 && p.z() > 0 && p.z() < 0.12;
    if (p.norm() < 20) REQUIRE((on_ground || on_pavement || on_face));
    below += on_ground, face += on_face, above += on_pavement;
  }
  CHECK(below > 1000);
  CHECK(face > 100);
  CHECK(above > 1000);
}

TEST_CASE("simulation: a beam with a width gives mixed pixels at edges and nowhere else") {
  Robot robot = plain_robot();
  robot.simulated.beam_divergence_rad = 0.005;
  const Scene scene = scene_of(flat + "[[wall]]\nfrom = [2, -0.5]\nto = [2, 0.5]\nthickness = 0.01\nheight = 0.5\n");
  int mixed = 0;
  for (const Eigen::Vector3d& p : run(scene, robot, 2.0).points) {
    if (p.head<2>().norm() > 5) continue;  // farther away, the footprint on the ground is long
    const bool on_ground = std::abs(p.z()) < 0.01;
    const bool on_wall = std::abs(p.x() - 2) < 0.02 && std::abs(p.y()) < 0.51 && p.z() < 0.51;
    if (on_ground || on_wall) continue;
    ++mixed;
    const double fx = (p.x() - 0.2) / (2 - 0.2);  // seen from the laser, it lies on the outline of the wall
    const double y_at_wall = p.y() / fx, z_at_wall = 1.05 + (p.z() - 1.05) / fx;
    REQUIRE((std::abs(std::abs(y_at_wall) - 0.5) < 0.06 || std::abs(z_at_wall - 0.5) < 0.06 || z_at_wall < 0.06));
  }
  CHECK(mixed > 20);

  robot.simulated.beam_divergence_rad = 0;
  for (const Eigen::Vector3d& p : run(scene, robot, 1.0).points) {
    REQUIRE((std::abs(p.z()) < 1e-4 || (std::abs(p.x() - 2) < 0.006 && std::abs(p.y()) < 0.501)));
  }
}

TEST_CASE("simulation: so many returns are lost as the robot's description says") {
  Robot robot = plain_robot();
  const auto returns = static_cast<double>(run(scene_of(flat), robot, 1.0).points.size());
  robot.simulated.dropout = 0.25;
  const auto left = static_cast<double>(run(scene_of(flat), robot, 1.0).points.size());
  CHECK(left / returns == Approx(0.75).margin(0.02));
}

TEST_CASE("simulation: a tilt frame bears the angle of its latency ago, rounded to the encoder's count") {
  Robot robot = plain_robot();
  robot.tilt.latency_s = 0.01f;  // known to the robot
  robot.simulated.tilt_latency_s = 0.02;
  robot.tilt_signal.scale = 0.01;  // a coarse encoder
  const Samples samples = run(scene_of(flat), robot, 0.5);
  REQUIRE(samples.frames.size() == static_cast<std::size_t>(40 * (0.5 + 2 * simulated_margin_s)) + 1);
  double worst = 0;
  for (const can::Frame& frame : samples.frames) {
    const double angle = can::decode(robot.tilt_signal, frame).value();
    CHECK(std::abs(angle / 0.01 - std::round(angle / 0.01)) < 1e-6);
    const double error = angle - sweep_angle_rad(robot.sweep, seconds_of(frame.time_ns) - 0.03);
    CHECK(std::abs(error) <= 0.005 + 1e-6);
    worst = std::max(worst, std::abs(error));
  }
  CHECK(worst > 0.002);
}

TEST_CASE("simulation: each sweep's frames have a latency of their own, if the robot says so") {
  Robot robot = plain_robot();
  robot.simulated.tilt_latency_sweep_sd_s = 0.01;
  const Samples samples = run(scene_of(flat), robot, 8.0);  // eight sweeps
  std::map<int, std::vector<double>> of_sweep;
  for (const can::Frame& frame : samples.frames) {
    const double t = seconds_of(frame.time_ns), in_sweep = t - std::floor(t);
    if (in_sweep < 0.3 || in_sweep > 0.7) continue;  // where the servo's rate is constant
    const double rate = (sweep_angle_rad(robot.sweep, t + 0.01) - sweep_angle_rad(robot.sweep, t - 0.01)) / 0.02;
    const double angle = can::decode(robot.tilt_signal, frame).value();
    of_sweep[static_cast<int>(std::floor(t))].push_back((sweep_angle_rad(robot.sweep, t) - angle) / rate);
  }
  REQUIRE(of_sweep.size() == 8);
  std::vector<double> latencies_s;
  for (const auto& [sweep, seen] : of_sweep) {
    for (const double latency_s : seen) CHECK(latency_s == Approx(seen[0]).margin(1e-5));
    latencies_s.push_back(seen[0]);
  }
  const auto [least, most] = std::minmax_element(latencies_s.begin(), latencies_s.end());
  CHECK(*most - *least > 0.01);
  CHECK(*most - *least < 0.06);
}

TEST_CASE("simulation: a drive on SYNC gives each angle behind the SYNC frame on which it was sampled") {
  Robot robot = plain_robot();
  robot.tilt_sync_id = can::default_sync_id;
  const Samples samples = run(scene_of(flat), robot, 0.5);
  const auto asked = static_cast<std::size_t>(40 * (0.5 + 2 * simulated_margin_s)) + 1;
  REQUIRE(samples.frames.size() == 2 * asked - 1);  // the log ends before the last answer
  can::TiltDecoder decoder;
  REQUIRE(decoder.init(robot.tilt_signal, robot.tilt_sync_id));
  for (const can::Frame& frame : samples.frames) {
    const auto reading = decoder.take(frame);
    if (!reading) continue;
    CHECK(reading->time_ns < frame.time_ns);
    CHECK(reading->angle_rad == Approx(sweep_angle_rad(robot.sweep, seconds_of(reading->time_ns))).margin(1e-5));
  }
  CHECK(decoder.counters().readings == asked - 1);
}

TEST_CASE("simulation: jitter moves the stamps, not the angles, and stamps stay in order") {
  Robot robot = plain_robot();
  robot.simulated.tilt_rate_hz = 100;
  robot.simulated.tilt_jitter_s = 0.004;
  const Samples samples = run(scene_of(flat), robot, 10.0);
  double squares = 0;
  for (std::size_t i = 0; i < samples.frames.size(); ++i) {
    const double due_s = static_cast<double>(i) / 100 - simulated_margin_s;
    const double late_s = seconds_of(samples.frames[i].time_ns) - due_s;
    squares += late_s * late_s;
    CHECK(can::decode(robot.tilt_signal, samples.frames[i]).value() ==
          Approx(sweep_angle_rad(robot.sweep, due_s)).margin(1e-5));
    if (i > 0) CHECK(samples.frames[i].time_ns > samples.frames[i - 1].time_ns);
  }
  CHECK(std::sqrt(squares / static_cast<double>(samples.frames.size())) == Approx(0.004).epsilon(0.1));
}

TEST_CASE("simulation: the servo nods between its ends without a jump of angle or speed") {
  const Sweep sweep{-0.2, 1.1, 4.0};
  CHECK(sweep_angle_rad(sweep, 0) == Approx(-0.2));
  CHECK(sweep_angle_rad(sweep, 1) == Approx(0.45));
  CHECK(sweep_angle_rad(sweep, 2) == Approx(1.1));
  CHECK(sweep_angle_rad(sweep, 3) == Approx(0.45));
  CHECK(sweep_angle_rad(sweep, -1) == Approx(0.45));
  double before = 0;
  for (double t = 0; t < 8; t += 0.001) {
    const double rate = (sweep_angle_rad(sweep, t + 0.001) - sweep_angle_rad(sweep, t)) / 0.001;
    if (t > 0) REQUIRE(std::abs(rate - before) < 0.02);
    before = rate;
  }
}

TEST_CASE("simulation: a sweep that the servo's signal cannot hold is refused with its key") {
  Robot robot = plain_robot();
  robot.file = "r.toml";
  robot.tilt_signal = can::mini_cheetah_reply(0, 0.5);
  robot.sweep = {-0.2, 1.0, 2.0};
  REQUIRE_THROWS_WITH(Simulation(scene_of(flat), robot, 1),
                      "r.toml: sweep.to_rad is 1; expected an angle that tilt.signal holds, 0.5 at most");
  robot.sweep = {-0.6, 0.5, 2.0};
  REQUIRE_THROWS_WITH(Simulation(scene_of(flat), robot, 1),
                      "r.toml: sweep.from_rad is -0.6; expected an angle that tilt.signal holds, -0.5 at least");
  robot.sweep = {0.6, 0.7, 2.0};
  REQUIRE_THROWS_WITH(Simulation(scene_of(flat), robot, 1),
                      "r.toml: sweep.from_rad is 0.6; expected an angle that tilt.signal holds, 0.5 at most");
  robot.sweep = {-0.7, -0.6, 2.0};
  REQUIRE_THROWS_WITH(Simulation(scene_of(flat), robot, 1),
                      "r.toml: sweep.from_rad is -0.7; expected an angle that tilt.signal holds, -0.5 at least");
  robot.sweep = {-0.5, 0.5, 2.0};
  CHECK_NOTHROW(Simulation(scene_of(flat), robot, 1));
  robot.sweep.to_rad = 1.0;
  robot.tilt.fixed = true;
  CHECK_NOTHROW(Simulation(scene_of(flat), robot, 1));
}

TEST_CASE("simulation: samples come in the order in which a robot gets them") {
  Simulation simulation(scene_of(flat + drive), plain_robot(), 1, 0.5);
  double last_s = -1;
  while (const auto event = simulation.next()) {
    double due_s = 0;
    if (const auto* line = std::get_if<ScanLine>(&*event)) due_s = seconds_of(line->time_ns) + 1080 * 25e-3 / 1440;
    if (const auto* frame = std::get_if<can::Frame>(&*event)) due_s = seconds_of(frame->time_ns);
    if (const auto* pose = std::get_if<SimulatedPose>(&*event)) due_s = seconds_of(pose->time_ns);
    CHECK(due_s >= last_s - 1e-6);
    last_s = due_s;
  }
  CHECK(last_s > 0.5 + simulated_margin_s - 0.06);
}

TEST_CASE("simulation: poses between which one interpolates are those of the drive") {
  Robot robot = plain_robot();
  const Samples exact = run(scene_of(flat + drive), robot, 5.0);
  REQUIRE(exact.poses.size() == static_cast<std::size_t>(20 * 5.5) + 1);
  for (const SimulatedPose& pose : exact.poses) {
    CHECK(pose.T_map_base.translation().x() == Approx(std::max(0.0, seconds_of(pose.time_ns))).margin(1e-6));
  }
  for (const Eigen::Vector3d& p : exact.points) REQUIRE(std::abs(p.z()) < 1e-4 * (1 + p.norm()));

  robot.simulated.pose_position_sd_m = 0.01;
  robot.simulated.pose_attitude_sd_rad = 0.002;
  double position = 0, attitude = 0;
  const Samples noisy = run(scene_of(flat + drive), robot, 10.0);
  for (const SimulatedPose& pose : noisy.poses) {
    position += std::pow(pose.T_map_base.translation().y(), 2);
    attitude += std::pow(pose.T_map_base.linear()(1, 0), 2);
  }
  const auto n = static_cast<double>(noisy.poses.size());
  CHECK(std::sqrt(position / n) == Approx(0.01).epsilon(0.2));
  CHECK(std::sqrt(attitude / n) == Approx(0.002).epsilon(0.2));
}

TEST_CASE("simulation: a localisation that corrects itself does so at its interval, up or down") {
  Robot robot = plain_robot();
  robot.simulated.pose_jump_every_s = 2.0;
  robot.simulated.pose_jump_height_m = 0.02;
  robot.simulated.pose_jump_attitude_rad = 0.01;
  double last_z_m = 0, jumps = 0;
  for (const SimulatedPose& pose : run(scene_of(flat + drive), robot, 9.0).poses) {
    const double z_m = pose.T_map_base.translation().z();
    if (seconds_of(pose.time_ns) < 2) CHECK((z_m == 0 && pose.T_map_base.linear().isIdentity()));
    if (std::abs(z_m - last_z_m) < 1e-9) continue;
    CHECK(std::abs(z_m - last_z_m) == Approx(0.02));
    CHECK(std::fmod(seconds_of(pose.time_ns), 2.0) < 0.06);  // shows in the next pose
    // The robot drives along x on level ground: roll and pitch are multiples of 0.01, odd ones after an odd jump.
    ++jumps;
    const Eigen::Matrix3d& R = pose.T_map_base.linear();
    const double roll_rad = std::atan2(R(2, 1), R(2, 2)), pitch_rad = std::asin(-R(2, 0));
    for (const double angle_rad : {roll_rad, pitch_rad}) {
      const double times = angle_rad / 0.01;
      CHECK(times == Approx(std::round(times)).margin(0.01));
      CHECK(std::fmod(std::abs(std::round(times)), 2.0) == std::fmod(jumps, 2.0));
    }
    last_z_m = z_m;
  }
  CHECK(jumps == 4);
}

TEST_CASE("simulation: a robot that stands gives no poses unless its description says that it has some") {
  Robot robot = plain_robot();
  CHECK(run(scene_of(flat), robot, 0.1).poses.empty());
  robot.pose.still = false;
  CHECK_FALSE(run(scene_of(flat), robot, 0.1).poses.empty());
}

TEST_CASE("simulation: an obstacle that moves is seen where it is at the time of the beam") {
  Robot robot = plain_robot();
  robot.tilt.fixed = true;
  const Scene scene = scene_of(flat + "[[box]]\nat = [5, 0]\nsize = [1, 4]\nheight = 2\nvelocity = [2, 0]\n");
  const Samples samples = run(scene, robot, 1.0);
  double first = 1e9, last = -1e9;
  for (const Eigen::Vector3d& p : samples.points) {
    if (std::abs(p.y()) < 0.01) first = std::min(first, p.x()), last = std::max(last, p.x());
  }
  CHECK(first == Approx(4.5 + 2 * 0.5 * 25e-3 * 0.75).margin(0.01));  // the middle beam comes 9.4 ms after the first
  CHECK(last == Approx(first + 2 * 39.0 / 40).margin(0.01));
}

TEST_CASE("simulation: every scene that ships gives points on its ground") {
  Robot robot = plain_robot();
  robot.simulated.beam_divergence_rad = 0.002;
  robot.sweep = {0.6, 1.0, 0.4};
  for (const std::string& name : shipped_scenes()) {
    INFO(name);
    const Scene scene = find_scene(name);
    const Truth truth = make_truth(in_map_frame(scene), 0);
    const Samples samples = run(scene, robot, 0.2);
    CHECK(samples.line_times_ns.size() == 8);
    const auto on_ground = std::count_if(samples.points.begin(), samples.points.end(), [&](const Eigen::Vector3d& p) {
      return std::abs(p.z() - truth.terrain_height(p.x(), p.y())) < 0.02;
    });
    CHECK(samples.points.size() > 3000);
    CHECK(static_cast<double>(on_ground) > 0.4 * static_cast<double>(samples.points.size()));
  }
}

TEST_CASE("simulate: the files are read back as they were meant, with the truth beside them") {
  const TemporaryPath out("files");
  const Scene scene = find_scene("city");
  const SimulationSummary summary = simulate(scene, robots + "utm30lx.toml", out.path.string(), {1, 0.5});
  CHECK(summary.lines == 20);

  CarmenReader scans((out.path / "scans.carmen").string());
  std::int64_t lines = 0;
  while (const auto scan = scans.next()) {
    ++lines;
    CHECK(scan->time_ns == simulated_start_ns + (lines - 1) * 25'000'000);
    CHECK(scan->ranges_m.size() == 1081);
  }
  CHECK(lines == summary.lines);

  CanLogReader can((out.path / "can.log").string());
  std::int64_t frames = 0;
  while (can.next()) ++frames;
  CHECK(frames == summary.tilt_frames);
  CHECK(can.interface_name() == "can0");

  TrajectoryReader poses((out.path / "poses.tum").string());
  std::int64_t count = 0;
  while (poses.next()) ++count;
  CHECK(count == summary.poses);

  CHECK(read_truth(out.path.string()).start_time_s == 1700000000);
  CHECK(read_regions((out.path / "regions.gt").string()).size() == scene.regions.size());
  CHECK(bytes_of(out.path / "scene.toml") == scene.source);
  CHECK(bytes_of(out.path / "robot.toml") == bytes_of(robots + "utm30lx.toml"));
}

TEST_CASE("simulate: the same seed gives the same bytes, another seed others") {
  const TemporaryPath a("a"), b("b"), c("c");
  const Scene scene = find_scene("city");
  simulate(scene, robots + "utm30lx.toml", a.path.string(), {7, 0.2});
  simulate(scene, robots + "utm30lx.toml", b.path.string(), {7, 0.2});
  simulate(scene, robots + "utm30lx.toml", c.path.string(), {8, 0.2});
  for (const char* file : {"scans.carmen", "can.log", "poses.tum"}) {
    INFO(file);
    CHECK(bytes_of(a.path / file) == bytes_of(b.path / file));
    CHECK(bytes_of(a.path / file) != bytes_of(c.path / file));
  }
}

TEST_CASE("simulate: a fixed tilt writes no CAN log, nor leaves an earlier one") {
  const TemporaryPath out("fixed");
  simulate(find_scene("street"), robots + "utm30lx.toml", out.path.string(), {1, 0.1});
  CHECK(fs::exists(out.path / "can.log"));
  CHECK_FALSE(fs::exists(out.path / "poses.tum"));
  simulate(find_scene("street"), robots + "fixed_tilt.toml", out.path.string(), {1, 0.1});
  CHECK_FALSE(fs::exists(out.path / "can.log"));
}

TEST_CASE("simulate: what was found in an earlier recording does not stay beside a new one") {
  const TemporaryPath out("stale");
  simulate(find_scene("street"), robots + "utm30lx.toml", out.path.string(), {1, 0.1});
  for (const char* file : {"labels.csv", "curbs.csv"}) std::ofstream(out.path / file) << "of another scene\n";
  simulate(find_scene("street"), robots + "utm30lx.toml", out.path.string(), {1, 0.1});
  CHECK_FALSE(fs::exists(out.path / "labels.csv"));
  CHECK_FALSE(fs::exists(out.path / "curbs.csv"));
}

TEST_CASE("simulate: a directory in the place of a file is refused, and nothing of the earlier recording replaced") {
  const TemporaryPath out("directory");
  simulate(find_scene("street"), robots + "utm30lx.toml", out.path.string(), {1, 0.1});
  const std::string scans = bytes_of(out.path / "scans.carmen");
  fs::create_directories(out.path / "labels.csv" / "mine");
  try {
    simulate(find_scene("street"), robots + "utm30lx.toml", out.path.string(), {2, 0.1});
    FAIL("a directory was taken for a simulation's file");
  } catch (const BadInput& error) {
    CHECK(std::string(error.what()).starts_with((out.path / "labels.csv").string() + ": a directory; expected "));
  }
  CHECK(bytes_of(out.path / "scans.carmen") == scans);
}

TEST_CASE("simulate: a file that no simulation left is neither replaced nor removed") {
  for (const char* file :
       {"robot.toml", "scene.toml", "scans.carmen", "can.log", "poses.tum", "regions.gt", "labels.csv", "curbs.csv"}) {
    const TemporaryPath out("own");
    fs::create_directories(out.path);
    std::ofstream(out.path / file) << "mine\n";
    try {
      simulate(find_scene("street"), robots + "utm30lx.toml", out.path.string(), {1, 0.1});
      FAIL(file << " was taken for a simulation's");
    } catch (const BadInput& error) {
      CHECK(std::string(error.what()).starts_with((out.path / file).string() + ": "));
    }
    CHECK(bytes_of(out.path / file) == "mine\n");
    CHECK(std::distance(fs::directory_iterator(out.path), fs::directory_iterator()) == 1);
  }
}

TEST_CASE("simulate: without a duration a standing robot nods once and a driving one goes the whole way") {
  Robot robot = plain_robot();
  CHECK(Simulation(scene_of(flat), robot, 1).duration_s() == Approx(2));
  CHECK(Simulation(scene_of(flat + drive), robot, 1).duration_s() == Approx(10));
  CHECK(Simulation(find_scene("city"), robot, 1).duration_s() > 100);
}

TEST_CASE("simulate: of a path that takes most of a day no more is laid out than the duration asks for") {
  const Scene scene =
      scene_of("[[region]]\nz = 0\nrectangle = [-1, -1, 2, 1]\n[robot]\npath = [[0, 0], [80, 0]]\nspeed = 0.001\n");
  Robot robot = plain_robot();
  robot.scan_rate_hz = 1;
  const Simulation simulation(scene, robot, 1, 2);  // the path leaves the ground after half an hour
  CHECK(simulation.true_T_map_base(2 + simulated_margin_s).translation().x() == Approx(0.00225));
  CHECK(simulation.true_T_map_base(3).translation().x() == Approx(0.003));  // the last beam of a line
  CHECK_THROWS_AS(Simulation(scene, robot, 1), BadInput);
}

TEST_CASE("simulate: what cannot be written leaves nothing") {
  const TemporaryPath out("bad");
  CHECK_THROWS_AS(simulate(find_scene("street"), robots + "no_such_robot.toml", out.path.string()), BadInput);
  CHECK_FALSE(fs::exists(out.path));
  std::ofstream(out.path) << "a file";
  CHECK_THROWS_AS(simulate(find_scene("street"), robots + "utm30lx.toml", out.path.string()), BadInput);
}
