// The robot's pose over time, T_map_base, from odometry or localisation. Fed and read by the same context as scan
// lines.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/extrapolation.hpp"
#include "curbline/frames.hpp"
#include "curbline/limits.hpp"
#include "curbline/rising_times.hpp"
#include "curbline/settings.hpp"

namespace curbline {

/// Position of the base in the map frame and its attitude as a unit quaternion. float keeps 0.1 mm within 1 km of the
/// map's origin: put it near the robot.
struct Pose {
  static constexpr float furthest_m = 1e6f;  ///< along each axis: beyond, float would not tell one cell from the next
  std::int64_t time_ns = 0;
  float x_m = 0.0f, y_m = 0.0f, z_m = 0.0f;
  float qx = 0.0f, qy = 0.0f, qz = 0.0f, qw = 1.0f;
};

/// How far poses lie off where those before them led, by three standard deviations or more: a wheel has met a kerb, or
/// a localisation has thought better of it. Sums of squares.
struct PoseJumps {
  float height_m2 = 0.0f;      ///< of z
  float attitude_rad2 = 0.0f;  ///< of roll and pitch together
};

/// Rotation matrix of a quaternion that is normalised here. Not for a zero quaternion.
Transform make_transform(const Pose& pose);

/// Ring of the newest poses; linear in position and normalised-linear in attitude between two of them.
template <Limits limits>
class PoseTrack {
 public:
  void init(const PoseSettings& settings) {
    settings_ = settings;
    size_ = next_ = 0;
    times_ = RisingTimes{};
  }

  /// Takes a pose; false if it is not finite or beyond 1000 km, its quaternion not of unit length within 1 %, or not
  /// later than the one before (rising_times.hpp). O(1).
  bool push(const Pose& pose);

  /// Pose at a time; false if there is none within max_extrapolation_s. O(poses).
  bool at(std::int64_t time_ns, Pose& out) const;

  /// Jumps of the poses later than a line's first beam, up to the first that is not before its last. O(poses).
  PoseJumps jumps(std::int64_t first_ns, std::int64_t last_ns) const;

  bool empty() const { return size_ == 0; }
  const Pose& newest() const { return poses_[static_cast<std::size_t>((next_ + limits.poses - 1) % limits.poses)]; }

 private:
  const Pose& back(int age) const {
    return poses_[static_cast<std::size_t>((next_ + limits.poses - 1 - age) % limits.poses)];
  }

  bool beyond(std::int64_t time_ns, int end, int inward, std::int64_t bound, Pose& out) const;
  /// Where a robot is led is told by the way of as many poses: less than a tenth of a second at 50 Hz.
  static constexpr int poses_of_a_way = 4;

  PoseSettings settings_{};
  std::array<Pose, limits.poses> poses_{};
  int size_ = 0, next_ = 0;
  RisingTimes times_{};
};

namespace detail {
bool acceptable(const Pose& pose);
/// Of the map: within Pose::furthest_m.
bool near_origin(const Pose& pose);
Pose interpolate(const Pose& a, const Pose& b, std::int64_t time_ns);
/// How far `now` lies off where the way from `first` to `last` leads.
PoseJumps jump_of(const Pose& first, const Pose& last, const Pose& now, const PoseSettings& settings);
}  // namespace detail

template <Limits limits>
bool PoseTrack<limits>::push(const Pose& pose) {
  if (!detail::acceptable(pose) || !times_.admits(pose.time_ns)) return false;
  if (size_ > 0 && pose.time_ns <= newest().time_ns) size_ = 0;  // those before are of another time
  times_.take(pose.time_ns);
  poses_[static_cast<std::size_t>(next_)] = pose;
  next_ = (next_ + 1) % limits.poses;
  if (size_ < limits.poses) ++size_;
  return true;
}

template <Limits limits>
bool PoseTrack<limits>::at(std::int64_t time_ns, Pose& out) const {
  if (size_ == 0) return false;
  const auto bound = static_cast<std::int64_t>(settings_.max_extrapolation_s * 1e9f);
  int age = 0;
  while (age < size_ && back(age).time_ns > time_ns) ++age;
  if (age == 0) return beyond(time_ns, 0, 1, bound, out);
  if (age == size_) return beyond(time_ns, size_ - 1, -1, bound, out);
  if (time_ns - back(age).time_ns > bound && back(age - 1).time_ns - time_ns > bound) return false;
  out = detail::interpolate(back(age), back(age - 1), time_ns);
  return true;
}

template <Limits limits>
PoseJumps PoseTrack<limits>::jumps(std::int64_t first_ns, std::int64_t last_ns) const {
  PoseJumps jumps;
  for (int age = 0; age + 2 < size_ && back(age).time_ns > first_ns; ++age) {
    if (back(age + 1).time_ns >= last_ns) continue;
    const int begin = age + 1 + poses_of_a_way < size_ ? age + 1 + poses_of_a_way : size_ - 1;
    const PoseJumps jump = detail::jump_of(back(begin), back(age + 1), back(age), settings_);
    jumps.height_m2 += jump.height_m2;
    jumps.attitude_rad2 += jump.attitude_rad2;
  }
  return jumps;
}

/// Later than all poses, or earlier: goes on from the one at that end as the robot went; without another that tells, it
/// stands. `inward` is the way to the other end.
template <Limits limits>
bool PoseTrack<limits>::beyond(std::int64_t time_ns, int end, int inward, std::int64_t bound, Pose& out) const {
  const std::int64_t end_ns = back(end).time_ns;
  if (time_ns - end_ns > bound || end_ns - time_ns > bound) return false;
  const int other = sample_for_rate(time_ns, end, inward, size_, [this](int age) { return back(age).time_ns; });
  out = other < 0 ? back(end)
                  : detail::interpolate(back(inward > 0 ? other : end), back(inward > 0 ? end : other), time_ns);
  return detail::near_origin(out);
}

}  // namespace curbline
