// Poses of a log, T_map_base, for a robot that drives through it: each scan line has those that `curbline replay` has
// fed before it. Read whole before the start, as the scan lines are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "curbline/pose.hpp"
#include "formats/trajectory.hpp"

namespace curbline::daemon {

class PoseLog {
 public:
  /// Throws BadInput for what is wrong with the trajectory.
  explicit PoseLog(const std::string& path) {
    tools::TrajectoryReader log(path);
    while (const auto pose = log.next()) poses_.push_back(tools::to_pose(*pose));
  }

  /// The next, as long as none that was given reaches to a time.
  std::optional<Pose> next(std::int64_t until_ns) {
    if (next_ == poses_.size() || (next_ > 0 && poses_[next_ - 1].time_ns >= until_ns)) return std::nullopt;
    return poses_[next_++];
  }

 private:
  std::vector<Pose> poses_;
  std::size_t next_ = 0;
};

}  // namespace curbline::daemon
