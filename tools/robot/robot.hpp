// The description of a robot, as read from its TOML file (tools/robots): everything that simulate, replay and the
// daemon need to know about the machine.
#pragma once

#include "curbline/can/servo_presets.hpp"
#include "curbline/can/signal.hpp"
#include "curbline/can/tilt_decoder.hpp"
#include "curbline/settings.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace curbline::tools {

/// The most that the host programs support: beams, and cells along one side of a window.
inline constexpr int most_beams = 2881, most_cells = 512;

/// Properties of the robot's sensors that only the simulator needs.
struct SimulatedErrors {
  double dropout = 0.0;                  ///< share of returns that are lost
  double beam_divergence_rad = 0.0;      ///< full angle; a beam across an edge gives a mixed pixel
  double tilt_rate_hz = 40.0;            ///< tilt frames a second
  double tilt_latency_s = 0.0;           ///< in addition to TiltSettings::latency_s, which the robot knows
  double tilt_latency_sweep_sd_s = 0.0;  ///< standard deviation of each sweep's difference from it
  double tilt_jitter_s = 0.0;            ///< standard deviation of a frame's time stamp
  double pose_rate_hz = 20.0;
  double pose_position_sd_m = 0.0;
  double pose_attitude_sd_rad = 0.0;
  double pose_jump_every_s = 0.0;  ///< interval of jumps by which the localisation corrects itself; 0: never
  double pose_jump_height_m = 0.0;
  double pose_jump_attitude_rad = 0.0;  ///< in roll and in pitch
};

/// How the servo nods, for the simulator; for the daemon, how long the laser may look beside the window.
struct Sweep {
  double from_rad = -0.2, to_rad = 1.1;  ///< tilt > 0 looks down
  double period_s = 6.0;                 ///< there and back
};

struct Robot {
  std::string file;  ///< where it was read from, for messages
  std::string name = "robot";
  std::string laser_model = "utm-30lx";  ///< utm-30lx, lms-151, lms-200: presets of `laser` (and of scan_rate_hz)
  double scan_rate_hz = 40.0;
  LaserSettings laser{};
  TiltSettings tilt{};
  PoseSettings pose{};
  WindowSettings window{};
  SegmentationSettings segmentation{};
  PlaneSettings planes{};
  LabelSettings labels{};
  CurbSettings curbs{};
  can::Signal tilt_signal = can::cia402_position(1);
  std::optional<std::uint16_t> tilt_sync_id{};  ///< angles are sampled on this frame (curbline/can/tilt_decoder.hpp)
  Sweep sweep{};
  SimulatedErrors simulated{};
};

/// Reads a TOML file. Throws BadInput naming file, line and key: unknown key, wrong type, value out of range. Keys have
/// the names of the fields, units included; all have a default. tools/robots/README.md lists them.
Robot read_robot(const std::string& path);
/// Its two halves. `file` is the text's name in messages.
std::string read_robot_text(const std::string& path);
Robot parse_robot(const std::string& text, const std::string& file);

/// Throws BadInput if the robot needs a log whose name is empty: `can` of the tilt, or `poses`.
void check_logs(const Robot& robot, const std::string& can, const std::string& poses);

/// Why a CAN log gave no tilt readings at all, for the user.
std::string without_readings(const Robot& robot, const can::TiltDecoderCounters& counters);

/// The settings for Pipeline::init().
inline Settings pipeline_settings(const Robot& robot) {
  return {robot.window,       robot.laser,  robot.tilt,   robot.pose,
          robot.segmentation, robot.planes, robot.labels, robot.curbs};
}

}  // namespace curbline::tools
