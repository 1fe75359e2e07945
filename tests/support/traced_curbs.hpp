// Curbs of a small map, for tests of what they are made of and what becomes of them.
#pragma once

#include <cmath>
#include <memory>
#include <span>

#include "support/small_map.hpp"

namespace curbline::test {

/// A window with this ground, labelled, and traced from the robot's position.
template <Limits limits = small_limits, typename Height>
std::unique_ptr<Stages<limits>> traced(Height&& height_m, float robot_x_m = 0.0f, float robot_y_m = 0.0f,
                                       const Settings& settings = small_settings()) {
  auto stages = std::make_unique<Stages<limits>>(settings);
  fill(stages->dem, height_m);
  stages->settle();
  stages->trace(robot_x_m, robot_y_m);
  return stages;
}

inline double length_m(const Curb& c) {
  return std::hypot(c.x1_m - c.x0_m, c.y1_m - c.y0_m);
}

inline double total_length_m(std::span<const Curb> curbs) {
  double sum = 0.0;
  for (const Curb& c : curbs) sum += length_m(c);
  return sum;
}

/// A step up of 12 cm.
inline double up(double x, double) {
  return x < 1.4 ? 0.0 : 0.12;
}

}  // namespace curbline::test
