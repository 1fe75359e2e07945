#include "program/replay.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "formats/bad_input.hpp"
#include "formats/decimals.hpp"

namespace curbline::tools {
namespace {

constexpr std::int64_t log_ended = std::numeric_limits<std::int64_t>::max();

bool is_empty(const Map& map) {
  return std::all_of(map.cells.begin(), map.cells.end(), [](const MapCell& cell) { return cell.points == 0; });
}

}  // namespace

Replay::Replay(const Robot& robot, const DriveLogs& logs) : Replay(robot, logs, make_host_pipeline(robot)) {}

Replay::Replay(const Robot& robot, const DriveLogs& logs, std::unique_ptr<HostPipeline> pipeline)
    : robot_(robot),
      logs_(logs),
      pipeline_(std::move(pipeline)),
      tilt_(robot),
      tilt_remarks_(robot),
      left_behind_(pipeline_->grid()) {
  check_logs(robot, logs.can, logs.poses);
  if (!robot.tilt.fixed) {
    const auto bus = live_interface(logs.can);
    can_ = bus ? live_frames(*bus, robot.tilt_signal, robot.tilt_sync_id,
                             is_scanner(logs.scans) ? std::nullopt : std::optional(logs.scans))
               : log_frames(logs.can, robot.tilt_signal);
  }
  if (!robot.pose.still) poses_.emplace(logs.poses);
  std::optional<std::int64_t> log_time_ns;
  if (is_scanner(logs.scans)) {
    if (can_) {
      log_time_ns = can_->first_time_ns();
    } else if (poses_) {
      log_time_ns = poses_->first_time_ns();
    }
  }
  scans_ = open_scan_source(logs.scans, robot.laser, log_time_ns);
}

bool Replay::step(std::vector<Point>* points) {
  auto next = scans_->next();
  if (!next) {
    check_poses();
    return false;
  }
  line_ = std::move(*next);
  if (lines_ == 0) first_line_ns_ = line_.time_ns;
  const std::int64_t last_beam_ns = line_.time_ns + robot_.laser.duration_ns(line_.ranges_m.size());
  if (!scans_->of_the_future()) {
    feed_tilt(last_beam_ns +
              static_cast<std::int64_t>((robot_.tilt.latency_s + pipeline_->tilt_latency().latest_offset_s()) * 1e9f));
    feed_poses(last_beam_ns);
  }
  const std::vector<MapCurb> last_found = pipeline_->map_curbs();
  const ScanLine line{line_.time_ns, line_.ranges_m};
  const auto start = std::chrono::steady_clock::now();
  status_ = points == nullptr ? pipeline_->take(line) : pipeline_->take(line, *points);
  take_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ++lines_;
  lines_taken_ += status_ == Status::ok;
  if (status_ != Status::ok) refused_ = status_;
  left_behind_.follow(pipeline_->grid(), last_found);
  return true;
}

void Replay::feed_tilt(std::int64_t until_ns) {
  if (!can_) return;
  const auto next = [&] { return can_->next(line_.time_ns); };
  const auto take = [&](const can::Frame&, const std::optional<TiltReading>& reading) {
    if (reading) take_tilt(*reading);
  };
  if (tilt_.feed(until_ns, next, take)) return;
  if (can_->ended()) {
    tilt_.end();
  } else if (beyond_extrapolation(line_.time_ns)) {
    can_->fail_silent();
  }
}

void Replay::take_tilt(const TiltReading& reading) {
  if (++tilt_readings_ == 1) first_tilt_ = reading;
  if (pipeline_->add_tilt(reading)) tilt_remarks_.update(reading);
}

/// Whether the newest reading is too old for an extrapolation to that time.
bool Replay::beyond_extrapolation(std::int64_t time_ns) const {
  const float allowed_s = robot_.tilt.max_extrapolation_s + robot_.tilt.latency_s;
  return tilt_readings_ == 0 || time_ns > tilt_.fed_until_ns() + static_cast<std::int64_t>(allowed_s * 1e9f);
}

void Replay::feed_poses(std::int64_t until_ns) {
  while (poses_ && poses_until_ns_ < until_ns) {
    const auto pose = poses_->next();
    if (!pose) {
      poses_until_ns_ = log_ended;
      return;
    }
    if (++poses_fed_ == 1) first_pose_ns_ = pose->time_ns;
    pipeline_->add_pose(to_pose(*pose));
    poses_until_ns_ = pose->time_ns;
    robot_marker_ = {pose->x_m, pose->y_m,
                     std::atan2(2 * (pose->qw * pose->qz + pose->qx * pose->qy),
                                1 - 2 * (pose->qy * pose->qy + pose->qz * pose->qz))};
  }
}

/// A pose in the future holds back all others. If lines had no pose, the rest is therefore read too, and refused if its
/// times go back.
void Replay::check_poses() {
  while (poses_ && refused_ == Status::no_pose && poses_->next()) continue;
}

std::string Replay::remarks() const {
  Remarks remarks;
  if (can_) remarks.add(can_->remarks());
  remarks.add(scans_->remarks());
  const Counters& c = pipeline_->counters();
  remarks.say_of(logs_.can, c.tilt_dropped,
                 std::to_string(tilt_readings_) + " tilt readings were dropped; expected times that rise");
  tilt_remarks_.say(remarks, logs_.can, tilt_readings_);
  remarks.say_of(logs_.poses, c.poses_dropped,
                 std::to_string(poses_fed_) + " poses were dropped; expected times that rise");
  remarks.say_of(logs_.scans, lines_ - lines_taken_,
                 std::to_string(lines_) + " scan lines were dropped, the last for: " + to_string(refused_));
  if (c.points == 0 && c.outside > 0)
    remarks.say(logs_.scans, "none of " + std::to_string(c.outside) + " points lies in the window");
  if (c.points > 0 && is_empty(pipeline_->map()))
    remarks.say(logs_.scans,
                "the map is empty: its window has left all " + std::to_string(c.points) +
                    " points behind; expected poses in metres, and a robot that stays where it has mapped");
  if (c.points + c.outside + c.beams_without_tilt == 0 && c.no_returns > 0) {
    remarks.say(logs_.scans, "none of " + std::to_string(c.no_returns) +
                                 " beams returned; expected ranges in metres from " +
                                 shortest(robot_.laser.min_range_m) + " to " + shortest(robot_.laser.max_range_m));
  }
  say_unread(remarks, robot_, logs_);
  return remarks.text();
}

void Replay::check_complete() const {
  if (can_ && tilt_readings_ == 0) throw BadInput(logs_.can + ": " + without_readings(robot_, tilt_.counters()));
  if (lines_taken_ > 0) return;
  if (const long back = pipeline_->counters().tilt_dropped; 2 * back > tilt_readings_) {
    throw BadInput(logs_.can + ": the times do not rise: " + std::to_string(back) + " of " +
                   std::to_string(tilt_readings_) +
                   " tilt readings were dropped, and no scan line could be used; expected times that rise");
  }
  const std::string gap = status_ == Status::no_tilt
                              ? ", and tilt frames at most max_gap_s, " + shortest(robot_.tilt.max_gap_s) + " s, apart"
                              : "";
  std::string firsts = "; the first scan line is of " + seconds(first_line_ns_, 3);
  if (tilt_readings_ > 0) firsts += ", the first tilt angle of " + seconds(first_tilt_.time_ns, 3);
  if (poses_fed_ > 0) firsts += ", the first pose of " + seconds(first_pose_ns_, 3);
  throw BadInput(logs_.scans + ": no scan line could be used, the last for: " + to_string(status_) +
                 "; expected times that agree with the tilt log and the poses" + gap + firsts);
}

std::vector<MapCurb> Replay::all_curbs() const {
  std::vector<MapCurb> all = left_behind_.curbs();
  const std::vector<MapCurb> now = pipeline_->map_curbs();
  all.insert(all.end(), now.begin(), now.end());
  return all;
}

}  // namespace curbline::tools
