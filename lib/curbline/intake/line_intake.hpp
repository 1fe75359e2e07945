// From a scan line to its points in the map. Owns everything that decides where they lie: tilt and poses over time, the
// tilt's latency, the correction of poses. It does not own the map, but marks there where a sweep begins and where
// poses jump, and corrects heights that were mapped with a wrong latency. A line is placed first, then the window
// follows the robot, then the line is projected. Cost: about 170 operations a beam, 120 outside the window
// (line_projection.hpp), and those of tilt_latency.hpp and pose_offset.hpp.
#pragma once

#include <cstdint>

#include "curbline/counters.hpp"
#include "curbline/frames.hpp"
#include "curbline/intake/line_projection.hpp"
#include "curbline/intake/map_comparison.hpp"
#include "curbline/intake/pose_offset.hpp"
#include "curbline/intake/pose_track.hpp"
#include "curbline/intake/rising_times.hpp"
#include "curbline/intake/tilt_latency.hpp"
#include "curbline/intake/tilt_snapshot.hpp"
#include "curbline/intake/tilt_track.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/pose.hpp"
#include "curbline/scan_line.hpp"
#include "curbline/settings.hpp"
#include "curbline/status.hpp"
#include "curbline/tilt_reading.hpp"

namespace curbline {

template <Limits limits>
class LineIntake {
 public:
  /// Working memory of one line: its tilt and motion, set by place(), and its points, by project().
  struct Work {
    TiltSnapshot<limits> tilt;
    LineMotion motion;
    ProjectedLine<limits> projected;
  };

  /// Call while nothing calls add_tilt(), from an interrupt or another thread. Settings are valid.
  [[gnu::cold]] void init(const Settings& settings);

  /// A reading of the tilt servo; false if dropped. Wait-free: TiltTrack::push().
  bool add_tilt(const TiltReading& reading) { return tilt_track_.push(reading); }
  /// A pose of the base in the map frame; false if dropped: PoseTrack::push().
  bool add_pose(const Pose& pose) { return pose_track_.push(pose); }
  /// Readings that add_tilt() has dropped.
  std::uint32_t tilt_dropped() const { return tilt_track_.dropped(); }

  /// Refuses a bad line before it changes anything; else finds its tilt and motion.
  Status place(const ScanLine& line, Dem<limits>& dem, Work& work);

  /// Projects a line that has been placed, within the map's window, and compares it with ground mapped before, to find
  /// whose a jump of the poses was and how late the tilt is; a correction of the latency moves the map. False if the
  /// line was measured while poses jumped or the robot climbed, and lies off the map: it would form a ridge as high as
  /// the jump. Where there is no map to compare with, doubtful points are left out.
  bool project(const ScanLine& line, const MapComparison<limits>& map, Dem<limits>& dem, Work& work,
               Counters& counters);

  const Transform& T_base_tilt() const { return line_projection_.T_base_tilt(); }
  const TiltLatency& tilt_latency() const { return tilt_latency_; }
  const PoseOffset& pose_offset() const { return pose_offset_; }

 private:
  /// Time to cross a curb, with wheels half a metre apart, at 0.25 m/s. Poses that jump for longer are something else:
  /// lines are taken where they put them, or there would never be a map to compare with.
  static constexpr std::int64_t longest_climb_ns = 2'000'000'000;

  bool follow_tilt(std::int64_t first_ns, std::int64_t last_ns, Dem<limits>& dem, TiltSnapshot<limits>& tilt);
  void follow_poses(std::int64_t line_ns, const Pose& pose, bool jumping, Dem<limits>& dem);
  void lean(const TiltLatency::Correction& by, Dem<limits>& dem, ProjectedLine<limits>& line);
  /// Does the robot climb, with a localisation that may step meanwhile?
  bool climbs() const { return pose_track_.climbs() && pose_offset_.localisation_steps(); }

