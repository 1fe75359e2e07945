// From a scan line to points with the variance of their heights. Each beam has its own time, tilt and pose, as a
// nodding laser requires: at 40 Hz and 0.3 rad/s the tilt turns by half a degree within a line. About 170 operations a
// beam, 120 for one that returns from outside the map.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <utility>

#include "curbline/counters.hpp"
#include "curbline/frames.hpp"
#include "curbline/intake/pose_track.hpp"
#include "curbline/intake/tilt_snapshot.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/point.hpp"
#include "curbline/scan_line.hpp"
#include "curbline/settings.hpp"

namespace curbline {

/// The robot's motion while a line is measured: the poses of its first and last beam. Points are interpolated between
/// them, which is exact without turning, and with it off by (turn)^2 / 8 of the range: 0.5 mm at 10 m and 1 deg a line.
struct LineMotion {
  Transform T_map_base_first{}, T_map_base_last{};
  bool still = true;  ///< both are the identity
  PoseJumps jumps{};  ///< of the poses around the line

  /// A place in the base frame, in the map frame when a share of the line has been measured.
  Eigen::Vector3f in_map(const Eigen::Vector3f& p_base, float share) const {
    const Eigen::Vector3f first = T_map_base_first * p_base, last = T_map_base_last * p_base;
    return first + share * (last - first);
  }
  /// Variance of a point's height by jumps, which may have happened at any time in between. At a share s of the way,
  /// the interpolated pose is off by s of the jump or by 1 - s: the mean square is s (1 - s), a sixth over all s.
  float blur_m2(float x_m, float y_m) const {
    const float dx_m = x_m - T_map_base_first.translation.x(), dy_m = y_m - T_map_base_first.translation.y();
    return (1.0f / 6) * (jumps.height_m2 + jumps.attitude_rad2 * (dx_m * dx_m + dy_m * dy_m));
  }
};

/// The points of a line, in the order of the beams, without those that did not return, stand alone or lie out of
/// bounds.
template <Limits limits>
class ProjectedLine {
 public:
  ProjectedLine() {}
  void add(const Point& point) { ::new (static_cast<void*>(points_.data() + count_++)) Point(point); }
  void leave_out() { ++outside_; }
  /// Removes the points for which `of` is true; false if there are none.
  template <typename Of>
  bool leave_out_if(Of&& of) {
    std::size_t kept = 0;
    for (const Point& point : points()) {
      if (!of(point)) points_[kept++] = point;
    }
    return std::exchange(count_, kept) > kept;
  }
  std::span<const Point> points() const { return {points_.data(), count_}; }
  std::span<Point> points() { return {points_.data(), count_}; }
  /// How many returned from out of bounds.
  std::uint32_t outside() const { return outside_; }

 private:
  /// Constructed as they are added: to construct them all takes 13,000 instructions.
  union {
    std::array<Point, limits.beams> points_;
  };
  std::size_t count_ = 0;
  std::uint32_t outside_ = 0;
};

template <Limits limits>
class LineProjection {
 public:
  [[gnu::cold]] void init(const Settings& settings);

  /// Adds a point to `out` for each beam that returned from within bounds. `tilt` is not read with a fixed tilt. The
  /// line has at most limits.beams. Lone returns are left out, unless the same beam stood alone in the line before.
  void project(const ScanLine& line, TiltSnapshot<limits>& tilt, const LineMotion& motion, const Bounds& bounds,
               Counters& counters, ProjectedLine<limits>& out);

  /// From now on the laser looks farther down than tilt readings say.
  void lean(float by_rad) { lean_rad_ = by_rad; }

  const LaserSettings& laser() const { return laser_; }
  const TiltSettings& tilt() const { return tilt_; }
  const PoseSettings& pose() const { return pose_; }
  const Transform& T_base_tilt() const { return T_base_tilt_; }

