// Your robot. Every setting has its unit, range and reason in lib/curbline/settings.hpp.
#pragma once

#include "curbline/can/servo_presets.hpp"
#include "curbline/limits.hpp"
#include "curbline/settings.hpp"

/// 40 x 40 cells, 16 planes, 1081 beams: 160 KiB. What is smaller here is smaller in the settings.
inline constexpr curbline::Limits limits{};

inline curbline::Settings robot_settings() {
  curbline::Settings settings;  // a Hokuyo UTM-30LX
  settings.window.rows = limits.rows;
  settings.window.cols = limits.cols;
  settings.window.origin_y_m = -0.5f * static_cast<float>(limits.cols) * settings.window.cell_y_m;
  settings.laser.beams = limits.beams;  // as many to either side of straight ahead
  settings.laser.first_bearing_rad = -0.5f * static_cast<float>(limits.beams - 1) * settings.laser.bearing_step_rad;
  settings.tilt.T_base_tilt.z_m = 1.1f;    // the tilt axis above the ground
  settings.tilt.T_tilt_laser.z_m = 0.05f;  // the laser above the axis
  settings.pose.still = true;              // false once Port::pose() has something to give
  return settings;
}

/// Lines that wait for their tilt and pose, and one more: those of (latency + two periods of the servo's frames), one
/// of which may be lost, or of two periods of poses. Here of 40 lines a second, a servo of 50 Hz or more, and little
/// latency. 4.3 KB each.
inline constexpr int queued_lines = 3;

/// What it needs of the way to either side: half its width, and what it strays.
inline constexpr float half_width_m = 0.4f;

/// Where the angle lies in the servo's frames. Others: lib/curbline/can/servo_presets.hpp, or a Signal of your own.
inline curbline::can::Signal tilt_signal() {
  return curbline::can::cia402_position(1);
}
