// Your robot. Every setting has its unit, range and reason in lib/curbline/settings.hpp.
#pragma once

#include "can/servo_presets.hpp"
#include "curbline/limits.hpp"
#include "curbline/settings.hpp"

/// 40 x 40 cells, 16 planes, 1081 beams: 160 KiB. What is smaller here is smaller in the settings.
inline constexpr curbline::Limits limits{};

inline curbline::Settings robot_settings() {
  curbline::Settings settings;  // a Hokuyo UTM-30LX
  settings.window.rows = limits.rows;
  settings.window.cols = limits.cols;
  settings.window.origin_y_m = -0.5f * static_cast<float>(limits.cols) * settings.window.cell_y_m;
  settings.laser.beams = limits.beams;
  settings.tilt.T_base_tilt.z_m = 1.1f;    // the tilt axis above the ground
  settings.tilt.T_tilt_laser.z_m = 0.05f;  // the laser above the axis
  settings.pose.still = true;              // false once Port::pose() has something to give
  return settings;
}

/// What it needs of the way to either side: half its width, and what it strays.
inline constexpr float half_width_m = 0.4f;

/// Where the angle lies in the servo's frames. Others: lib/can/servo_presets.hpp, or a Signal of your own.
inline curbline::can::Signal tilt_signal() {
  return curbline::can::cia402_position(1);
}
