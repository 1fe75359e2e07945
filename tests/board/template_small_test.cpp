// The template's settings fit limits smaller than the template's own: the pipeline starts, its window is centred ahead,
// and the laser looks equally far to the left and right. The drive has these limits too, else it would not fit where
// the robot does.
#include <cstdio>
#include <type_traits>

#include "curbline/pipeline.hpp"
#include "drive.hpp"
#include "robot.hpp"

static_assert(std::is_same_v<curbline::Pipeline<curbline::board::limits>, curbline::Pipeline<limits>>);

int main() {
  static_assert(limits.rows == 24 && limits.beams == 361, "robot.hpp of the template, its limits replaced");
  static curbline::Pipeline<limits> pipeline;
  if (pipeline.init(robot_settings()) != curbline::Status::ok) {
    std::fprintf(stderr, "init() refuses %s\n", curbline::bad_setting(robot_settings(), limits));
    return 1;
  }
  const auto& dem = pipeline.dem();
  const float middle_m = dem.origin_y_m() + 0.5f * static_cast<float>(dem.cols()) * dem.cell_y_m();
  if (!(middle_m > -0.01f && middle_m < 0.01f)) return 2;
  const curbline::LaserSettings laser = robot_settings().laser;
  const float last_rad = laser.first_bearing_rad + static_cast<float>(laser.beams - 1) * laser.bearing_step_rad;
  return laser.first_bearing_rad < 0.0f && laser.first_bearing_rad + last_rad < 0.001f &&
                 laser.first_bearing_rad + last_rad > -0.001f
             ? 0
             : 3;
}
