// The robot's pose over time, T_map_base, from odometry or localisation. Fed and read by the same context as scan
// lines.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "curbline/frames.hpp"
#include "curbline/intake/extrapolation.hpp"
#include "curbline/intake/rising_times.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/pose.hpp"
#include "curbline/settings.hpp"

namespace curbline {

/// How far poses deviate from where the poses before them led, if by three standard deviations or more: a wheel has met
/// a curb, or the localisation has corrected itself. Sums of squares.
struct PoseJumps {
  float height_m2 = 0.0f;      ///< of z
  float attitude_rad2 = 0.0f;  ///< of roll and pitch together
  bool any() const { return height_m2 + attitude_rad2 > 0.0f; }
};

/// A change of the pose as it changes heights seen from there: at the robot, and their slopes along the map's axes.
struct PoseShift {
  float height_m = 0.0f, slope_x = 0.0f, slope_y = 0.0f;
  bool any() const { return height_m != 0.0f || slope_x != 0.0f || slope_y != 0.0f; }
  float at(float dx_m, float dy_m) const { return height_m + slope_x * dx_m + slope_y * dy_m; }
  PoseShift operator+(const PoseShift& b) const {
    return {height_m + b.height_m, slope_x + b.slope_x, slope_y + b.slope_y};
  }
  PoseShift operator-(const PoseShift& b) const {
    return {height_m - b.height_m, slope_x - b.slope_x, slope_y - b.slope_y};
  }
};

/// What a pose says about steps. A step begins with a pose off the way of those before it; the next pose confirms it by
/// going on from there at the old speed, off the old way too. No robot moves like that, but a localisation does (and a
/// robot, if poses are far apart in time). Until the next pose has come, one that jumps may be either. A next pose that
/// jumps again, or back to the old way, withdraws the step, and so do poses that begin anew. Consecutive jumps mean
/// that the robot climbs; no pose shows whether its localisation steps meanwhile. It has climbed when poses have gone
/// on for a whole way without a jump.
struct PoseStepNews {
  enum class Kind { begun, confirmed, withdrawn, climbed } kind;
  PoseShift by{};  ///< of a step that has begun
};

namespace detail {
bool acceptable(const Pose& pose);
/// Within Pose::furthest_m of the map's origin?
bool near_origin(const Pose& pose);
Pose interpolate(const Pose& a, const Pose& b, std::int64_t time_ns);

/// How far a pose deviates from where others lead.
struct PoseResidual {
  float height_m = 0.0f, roll_rad = 0.0f, pitch_rad = 0.0f;
  bool height_jumps = false, attitude_jumps = false;  ///< by three standard deviations or more
  bool jumps() const { return height_jumps || attitude_jumps; }
};
/// That of `now`, going on from `before` at the speed between `first` and `last`.
PoseResidual residual_of(const Pose& first, const Pose& last, const Pose& before, const Pose& now,
                         const PoseSettings& settings);
/// The same as a change of heights in the map, with the heading of `now`.
PoseShift shift_of(const PoseResidual& off, const Pose& now);
}  // namespace detail

/// Ring of the newest poses, at least 12 ms apart except for the very newest. Between two of them, position and
/// attitude are linear, the latter normalised.
template <Limits limits>
class PoseTrack {
 public:
  void init(const PoseSettings& settings) {
    settings_ = settings;
    next_ = 0;
    times_ = RisingTimes{};
    forget();
    begun_lost_ = false;
  }

  /// Takes a pose. It replaces the newest if that one came within 12 ms of the one before, so the pose of a line
  /// depends on how many have come by then. False if it is not finite or beyond 1000 km, its quaternion not of unit
  /// length within 1 % or tilting the robot by more than 90 degrees, or not later than the one before
  /// (rising_times.hpp). O(1).
  bool push(const Pose& pose);

  /// The pose at a time; false if there is none within max_extrapolation_s. O(poses).
  bool at(std::int64_t time_ns, Pose& out) const;

  /// Jumps of the poses later than a line's first beam, up to the first one at or after its last. O(poses).
  PoseJumps jumps(std::int64_t first_ns, std::int64_t last_ns) const;

  /// The next news of a step, from poses not examined yet and not later than a line's first beam; nothing if there is
  /// none. O(1) a pose.
  std::optional<PoseStepNews> next_step(std::int64_t until_ns);

  /// Does the robot climb, by the poses examined so far?
  bool climbs() const { return climbs_; }

  const Pose& newest() const { return back(0); }

 private:
  std::size_t place(int age) const { return static_cast<std::size_t>(next_ + limits.poses - 1 - age) % limits.poses; }
  const Pose& back(int age) const { return poses_[place(age)]; }

  /// Is the pose of this age, the one after a jump, off the way from before the jump too? If not, there was none: the
  /// pose that jumped was in error, as one in seventy is.
  bool lies_off_before(int age) const { return residual(age + 2, poses_of_a_way, age + 2, age).jumps(); }

  /// Has the newest pose come within 12 ms of the one before, so that the next one replaces it?
  bool open() const { return size_ > 1 && back(0).time_ns - back(1).time_ns < least_spacing_ns; }