 private:
  bool returned(float range_m) const {
    return range_m > 0.0f && range_m >= laser_.min_range_m && range_m < laser_.max_range_m;
  }  // false for NaN
  /// A beam compared with the two beside it, by three standard deviations.
  struct Neighbours {
    float farther_m = 0.0f;  ///< their mean range less its own, if all three agree: one surface
    bool alone = false;      ///< it is nearer than both, or farther; both have returned
  };
  Neighbours neighbours(float before_m, float own_m, float after_m, float three_sd_m2) const {
    const float apart = after_m - before_m, off = 0.5f * (before_m + after_m) - own_m;
    if (apart * apart <= 2.0f * three_sd_m2 && off * off <= 1.5f * three_sd_m2) return {off, false};
    const float to_before = before_m - own_m, to_after = after_m - own_m;
    if ((to_before > 0.0f) != (to_after > 0.0f) || to_before * to_before <= 2.0f * three_sd_m2 ||
        to_after * to_after <= 2.0f * three_sd_m2)
      return {};
    return {0.0f, returned(before_m) && returned(after_m)};
  }
  /// The map's x, y or z axis, in the frame of the tilt axis.
  Eigen::Vector3f gradient(const LineMotion& motion, int axis) const {
    if (motion.still) return T_base_tilt_.rotation.row(axis);
    return rotated(T_base_tilt_.rotation.transpose(), motion.T_map_base_first.rotation.row(axis));
  }
  TiltAngle tilt_at(std::int64_t time_ns, TiltSnapshot<limits>& tilt) const;
  float height_variance_m2(float range_m, float by_range, float by_bearing, float by_tilt,
                           const Eigen::Vector3f& p_base, float tilt_rate) const;

