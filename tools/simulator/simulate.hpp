// A scene and a robot to a directory of recorded data with its truth:
//   scans.carmen   scan lines
//   can.log        tilt frames on interface can0; not for a fixed tilt
//   poses.tum      T_map_base; if the robot drives, or its description says that poses come
//   truth.json     planes, regions, curbs, obstacles (truth.hpp)
//   regions.gt     the regions' polygons, the topmost first
//   scene.toml robot.toml   what it was made from
// In the directory of an earlier recording, which its truth.json tells, these are replaced; what this one has not is
// removed, and labels.csv and curbs.csv too: evaluate would score them. Any other directory that has one of these files
// is refused: they are somebody's own.
// All or nothing is written. The same input and seed give the same bytes. About 1 s for a nod of 263 lines of 1081
// beams.
#pragma once

#include "simulator/scene.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace curbline::tools {

struct SimulationOptions {
  std::uint64_t seed = 1;
  std::optional<double> duration_s;  ///< without: as Simulation has it
};

struct SimulationSummary {
  double duration_s = 0;
  std::int64_t lines = 0, tilt_frames = 0, poses = 0;
};

/// Makes the directory if it is not there. Throws BadInput if the robot's description is bad, the robot stands on
/// nothing, or the directory cannot be written or has such files that no recording left there.
SimulationSummary simulate(const Scene& scene, const std::string& robot_file, const std::string& out_dir,
                           const SimulationOptions& options = {});

}  // namespace curbline::tools
