#include "curbline/replay.hpp"

#include <algorithm>
#include <limits>

#include "can/signal.hpp"
#include "formats/bad_input.hpp"

namespace curbline::tools {
namespace {

constexpr std::int64_t log_ended = std::numeric_limits<std::int64_t>::max();

bool holds(const Grid& grid, const MapCurb& curb) {
  const double x = 0.5 * (curb.x0_m + curb.x1_m), y = 0.5 * (curb.y0_m + curb.y1_m);
  return x >= grid.x0_m && y >= grid.y0_m && x < grid.x0_m + grid.rows * grid.dx_m && y < grid.y0_m + grid.cols * grid.dy_m;
}

}  // namespace

Replay::Replay(const Robot& robot, const ReplayLogs& logs)
    : robot_(robot), logs_(logs), pipeline_(make_host_pipeline(pipeline_settings(robot))), scans_(logs.scans) {
  if (!robot.tilt.fixed && logs.can.empty()) {
    throw BadInput("no tilt log for a laser that nods; expected --can LOG, or tilt.fixed = true in the robot's description");
  }
  if (!robot.pose.still && logs.poses.empty()) {
    throw BadInput("no poses for a robot that drives; expected --poses FILE, or pose.still = true in the robot's description");
  }
  if (!robot.tilt.fixed) can_.emplace(logs.can);
  if (!robot.pose.still) poses_.emplace(logs.poses);
  grid_before_ = pipeline_->grid();
}

bool Replay::step(std::vector<Point3>* cloud) {
  auto next = scans_.next();
  if (!next) return false;
  check_geometry(*next, robot_.laser, scans_.path(), scans_.line());
  line_ = std::move(*next);
  const auto last_beam_ns =
      line_.time_ns + static_cast<std::int64_t>(robot_.laser.beam_interval_s * 1e9f * static_cast<float>(line_.ranges_m.size()));
  feed_tilt(last_beam_ns + static_cast<std::int64_t>(robot_.tilt.latency_s * 1e9f));
  feed_poses(last_beam_ns);
  curbs_before_.clear();
  for (const Curb& curb : pipeline_->curbs()) curbs_before_.push_back(to_map_curb(curb));
  const ScanLine line{line_.time_ns, line_.ranges_m};
  status_ = cloud == nullptr ? pipeline_->take(line) : pipeline_->project(line, *cloud);
  lines_taken_ += status_ == Status::ok;
  keep_leaving_curbs();
  return true;
}

/// Frames up to the first reading at or after a time.
void Replay::feed_tilt(std::int64_t until_ns) {
  while (can_ && tilt_until_ns_ < until_ns) {
    const auto frame = can_->next();
    if (!frame) {
      tilt_until_ns_ = log_ended;
      return;
    }
    ++frames_;
    if (const auto angle = can::decode(robot_.tilt_signal, *frame)) {
      ++tilt_readings_;
      pipeline_->add_tilt({frame->time_ns, static_cast<float>(*angle)});
      tilt_until_ns_ = frame->time_ns;
    }
  }
}

void Replay::feed_poses(std::int64_t until_ns) {
  while (poses_ && poses_until_ns_ < until_ns) {
    const auto pose = poses_->next();
    if (!pose) {
      poses_until_ns_ = log_ended;
      return;
    }
    const auto f = [](double value) { return static_cast<float>(value); };
    pipeline_->add_pose({pose->time_ns, f(pose->x_m), f(pose->y_m), f(pose->z_m), f(pose->qx), f(pose->qy), f(pose->qz), f(pose->qw)});
    poses_until_ns_ = pose->time_ns;
  }
}

void Replay::keep_leaving_curbs() {
  const Grid grid = pipeline_->grid();
  if (grid.x0_m == grid_before_.x0_m && grid.y0_m == grid_before_.y0_m) return;
  std::copy_if(curbs_before_.begin(), curbs_before_.end(), std::back_inserter(left_behind_),
               [&](const MapCurb& curb) { return !holds(grid, curb); });
  grid_before_ = grid;
}

void Replay::check_complete() const {
  if (can_ && tilt_readings_ == 0) {
    throw BadInput(logs_.can + ": none of " + std::to_string(frames_) + " frames is the tilt signal; expected id " +
                   std::to_string(robot_.tilt_signal.id) + " as the robot's description has it");
  }
  if (lines_taken_ == 0) {
    throw BadInput(logs_.scans + ": no scan line could be used, the last for: " + to_string(status_) +
                   "; expected times that agree with the tilt log and the poses");
  }
}

std::vector<MapCurb> Replay::all_curbs() const {
  std::vector<MapCurb> all = left_behind_;
  for (const Curb& curb : pipeline_->curbs()) all.push_back(to_map_curb(curb));
  return all;
}

}  // namespace curbline::tools
