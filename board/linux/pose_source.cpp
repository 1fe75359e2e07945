#include "pose_source.hpp"

#include <filesystem>

#include "formats/bad_input.hpp"
#include "formats/trajectory.hpp"
#include "scanner/live_scanner.hpp"

namespace curbline::daemon {
namespace {

using tools::BadInput;

constexpr int most_poses = 256;  ///< more than the feed holds; then other work gets its turn

bool is_fifo(const std::string& path) {
  std::error_code none;
  return std::filesystem::is_fifo(path, none);
}

std::vector<Pose> read_log(const std::string& path) {
  std::vector<Pose> poses;
  tools::TrajectoryReader log(path);
  while (const auto pose = log.next()) poses.push_back(tools::to_pose(*pose));
  return poses;
}

}  // namespace

void PoseSource::open(const tools::Robot& robot, const std::string& source, bool of_log, float stale_after_s) {
  const bool live = source == "-" || is_fifo(source);
  watch_.init(stale_after_s, robot.pose.still || !live);  // a log is complete, whatever line comes
  if (robot.pose.still) return;
  if (source.empty()) {
    throw BadInput(robot.file + ": the robot drives; expected --poses, or pose.still = true");
  }
  name_ = source == "-" ? "standard input" : source;
  if (live) return feed_.open(source);
  if (!of_log) throw BadInput(source + ": no FIFO; expected one, or -, beside a live scanner");
  log_ = read_log(source);
}

void PoseSource::take(tools::HostPipeline& pipeline) {
  for (int k = 0; k < most_poses; ++k) {
    const auto pose = feed_.next();
    if (!pose) return;
    give(*pose, pipeline);
  }
}

void PoseSource::take_until(std::int64_t last_beam_ns, tools::HostPipeline& pipeline) {
  const auto reached = [&] { return next_in_log_ > 0 && log_[next_in_log_ - 1].time_ns >= last_beam_ns; };
  while (next_in_log_ < log_.size() && !reached()) give(log_[next_in_log_++], pipeline);
}

void PoseSource::give(const Pose& pose, tools::HostPipeline& pipeline) {
  if (!pipeline.add_pose(pose)) return;
  newest_ = pose;
  ++taken_;
  newest_arrival_ns_ = scanner::steady_now_ns();
}

PoseReport PoseSource::report() const {
  return name_.empty() ? PoseReport{} : PoseReport{&watch_, name_, taken_, feed_.damaged()};
}

}  // namespace curbline::daemon
