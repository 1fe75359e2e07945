// Poses of a moving robot, with noise that its settings state.
#pragma once

#include "curbline/settings.hpp"

namespace curbline::test {

inline PoseSettings noisy_poses() {
  PoseSettings settings;
  settings.still = false;
  settings.height_sd_m = 0.003f;
  settings.attitude_sd_rad = 0.001f;
  return settings;
}

}  // namespace curbline::test