  /// How far the pose of `age` is from where the robot would be if it had gone on from the pose of age `before`, at the
  /// mean speed of the `most` steps up to the pose of age `last` (fewer if there are not as many; nothing if there is
  /// none). The newest pose has age 0. Not inlined: it is called from three places.
  [[gnu::noinline]] detail::PoseResidual residual(int last, int most, int before, int age) const {
    if (last + 1 >= size_) return {};
    const int first = last + most < size_ ? last + most : size_ - 1;
    return detail::residual_of(back(first), back(last), back(before), back(age), settings_);
  }

  void forget() {
    begun_lost_ = begun_lost_ || jumps_on_end_ == 1;
    size_ = fresh_ = 0;
    jumps_on_end_ = 0;
    since_jump_ = limits.poses;
    climbs_ = false;
  }

  bool beyond(std::int64_t time_ns, int end, int inward, std::int64_t bound, Pose& out) const;
  /// Poses err independently (PoseSettings): of more poses more jump by chance, and a few span too short a way to show
  /// where they lead. More than 83 a second are thinned out.
  static constexpr std::int64_t least_spacing_ns = 12'000'000;
  /// Steps from pose to pose that show where the robot is led: less than a tenth of a second at 50 Hz.
  static constexpr int poses_of_a_way = 4;

  PoseSettings settings_{};
  std::array<Pose, limits.poses> poses_{};
  int size_ = 0, next_ = 0;
  int fresh_ = 0;            ///< so many of the newest poses have not been examined for steps
  int jumps_on_end_ = 0;     ///< consecutive jumps up to the last one examined; 0 if that did not jump
  int since_jump_ = 0;       ///< poses from the last jump on; limits.poses: long ago
  bool climbs_ = false;      ///< consecutive poses have jumped, and not gone on for a whole way since
  bool begun_lost_ = false;  ///< poses began anew after a step was reported to have begun
  RisingTimes times_{};
};

template <Limits limits>
bool PoseTrack<limits>::push(const Pose& pose) {
  if (!detail::acceptable(pose) || !times_.admits(pose.time_ns)) return false;
  if (size_ > 0 && pose.time_ns <= newest().time_ns) forget();  // earlier poses are of another time base
  times_.take(pose.time_ns);
  if (open()) {
    poses_[place(0)] = pose;
    return true;
  }
  poses_[static_cast<std::size_t>(next_)] = pose;
  next_ = (next_ + 1) % limits.poses;
  if (size_ < limits.poses) ++size_;
  if (fresh_ < limits.poses) ++fresh_;
  return true;
}

template <Limits limits>
bool PoseTrack<limits>::at(std::int64_t time_ns, Pose& out) const {
  if (size_ == 0) return false;
  const std::int64_t bound = to_ns(settings_.max_extrapolation_s);
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
  for (int age = 0; age < size_ && back(age).time_ns > first_ns; ++age) {
    if (age + 1 < size_ && back(age + 1).time_ns >= last_ns) continue;
    const detail::PoseResidual by = residual(age + 1, poses_of_a_way, age + 1, age);
    if (by.height_jumps) jumps.height_m2 += by.height_m * by.height_m;
    if (by.attitude_jumps) jumps.attitude_rad2 += by.roll_rad * by.roll_rad + by.pitch_rad * by.pitch_rad;
  }
  return jumps;
}

template <Limits limits>
std::optional<PoseStepNews> PoseTrack<limits>::next_step(std::int64_t until_ns) {
  using Kind = PoseStepNews::Kind;
  if (std::exchange(begun_lost_, false)) return PoseStepNews{Kind::withdrawn};
  while (fresh_ > (open() ? 1 : 0) && back(fresh_ - 1).time_ns <= until_ns) {
    const int age = --fresh_;
    // At the speed since the last jump if two poses show it, else at that before.
    const int last = since_jump_ == 1 ? age + 2 : age + 1;
    const int most = since_jump_ > 1 && since_jump_ <= poses_of_a_way ? since_jump_ - 1 : poses_of_a_way;
    const detail::PoseResidual off = residual(last, most, age + 1, age);
    const bool may_confirm = jumps_on_end_ == 1;  // the step that the pose before has begun
    jumps_on_end_ = off.jumps() ? jumps_on_end_ + 1 : 0;
    since_jump_ = off.jumps() ? 1 : since_jump_ < limits.poses ? since_jump_ + 1 : since_jump_;
    if (may_confirm) {
      const bool stays_off = lies_off_before(age);
      climbs_ = climbs_ || (off.jumps() && stays_off);
      return PoseStepNews{off.jumps() || !stays_off ? Kind::withdrawn : Kind::confirmed};
    }
    if (jumps_on_end_ == 1) return PoseStepNews{Kind::begun, detail::shift_of(off, back(age))};
    if (climbs_ && (since_jump_ > poses_of_a_way || since_jump_ == limits.poses)) {
      climbs_ = false;
      return PoseStepNews{Kind::climbed};
    }
  }
  return {};
}

/// Later than all poses, or earlier: goes on from the one at that end at the robot's speed, or stands if no other pose
/// shows it. `inward` is the direction to the other end.
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
