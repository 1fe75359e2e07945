#include "robot/robot.hpp"

#include <limits>

#include "curbline/map/dem.hpp"
#include "curbline/setting_ranges.hpp"
#include "formats/bad_input.hpp"
#include "formats/can_log.hpp"
#include "formats/decimals.hpp"
#include "robot/parts.hpp"

namespace curbline::tools {
namespace {

namespace ranges = setting_ranges;

void read_mount(TomlTable table, MountSettings& mount) {
  for (const auto& [key, value] : {std::pair{"x_m", &mount.x_m}, {"y_m", &mount.y_m}, {"z_m", &mount.z_m}}) {
    table.read(key, *value, ranges::mount_m);
  }
  table.read("roll_rad", mount.roll_rad, ranges::angle_rad);
  table.read("pitch_rad", mount.pitch_rad, ranges::angle_rad);
  table.read("yaw_rad", mount.yaw_rad, ranges::angle_rad);
  table.done();
}

void read_tilt(TomlTable table, Robot& robot) {
  TiltSettings& tilt = robot.tilt;
  table.read("fixed", tilt.fixed);
  table.read("fixed_tilt_rad", tilt.fixed_tilt_rad, ranges::fixed_tilt_rad);
  if (table.has("fixed_tilt_rad") && !table.has("fixed"))
    table.refuse("fixed_tilt_rad", "is without fixed; expected fixed = true or false beside it");
  table.read("latency_s", tilt.latency_s, ranges::latency_s);
  table.read("latency_sd_s", tilt.latency_sd_s, ranges::deviation_s);
  table.read("angle_sd_rad", tilt.angle_sd_rad, ranges::deviation_rad);
  table.read("time_sd_s", tilt.time_sd_s, ranges::deviation_s);
  table.read("max_extrapolation_s", tilt.max_extrapolation_s, ranges::extrapolation_s);
  table.read("max_gap_s", tilt.max_gap_s, ranges::max_gap_s);
  table.read("roll_sd_rad", tilt.roll_sd_rad, ranges::deviation_rad);
  table.read("pitch_sd_rad", tilt.pitch_sd_rad, ranges::deviation_rad);
  read_mount(table.table("mount"), tilt.T_base_tilt);
  read_mount(table.table("laser"), tilt.T_tilt_laser);
  read_tilt_signal(table.table("signal"), robot);
  table.done();
}

void read_pose(TomlTable table, PoseSettings& pose) {
  table.read("still", pose.still);
  table.read("height_sd_m", pose.height_sd_m, ranges::deviation_m);
  table.read("attitude_sd_rad", pose.attitude_sd_rad, ranges::deviation_rad);
  table.read("lean_sd_rad", pose.lean_sd_rad, ranges::lean_sd_rad);
  table.read("max_extrapolation_s", pose.max_extrapolation_s, ranges::extrapolation_s);
  table.done();
}

void read_window(TomlTable table, WindowSettings& window) {
  for (const auto& [key, value] : {std::pair{"rows", &window.rows}, {"cols", &window.cols}}) {
    table.read_whole(key, *value, block_side, most_cells);
    if (*value % block_side != 0)
      table.refuse(key, "is " + std::to_string(*value) + "; expected a multiple of " + std::to_string(block_side));
  }
  table.read("cell_x_m", window.cell_x_m, ranges::cell_m);
  table.read("cell_y_m", window.cell_y_m, ranges::cell_m);
  constexpr Range corner{-WindowSettings::furthest_m, WindowSettings::furthest_m};
  table.read("origin_x_m", window.origin_x_m, corner);
  table.read("origin_y_m", window.origin_y_m, corner);
  table.read("fixed", window.fixed);
  table.read("max_height_m", window.max_height_m, ranges::max_height_m);
  table.done();
}

void read_sweep(TomlTable table, Sweep& sweep) {
  table.read("from_rad", sweep.from_rad, {-3.14, 3.14});
  table.read("to_rad", sweep.to_rad, {-3.14, 3.14});
  table.read("period_s", sweep.period_s, {0.01, 1000.0});
  table.done();
  if (!(sweep.from_rad < sweep.to_rad)) table.refuse("to_rad", "is not above from_rad; expected a larger angle");
}

void read_simulated(TomlTable table, SimulatedErrors& errors) {
  constexpr double most_poses_hz = 10'000.0;
  table.read("dropout", errors.dropout, {0.0, 1.0});
  table.read("beam_divergence_rad", errors.beam_divergence_rad, {0.0, 0.1});
  table.read("tilt_rate_hz", errors.tilt_rate_hz, {0.1, 10'000.0});
  table.read("tilt_latency_s", errors.tilt_latency_s, {-1.0, 1.0});
  table.read("tilt_latency_sweep_sd_s", errors.tilt_latency_sweep_sd_s, {0.0, 1.0});
  table.read("tilt_jitter_s", errors.tilt_jitter_s, {0.0, 1.0});
  table.read("pose_rate_hz", errors.pose_rate_hz, {0.1, most_poses_hz});
  table.read("pose_position_sd_m", errors.pose_position_sd_m, {0.0, 1.0});
  table.read("pose_attitude_sd_rad", errors.pose_attitude_sd_rad, {0.0, 0.1});
  table.read("pose_jump_every_s", errors.pose_jump_every_s, {0.0, 86'400.0});
  if (errors.pose_jump_every_s > 0 && errors.pose_jump_every_s < 1 / most_poses_hz)
    table.refuse("pose_jump_every_s",
                 "is below " + shortest(1 / most_poses_hz) + "; expected 0, never, or no oftener than poses may come");
  table.read("pose_jump_height_m", errors.pose_jump_height_m, {0.0, 1.0});
  table.read("pose_jump_attitude_rad", errors.pose_jump_attitude_rad, {0.0, 0.1});
  table.done();
}

}  // namespace

Robot parse_robot(const std::string& text, const std::string& name) {
  const toml::table parsed = parse_toml(text, name);
  TomlTable file(parsed, "", name);
  Robot robot;
  robot.file = name;
  file.read("name", robot.name);
  read_laser(file.table("laser"), robot);
  read_tilt(file.table("tilt"), robot);
  read_pose(file.table("pose"), robot.pose);
  read_window(file.table("window"), robot.window);
  read_sweep(file.table("sweep"), robot.sweep);
  read_simulated(file.table("simulated"), robot.simulated);
  read_tuning(file.table("tuning"), robot);
  file.done();
  constexpr int most = std::numeric_limits<int>::max();  // no limits: the host makes its pipeline as large as necessary
  if (const char* bad = bad_setting(pipeline_settings(robot), {.rows = most, .cols = most, .beams = most}))
    throw BadInput(name + ": " + bad + " is out of range; expected what lib/curbline/settings.hpp says of it");
  return robot;
}

std::string read_robot_text(const std::string& path) {
  return read_toml_text(path, "a robot file");
}

Robot read_robot(const std::string& path) {
  return parse_robot(read_robot_text(path), path);
}

void check_logs(const Robot& robot, const std::string& can, const std::string& poses) {
  if (!robot.tilt.fixed && can.empty())
    throw BadInput(robot.file + ": the laser nods and there is no tilt log; expected --can LOG, or tilt.fixed = true");
  if (!robot.pose.still && poses.empty())
    throw BadInput(robot.file +
                   ": the robot drives and there are no poses; expected --poses FILE, or pose.still = true");
}

std::string without_readings(const Robot& robot, const can::TiltDecoderCounters& counters) {
  const std::string frames = std::to_string(counters.frames) + " frames";
  if (counters.without_sync > 0) {
    return "none of " + frames + " is a tilt angle whose SYNC frame came before; expected id " +
           hexadecimal(*robot.tilt_sync_id) + " before each, as the robot's description has it";
  }
  if (counters.malformed > 0) {
    return std::to_string(counters.malformed) + " of " + frames +
           " have the tilt signal's id and none holds an angle; expected " +
           std::to_string(can::bytes_needed(robot.tilt_signal)) + " bytes or more and at most " +
           shortest(TiltReading::furthest_rad) + " rad";
  }
  return "none of " + frames + " is the tilt signal; expected " + frame_of(robot.tilt_signal) +
         " as the robot's description has it";
}

}  // namespace curbline::tools
