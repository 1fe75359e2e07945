// Runs logs through the pipeline as on the robot: tilt frames, poses and scan lines in the order in which its computer
// would receive them. A scan line is taken when the tilt readings and poses cover its last beam, or the logs have
// ended.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/trajectory.hpp"
#include "map/left_behind.hpp"
#include "program/scan_source.hpp"
#include "program/tilt_frames.hpp"
#include "robot/robot.hpp"
#include "streams/host_pipeline.hpp"
#include "streams/log_remarks.hpp"
#include "streams/tilt_feed.hpp"

namespace curbline::tools {

class Replay {
 public:
  /// Opens the logs. Throws BadInput if a log that the robot needs is missing.
  Replay(const Robot& robot, const DriveLogs& logs);
  /// Continues with a pipeline that has taken other logs before.
  Replay(const Robot& robot, const DriveLogs& logs, std::unique_ptr<HostPipeline> pipeline);
  std::unique_ptr<HostPipeline> take_pipeline() { return std::move(pipeline_); }

  /// Takes the next scan line; false at the end. Throws BadInput for errors in a log. The line's points are appended to
  /// `points`, for the methods that take a whole cloud.
  bool step(std::vector<Point>* points = nullptr);

  /// At the end of a log without a single usable reading: throws BadInput with the reason.
  void check_complete() const;

  /// Remarks for the user, at the end, about what was lost or dropped, one a line; empty if there are none.
  std::string remarks() const;

  const HostPipeline& pipeline() const { return *pipeline_; }
  RobotMarker robot() const { return robot_marker_; }  ///< at the newest pose; at the origin if it stands
  const CarmenLine& line() const { return line_; }     ///< the line that step() took
  Status status() const { return status_; }            ///< the pipeline's status for it
  double take_s() const { return take_s_; }            ///< time in the pipeline, by the clock
  long tilt_readings() const { return tilt_readings_; }
  can::TiltDecoderCounters can_counters() const { return tilt_.counters(); }

  /// Curbs of the whole path: those in the window now, and the latest state of the parts that it has left.
  std::vector<MapCurb> all_curbs() const;

 private:
  void feed_tilt(std::int64_t until_ns);
  void take_tilt(const TiltReading& reading);
  bool beyond_extrapolation(std::int64_t time_ns) const;
  void feed_poses(std::int64_t until_ns);
  void check_poses();

  Robot robot_;
  DriveLogs logs_;
  std::unique_ptr<HostPipeline> pipeline_;
  std::unique_ptr<ScanSource> scans_;
  std::unique_ptr<TiltFrames> can_;  ///< none for a fixed tilt
  TiltFeed tilt_;
  std::optional<TrajectoryReader> poses_;
  CarmenLine line_;
  RobotMarker robot_marker_;
  Status status_ = Status::ok, refused_ = Status::ok;  ///< of the newest line; of the last line that was refused
  double take_s_ = 0;
  std::int64_t poses_until_ns_ = INT64_MIN;  ///< newest fed; INT64_MAX at the log's end
  long tilt_readings_ = 0, poses_fed_ = 0, lines_ = 0, lines_taken_ = 0;
  TiltReading first_tilt_{};
  TiltRemarks tilt_remarks_;
  std::int64_t first_line_ns_ = 0, first_pose_ns_ = 0;
  LeftBehind left_behind_;
};

}  // namespace curbline::tools
