// The robot of the drive; see port.hpp.
#pragma once

#include "port.hpp"

inline const curbline::drive_log::Setup& drive_setup() {
  static const curbline::drive_log::Setup setup = Port(std::getenv("CURBLINE_DRIVE"), "/dev/null").setup();
  return setup;
}
inline curbline::Settings robot_settings() {
  return drive_setup().settings;
}
inline constexpr int queued_lines = 3;
inline constexpr float nod_period_s = 4.0f, longest_bump_s = 0.5f;
inline constexpr float half_width_m = 0.5f;
inline curbline::can::Signal tilt_signal() {
  return drive_setup().tilt_signal;
}
