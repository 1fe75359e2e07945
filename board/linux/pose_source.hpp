// Source of the poses of a moving robot: a localisation, as they arrive (pose_feed.hpp), or the trajectory of a log,
// from which each scan line gets the poses that `curbline replay` has fed before it. The trajectory, like the scan
// lines of a log, is read whole before the start.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "curbline/intake/line_queue.hpp"
#include "curbline/intake/source_watch.hpp"
#include "curbline/pose.hpp"
#include "pose_feed.hpp"
#include "reports.hpp"
#include "robot/robot.hpp"
#include "streams/host_pipeline.hpp"

namespace curbline::daemon {

class PoseSource {
 public:
  /// `source`: a FIFO or "-"; if the scan lines come from a log, also a trajectory. Does nothing for a stationary
  /// robot. stale_after_s as in SourceWatch. Throws BadInput.
  void open(const tools::Robot& robot, const std::string& source, bool of_log, float stale_after_s);

  int descriptor() const { return feed_.descriptor(); }  ///< for poll(2), POLLIN; -1 if there is nothing to wait for

  /// Passes the poses that have arrived to the pipeline.
  void take(tools::HostPipeline& pipeline);
  /// For a log: passes the poses up to the first that is not earlier than a line's last beam.
  void take_until(std::int64_t last_beam_ns, tools::HostPipeline& pipeline);

  /// NewestTimes::pose_ns. A log is complete, whatever line comes.
  std::int64_t newest_ns() const {
    return !log_.empty() ? INT64_MAX : taken_ == 0 ? NewestTimes::none : newest_.time_ns;
  }
  /// The newest; for a stationary robot, the map's origin.
  const Pose& newest() const { return newest_; }

  SourceEvent update(std::int64_t now_ns) { return watch_.update(newest_arrival_ns_, now_ns); }
  PoseReport report() const;

 private:
  void give(const Pose& pose, tools::HostPipeline& pipeline);

  PoseFeed feed_;
  std::vector<Pose> log_;  ///< empty if the poses come live
  std::size_t next_in_log_ = 0;
  std::string name_;
  SourceWatch watch_;  ///< used for the localisation as for the servo
  Pose newest_{};
  std::uint64_t taken_ = 0;
  std::int64_t newest_arrival_ns_ = SourceWatch::no_reading;  ///< steady clock
};

}  // namespace curbline::daemon
