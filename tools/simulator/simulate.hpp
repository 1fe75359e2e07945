// Simulates a scene and a robot into a directory of recorded data with its truth:
//   scans.carmen   scan lines
//   can.log        tilt frames on interface can0; not for a fixed tilt
//   poses.tum      T_map_base; if the robot drives, or its description has poses
//   truth.json     planes, regions, curbs, obstacles (truth.hpp)
//   regions.gt     the regions' polygons, topmost first
//   scene.toml robot.toml   the inputs
// In the directory of an earlier recording, recognised by its truth.json, these files are replaced. Files that this
// recording does not have are removed, as are labels.csv and curbs.csv, because evaluate would score them. Any other
// directory that contains one of these files is refused: they belong to the user. Either everything or nothing is
// written. The same input and seed give the same bytes. About 1 s for a nod of 263 lines of 1081 beams.
#pragma once

#include "simulator/scene.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace curbline::tools {

struct SimulationOptions {
  std::uint64_t seed = 1;
  std::optional<double> duration_s;  ///< if empty: as in Simulation
};

struct SimulationSummary {
  double duration_s = 0;
  std::int64_t lines = 0, tilt_frames = 0, poses = 0;
};

/// Creates the directory if necessary. Throws BadInput if the robot's description is invalid, there is no ground below
/// the robot, or the directory cannot be written or contains such files without being a recording.
SimulationSummary simulate(const Scene& scene, const std::string& robot_file, const std::string& out_dir,
                           const SimulationOptions& options = {});

}  // namespace curbline::tools
