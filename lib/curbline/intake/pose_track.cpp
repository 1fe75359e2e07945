#include "curbline/intake/pose_track.hpp"

#include "curbline/math.hpp"

namespace curbline {
namespace {

/// q and -q are the same attitude: the sign that brings b's nearer to a's.
float nearer_sign(const Pose& a, const Pose& b) {
  return a.qx * b.qx + a.qy * b.qy + a.qz * b.qz + a.qw * b.qw < 0.0f ? -1.0f : 1.0f;
}

/// Roll and pitch by which the robot has turned, in its own frame, for small turns.
struct Turn {
  float roll_rad, pitch_rad;
};

Turn turn(const Pose& from, const Pose& to) {
  const float twice = 2.0f * nearer_sign(from, to);
  return {twice * (from.qw * to.qx - from.qx * to.qw - from.qy * to.qz + from.qz * to.qy),
          twice * (from.qw * to.qy - from.qy * to.qw - from.qz * to.qx + from.qx * to.qz)};
}

}  // namespace

namespace detail {

bool acceptable(const Pose& pose) {
  for (const float value : {pose.x_m, pose.y_m, pose.z_m, pose.qx, pose.qy, pose.qz, pose.qw}) {
    if (!is_finite(value)) return false;
  }
  if (!near_origin(pose)) return false;
  const float across = pose.qx * pose.qx + pose.qy * pose.qy, along = pose.qz * pose.qz + pose.qw * pose.qw;
  const float norm_2 = across + along;
  return norm_2 > 0.98f && norm_2 < 1.02f && across <= along;  // z of the base up
}

bool near_origin(const Pose& pose) {
  for (const float metres : {pose.x_m, pose.y_m, pose.z_m}) {
    if (metres > Pose::furthest_m || metres < -Pose::furthest_m) return false;
  }
  return true;
}

Pose interpolate(const Pose& a, const Pose& b, std::int64_t time_ns) {
  const float s = to_float(time_ns - a.time_ns) / to_float(b.time_ns - a.time_ns);
  const float sign = nearer_sign(a, b);
  const auto mix = [s](float from, float to) { return from + s * (to - from); };
  return {time_ns,
          mix(a.x_m, b.x_m),
          mix(a.y_m, b.y_m),
          mix(a.z_m, b.z_m),
          mix(a.qx, sign * b.qx),
          mix(a.qy, sign * b.qy),
          mix(a.qz, sign * b.qz),
          mix(a.qw, sign * b.qw)};
}

/// Independent errors of the poses enter its variance with 1, (1 + f)^2 and f^2, or, if `before` is not `last`, with 1,
/// 1, f^2 and f^2.
PoseResidual residual_of(const Pose& first, const Pose& last, const Pose& before, const Pose& now,
                         const PoseSettings& settings) {
  const float f = to_float(now.time_ns - before.time_ns) / to_float(last.time_ns - first.time_ns);
  const float of_last = before.time_ns == last.time_ns ? square(1.0f + f) : 1.0f + f * f;
  const float noise = gate * (1.0f + of_last + f * f);
  const Turn led = turn(first, last), went = turn(before, now);
  PoseResidual off{now.z_m - before.z_m - f * (last.z_m - first.z_m), went.roll_rad - f * led.roll_rad,
                   went.pitch_rad - f * led.pitch_rad};
  const float attitude_rad2 = off.roll_rad * off.roll_rad + off.pitch_rad * off.pitch_rad;
  off.height_jumps = off.height_m * off.height_m > noise * settings.height_sd_m * settings.height_sd_m;
  off.attitude_jumps = attitude_rad2 > noise * settings.attitude_sd_rad * settings.attitude_sd_rad;
  return off;
}

PoseShift shift_of(const PoseResidual& off, const Pose& now) {
  const SinCos ahead = heading(make_transform(now));
  return {off.height_m, -off.roll_rad * ahead.sin - off.pitch_rad * ahead.cos,
          off.roll_rad * ahead.cos - off.pitch_rad * ahead.sin};
}

}  // namespace detail
}  // namespace curbline
