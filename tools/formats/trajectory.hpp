// Poses of the robot, T_map_base, in a TUM trajectory: one a line, `time tx ty tz qx qy qz qw`; seconds, metres, unit
// quaternion; # comments are skipped.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "curbline/pose.hpp"
#include "formats/line_reader.hpp"

namespace curbline::tools {

struct TrajectoryPose {
  std::int64_t time_ns = 0;
  double x_m = 0.0, y_m = 0.0, z_m = 0.0;
  double qx = 0.0, qy = 0.0, qz = 0.0, qw = 1.0;  ///< of norm 1
};

/// The pipeline's type of pose.
Pose to_pose(const TrajectoryPose& pose);

class TrajectoryReader {
 public:
  explicit TrajectoryReader(const std::string& path) : source_(path) {}

  /// The next pose; nothing at the end. Throws BadInput for a line that is truncated or contains anything but numbers,
  /// for a position beyond 1000 km, for a quaternion whose norm differs from 1 by more than 0.01 (otherwise it is
  /// normalised) or that tilts the robot by more than 90 degrees, for a time before the last one, and for a file
  /// without a pose.
  std::optional<TrajectoryPose> next();
  /// Time of the first pose, before any is taken. Throws as next() does.
  std::optional<std::int64_t> first_time_ns();

  const std::string& path() const { return source_.path(); }

 private:
  std::optional<TrajectoryPose> read();

  LineReader source_;
  std::optional<std::int64_t> last_time_ns_;
  std::optional<TrajectoryPose> first_;  ///< read and not taken yet
};

/// Parses a pose from a line of text, for live input: nothing if it is malformed, without a reason and without heap.
/// The pipeline checks whether the numbers are a valid pose.
std::optional<Pose> parse_pose(std::string_view line);

/// Writes one line: times to the nanosecond, metres to 1e-6, quaternions to 1e-9.
void write_trajectory_pose(std::ostream& out, const TrajectoryPose& pose);

}  // namespace curbline::tools