  float tilt_rate_rad_s_ = 0.0f;     ///< of the current line
  bool jumped_ = false;              ///< poses jumped during the last line ...
  std::int64_t jumps_since_ns_ = 0;  ///< ... since when all lines saw jumps or a climb
  RisingTimes line_times_{};
  TiltTrack<limits> tilt_track_{};
  TiltLatency tilt_latency_{};
  PoseTrack<limits> pose_track_{};
  PoseOffset pose_offset_{};
  LineProjection<limits> line_projection_{};
};

template <Limits limits>
void LineIntake<limits>::init(const Settings& settings) {
  jumped_ = false;
  jumps_since_ns_ = 0;
  line_times_ = RisingTimes{};
  tilt_track_.init(settings.tilt);
  tilt_latency_.init(settings.tilt, settings.pose);
  pose_track_.init(settings.pose);
  pose_offset_.init(settings.pose);
  line_projection_.init(settings);
}

template <Limits limits>
Status LineIntake<limits>::place(const ScanLine& line, Dem<limits>& dem, Work& work) {
  const LaserSettings& laser = line_projection_.laser();
  const bool still = line_projection_.pose().still;
  if (line.ranges_m.size() > static_cast<std::size_t>(laser.beams)) return Status::line_too_long;
  if (!line_times_.admits(line.time_ns)) return Status::line_out_of_order;
  const std::int64_t last_beam_ns = line.time_ns + laser.duration_ns(line.ranges_m.size());
  Pose first, last;
  if (!still && !(pose_track_.at(line.time_ns, first) && pose_track_.at(last_beam_ns, last))) return Status::no_pose;
  if (!line_projection_.tilt().fixed && !follow_tilt(line.time_ns, last_beam_ns, dem, work.tilt))
    return Status::no_tilt;
  line_times_.take(line.time_ns);
  if (still) return Status::ok;
  const PoseJumps jumps = pose_track_.jumps(line.time_ns, last_beam_ns);
  follow_poses(line.time_ns, first, jumps.any(), dem);
  work.motion = {make_transform(pose_offset_.corrected(first)), make_transform(pose_offset_.corrected(last)), false,
                 jumps};
  return Status::ok;
}

/// False if the line has no angles.
template <Limits limits>
bool LineIntake<limits>::follow_tilt(std::int64_t first_ns, std::int64_t last_ns, Dem<limits>& dem,
                                     TiltSnapshot<limits>& tilt) {
  tilt_track_.snapshot(tilt, tilt_latency_.offset_s(), last_ns);
  const TiltAngle first = tilt.at(first_ns);
  const std::uint32_t reading = tilt.reading_number();
  const TiltAngle last = tilt.at(last_ns);
  tilt.rewind();
  if (first.source == TiltAngle::Source::none && last.source == TiltAngle::Source::none) return false;
  const TiltAngle& any = first.source == TiltAngle::Source::none ? last : first;
  tilt_rate_rad_s_ = any.rate_rad_s;
  const TiltLatency::Turn turn = tilt_latency_.begin_line(any.angle_rad, any.rate_rad_s, reading);
  if (turn == TiltLatency::Turn::new_sweep) dem.begin_sweep();
  if (turn != TiltLatency::Turn::none) tilt_track_.snapshot(tilt, tilt_latency_.offset_s(), last_ns);
  return true;
}

/// Follows the poses up to a line. Ground seen while poses jump, or later, does not count as mapped before the jump;
/// nor, while the robot climbs, does that seen between jumps. All jumps of a climb may lie between two lines.
template <Limits limits>
void LineIntake<limits>::follow_poses(std::int64_t line_ns, const Pose& pose, bool jumping, Dem<limits>& dem) {
  pose_offset_.begin_line(pose.x_m, pose.y_m);
  const bool climbed = climbs();
  bool begun = false;
  while (const auto step = pose_track_.next_step(line_ns)) {
    pose_offset_.follow(*step);
    const bool new_climb = climbs() && !climbed;
    begun = step->kind == PoseStepNews::Kind::begun || (begun && (new_climb || pose_offset_.undecided()));
  }
  if (!jumped_ && !(climbed && climbs())) {
    if (jumping || begun) dem.begin_marking();
    if (jumping || climbs()) jumps_since_ns_ = line_ns;
  }
  jumped_ = jumping;
}

template <Limits limits>
bool LineIntake<limits>::project(const ScanLine& line, const MapComparison<limits>& map, Dem<limits>& dem, Work& work,
                                 Counters& counters) {
  const LineMotion& motion = work.motion;
  line_projection_.project(line, work.tilt, motion, dem.surroundings(), counters, work.projected);
  if (!motion.jumps.any() && !climbs()) {
    if (pose_offset_.undecided()) map.follow_jump(work.projected, tilt_latency_, pose_offset_);
  } else if (line.time_ns - jumps_since_ns_ <= longest_climb_ns) {
    using JumpLine = typename MapComparison<limits>::JumpLine;
    const JumpLine lies = map.check_jump(work.projected, motion, climbs(), tilt_latency_, pose_offset_);
    counters.lines_off_map += lies != JumpLine::on_map;
    if (lies == JumpLine::off_map) return false;
  }
  if (line_projection_.tilt().fixed) return true;
  map.follow_latency(work.projected, motion, pose_offset_, tilt_latency_);
  const TiltLatency::Correction correction = tilt_latency_.end_line(tilt_rate_rad_s_);
  if (correction.any()) {
    dem.delay(correction.later_s, tilt_latency_.sweep_rates());
    for (Point& p : work.projected.points()) p.z_m += p.growth_m_s * correction.later_s.now;
  }
  if (correction.lean_rad != 0.0f) lean(correction, dem, work.projected);
  return true;
}

/// The laser's lean is taken off the map, the line in hand and those to come.
template <Limits limits>
void LineIntake<limits>::lean(const TiltLatency::Correction& by, Dem<limits>& dem, ProjectedLine<limits>& line) {
  dem.lean(by.lean_rad);
  for (Point& p : line.points()) p.z_m -= by.lean_rad * dem.ahead_m(p.x_m, p.y_m);
  line_projection_.lean(tilt_latency_.lean_rad());
}

}  // namespace curbline
