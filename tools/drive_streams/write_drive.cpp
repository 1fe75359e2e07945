#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include "curbline/intake/rising_times.hpp"
#include "drive_log/drive_log.hpp"
#include "drive_streams/drive_streams.hpp"
#include "formats/atomic_file.hpp"
#include "formats/bad_input.hpp"
#include "formats/can_log.hpp"
#include "formats/laser_log.hpp"
#include "formats/trajectory.hpp"
#include "robot/robot.hpp"
#include "streams/log_remarks.hpp"
#include "streams/tilt_feed.hpp"

namespace curbline::tools {
namespace {

using drive_log::RecordHeader;
using drive_log::RecordKind;

constexpr std::int64_t log_ended = std::numeric_limits<std::int64_t>::max();
/// The board estimates the servo's latency during the drive; readings are sent far enough ahead for this many standard
/// deviations beyond the configured latency.
constexpr float latency_bound = 4.0f;

/// Padding and the storage of an empty optional are part of the stream: zeroed, so that the same logs give the same
/// bytes. Compilers without this builtin leave it as it is; nobody reads it.
template <typename T>
void clear_padding(T& value) {
#if __has_builtin(__builtin_clear_padding)
  __builtin_clear_padding(&value);
#else
  static_cast<void>(value);
#endif
}
template <typename T>
void clear_room(std::optional<T>& value) {
  if (!value) std::memset(static_cast<void*>(&value), 0, sizeof value);
}

/// Counts times that do not rise: the pipeline of a board will drop what bears them.
class Order {
 public:
  bool take(std::int64_t time_ns, bool of_the_future = false) {
    ++all_;
    const bool rises = !of_the_future && times_.admits(time_ns);
    if (rises) times_.take(time_ns);
    refused_ += !rises;
    return rises;
  }
  long all() const { return all_; }
  void say(Remarks& remarks, const std::string& log, const std::string& what) const {
    remarks.say_of(log, refused_, std::to_string(all_) + " " + what + " are out of order; expected times that rise");
  }

 private:
  RisingTimes times_;
  long all_ = 0, refused_ = 0;
};

class DriveWriter {
 public:
  explicit DriveWriter(const DriveFiles& files)
      : logs_(files.logs),
        robot_(read_robot(files.robot)),
        scans_(logs_.scans, robot_.laser),
        out_(files.out),
        tilt_(robot_),
        tilt_remarks_(robot_) {
    if (!logs_.poses.empty()) robot_.pose.still = false;
    check_logs(robot_, logs_.can, logs_.poses);
    if (!robot_.tilt.fixed) can_.emplace(logs_.can);
    if (!robot_.pose.still) poses_.emplace(logs_.poses);
  }

  void write() {
    drive_log::Setup setup{pipeline_settings(robot_), robot_.tilt_signal, robot_.tilt_sync_id};
    clear_room(setup.settings.labels.max_messages);
    clear_room(setup.tilt_signal.multiplexor);
    clear_room(setup.tilt_sync_id);
    put(RecordKind::setup, setup);
    while (const auto line = scans_.next()) {
      const std::int64_t last_beam_ns = line->time_ns + robot_.laser.duration_ns(line->ranges_m.size());
      const bool of_the_future = scans_.of_the_future();
      line_order_.take(line->time_ns, of_the_future);
      if (!of_the_future) {
        put_frames(last_beam_ns + static_cast<std::int64_t>(
                                      (robot_.tilt.latency_s + latency_bound * robot_.tilt.latency_sd_s) * 1e9f));
        put_poses(last_beam_ns);
      }
      put_line(*line);
    }
    if (can_ && tilt_.counters().readings == 0)
      throw BadInput(can_->path() + ": " + without_readings(robot_, tilt_.counters()));
    out_.commit();
  }
  std::string remarks() const {
    Remarks remarks;
    if (can_) say_lost_frames(remarks, *can_);
    remarks.add(scans_.remarks());
    tilt_order_.say(remarks, logs_.can, "tilt readings");
    tilt_remarks_.say(remarks, logs_.can, tilt_order_.all());
    line_order_.say(remarks, logs_.scans, "scan lines");
    say_unread(remarks, robot_, logs_);
    return remarks.text();
  }

 private:
  void put_bytes(std::span<const std::byte> bytes) {
    out_.stream().write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  template <typename T>
  void put_value(T value) {
    clear_padding(value);
    put_bytes(std::as_bytes(std::span(&value, 1)));
  }
  template <typename T>
  void put(RecordKind kind, const T& value) {
    put_value(RecordHeader{kind, sizeof value});
    put_value(value);
  }

  void put_frames(std::int64_t until_ns) {
    if (!can_) return;
    const auto next = [&] {
      const auto frame = can_->next();
      if (frame) interface_.check(*can_, robot_.tilt_signal, *frame);
      return frame;
    };
    const auto take = [&](const can::Frame& frame, const std::optional<TiltReading>& reading) {
      if (reading && tilt_order_.take(reading->time_ns)) tilt_remarks_.update(*reading);
      put(RecordKind::can_frame, frame);
    };
    if (!tilt_.feed(until_ns, next, take)) tilt_.end();
  }

  void put_poses(std::int64_t until_ns) {
    while (poses_ && poses_until_ns_ < until_ns) {
      const auto pose = poses_->next();
      poses_until_ns_ = pose ? pose->time_ns : log_ended;
      if (!pose) return;
      put(RecordKind::pose, to_pose(*pose));
    }
  }

  void put_line(const CarmenLine& line) {
    const drive_log::ScanLineHead head{line.time_ns};
    const auto ranges = std::as_bytes(std::span(line.ranges_m));
    put_value(RecordHeader{RecordKind::scan_line, static_cast<std::uint32_t>(sizeof head + ranges.size())});
    put_value(head);
    put_bytes(ranges);
  }

  DriveLogs logs_;
  Robot robot_;
  LaserLog scans_;
  std::optional<CanLogReader> can_;
  OneInterface interface_;
  std::optional<TrajectoryReader> poses_;
  AtomicFile out_;
  TiltFeed tilt_;
  Order tilt_order_, line_order_;
  TiltRemarks tilt_remarks_;
  std::int64_t poses_until_ns_ = INT64_MIN;  ///< newest written
};

}  // namespace

std::string write_drive(const DriveFiles& files) {
  DriveWriter writer(files);
  writer.write();
  return writer.remarks();
}

}  // namespace curbline::tools