  LaserSettings laser_{};
  TiltSettings tilt_{};
  PoseSettings pose_{};
  float lean_rad_ = 0.0f;
  std::int64_t beam_interval_ns_ = 0;
  Transform T_base_tilt_{}, T_tilt_laser_{};
  std::array<SinCos, limits.beams> bearing_;                     ///< of each beam
  std::array<std::uint32_t, (limits.beams + 31) / 32> alone_{};  ///< bits: beams that stood alone in the last line
};

template <Limits limits>
void LineProjection<limits>::init(const Settings& settings) {
  laser_ = settings.laser;
  tilt_ = settings.tilt;
  pose_ = settings.pose;
  lean_rad_ = 0.0f;
  beam_interval_ns_ = laser_.beam_interval_ns();
  T_base_tilt_ = make_transform(tilt_.T_base_tilt);
  T_tilt_laser_ = make_transform(tilt_.T_tilt_laser);
  alone_.fill(0);
  for (int i = 0; i < laser_.beams; ++i) {
    bearing_[static_cast<std::size_t>(i)] =
        sin_cos(laser_.first_bearing_rad + static_cast<float>(i) * laser_.bearing_step_rad);
  }
}

/// For a point out of bounds only the place is computed: most points are, above the ground or far away.
template <Limits limits>
void LineProjection<limits>::project(const ScanLine& line, TiltSnapshot<limits>& tilt, const LineMotion& motion,
                                     const Bounds& bounds, Counters& counters, ProjectedLine<limits>& out) {
  const std::span<const float> ranges_m = line.ranges_m;
  const std::size_t beams = ranges_m.size();
  const float step = beams > 1 ? 1.0f / static_cast<float>(beams - 1) : 0.0f;
  const Eigen::Vector3f x_axis = gradient(motion, 0), y_axis = gradient(motion, 1), up_axis = gradient(motion, 2);
  const Eigen::Vector3f laser_x = T_tilt_laser_.rotation.col(0), laser_y = T_tilt_laser_.rotation.col(1);
  const float three_sd_m2 = gate * laser_.range_sd_m * laser_.range_sd_m;
  NearSinCos near;
  std::uint32_t alone_before = 0;
  std::int64_t time_ns = line.time_ns;
  for (std::size_t i = 0; i < beams; ++i, time_ns += beam_interval_ns_) {
    if (i % 32 == 0) alone_before = std::exchange(alone_[i / 32], 0);
    const float range = ranges_m[i];
    if (!returned(range)) {
      ++counters.no_returns;
      continue;
    }
    const TiltAngle angle = tilt_at(time_ns, tilt);
    if (angle.source == TiltAngle::Source::none) {
      ++counters.beams_without_tilt;
      continue;
    }
    counters.beams_extrapolated += angle.source == TiltAngle::Source::extrapolated;

    const SinCos s = near.at(angle.angle_rad + lean_rad_);
    const Eigen::Vector3f x = tilted(s, laser_x), y = tilted(s, laser_y);  // the laser's axes
    const SinCos& bearing = bearing_[i];
    const Eigen::Vector3f along = x * bearing.cos + y * bearing.sin;
    const Eigen::Vector3f p_axis = along * range + tilted(s, T_tilt_laser_.translation);
    const Eigen::Vector3f p_base = T_base_tilt_ * p_axis;
    const Eigen::Vector3f p_map = motion.still ? p_base : motion.in_map(p_base, static_cast<float>(i) * step);
    const bool within = i > 0 && i + 1 < beams;
    const Neighbours beside = within ? neighbours(ranges_m[i - 1], range, ranges_m[i + 1], three_sd_m2) : Neighbours{};
    const float shift_x_m = beside.farther_m * dot(x_axis, along), shift_y_m = beside.farther_m * dot(y_axis, along);
    if (!bounds.hold(p_map.x() + shift_x_m, p_map.y() + shift_y_m, p_map.z())) {
      out.leave_out();
      continue;
    }
    if (beside.alone) {
      alone_[i / 32] |= 1u << i % 32;
      if ((alone_before >> i % 32 & 1) == 0) {
        ++counters.echoes_alone;
        continue;
      }
    }
    const Eigen::Vector3f across = y * bearing.cos - x * bearing.sin;
    const float by_tilt = up_axis.x() * p_axis.z() - up_axis.z() * p_axis.x();
    float variance_m2 =
        height_variance_m2(range, dot(up_axis, along), dot(up_axis, across), by_tilt, p_base, angle.rate_rad_s);
    if (!motion.still) variance_m2 += motion.blur_m2(p_map.x(), p_map.y());
    out.add({p_map.x(), p_map.y(), p_map.z(), variance_m2, by_tilt * angle.rate_rad_s, shift_x_m, shift_y_m});
  }
  for (std::size_t word = (beams + 31) / 32; word < alone_.size(); ++word) alone_[word] = 0;  // of a longer line before
}

template <Limits limits>
TiltAngle LineProjection<limits>::tilt_at(std::int64_t time_ns, TiltSnapshot<limits>& tilt) const {
  if (tilt_.fixed) return {TiltAngle::Source::interpolated, tilt_.fixed_tilt_rad, 0.0f};
  return tilt.at(time_ns);
}

/// First-order propagation: the derivative of the height by each error, times its standard deviation, squared and
/// summed.
template <Limits limits>
float LineProjection<limits>::height_variance_m2(float range_m, float by_range, float by_bearing, float by_tilt,
                                                 const Eigen::Vector3f& p_base, float tilt_rate) const {
  const float tilt_variance = square(tilt_.angle_sd_rad) + square(tilt_rate * tilt_.time_sd_s);
  const float attitude = square(pose_.attitude_sd_rad);
  const float from_mount_x = p_base.x() - T_base_tilt_.translation.x();
  const float from_mount_y = p_base.y() - T_base_tilt_.translation.y();
  return square(by_range * laser_.range_sd_m) + square(range_m * by_bearing * laser_.bearing_sd_rad) +
         square(by_tilt) * tilt_variance + square(from_mount_y * tilt_.roll_sd_rad) +
         square(from_mount_x * tilt_.pitch_sd_rad) + (square(p_base.x()) + square(p_base.y())) * attitude +
         square(pose_.height_sd_m);
}

}  // namespace curbline
