// Your robot. Every setting has its unit, range and reason in lib/curbline/settings.hpp.
#pragma once

#include "curbline/can/servo_presets.hpp"
#include "curbline/limits.hpp"
#include "curbline/settings.hpp"

/// 40 x 40 cells, 16 planes, 1081 beams: 160 KiB. The settings below follow if these are made smaller.
inline constexpr curbline::Limits limits{};

inline curbline::Settings robot_settings() {
  curbline::Settings settings;  // a Hokuyo UTM-30LX
  settings.window.rows = limits.rows;
  settings.window.cols = limits.cols;
  settings.window.origin_y_m = -0.5f * static_cast<float>(limits.cols) * settings.window.cell_y_m;
  settings.laser.beams = limits.beams;  // half of them to either side of straight ahead
  settings.laser.first_bearing_rad = -0.5f * static_cast<float>(limits.beams - 1) * settings.laser.bearing_step_rad;
  settings.tilt.T_base_tilt.z_m = 1.1f;    // the tilt axis above the ground
  settings.tilt.T_tilt_laser.z_m = 0.05f;  // the laser above the axis
  settings.pose.still = true;              // false once Port::pose() supplies poses
  return settings;
}

/// Room for the lines that wait for their tilt and pose, plus one. A line waits for the latency plus two periods of the
/// servo's frames, one of which may be lost, or for two periods of the poses. This is enough for 40 lines a second, a
/// servo of 50 Hz or more, and little latency. 4.3 KB each.
inline constexpr int queued_lines = 3;

/// A sweep there and back. For longer, a laser that sees looks beside the window in no sweep, and the angle of a tilt
/// that moves does not stay the same.
inline constexpr float nod_period_s = 4.0f;
/// For how long a bump of the way may turn a laser at a fixed tilt away from the window.
inline constexpr float longest_bump_s = 0.5f;

/// Free width that the robot needs to either side: half its own width plus its deviation from its path.
inline constexpr float half_width_m = 0.4f;

/// Where the angle lies in the servo's frames. For others, see lib/curbline/can/servo_presets.hpp, or define a Signal.
inline curbline::can::Signal tilt_signal() {
  return curbline::can::cia402_position(1);
}
