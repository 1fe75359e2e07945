// Where the poses of a robot that drives come from: a localisation, as they come (pose_feed.hpp), or the trajectory of
// a log, of which each scan line has the poses that `curbline replay` has fed before it. That is read whole before the
// start, as the scan lines are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "curbline/intake/line_queue.hpp"
#include "curbline/intake/source_watch.hpp"
#include "curbline/pose.hpp"
#include "pose_feed.hpp"
#include "program/host_pipeline.hpp"
#include "reports.hpp"
#include "robot/robot.hpp"

namespace curbline::daemon {

class PoseSource {
 public:
  /// `source`: a FIFO or "-"; where scan lines are those of a log a trajectory, too. Nothing of a robot that stands.
  /// stale_after_s as of SourceWatch. Throws BadInput.
  void open(const tools::Robot& robot, const std::string& source, bool of_log, float stale_after_s);

  int descriptor() const { return feed_.descriptor(); }  ///< for poll(2), POLLIN; -1 if there is nothing to wait for

  /// Gives the pipeline what has come.
  void take(tools::HostPipeline& pipeline);
  /// Of a log: gives it those up to the first that is not before a line's last beam.
  void take_until(std::int64_t last_beam_ns, tools::HostPipeline& pipeline);

  /// NewestTimes::pose_ns. Of a log all are there, whatever line comes.
  std::int64_t newest_ns() const {
    return !log_.empty() ? INT64_MAX : taken_ == 0 ? NewestTimes::none : newest_.time_ns;
  }
  /// The newest; of a robot that stands, the map's origin.
  const Pose& newest() const { return newest_; }

  SourceEvent update(std::int64_t now_ns) { return watch_.update(newest_arrival_ns_, now_ns); }
  PoseReport report() const;

 private:
  void give(const Pose& pose, tools::HostPipeline& pipeline);

  PoseFeed feed_;
  std::vector<Pose> log_;  ///< empty if they come live
  std::size_t next_in_log_ = 0;
  std::string name_;
  SourceWatch watch_;  ///< a servo or a localisation: one silence is as another
  Pose newest_{};
  std::uint64_t taken_ = 0;
  std::int64_t newest_arrival_ns_ = SourceWatch::no_reading;  ///< steady
};

}  // namespace curbline::daemon
