#include "curbline/pose_track.hpp"

#include <cmath>

namespace curbline {

Transform make_transform(const Pose& pose) {
  // Summed here, in one order: Eigen's norm of four numbers adds them in another one where it has vectors.
  const float norm = std::sqrt(pose.qx * pose.qx + pose.qy * pose.qy + pose.qz * pose.qz + pose.qw * pose.qw);
  const Eigen::Quaternionf q(pose.qw / norm, pose.qx / norm, pose.qy / norm, pose.qz / norm);
  Transform T;
  T.rotation = q.toRotationMatrix();
  T.translation << pose.x_m, pose.y_m, pose.z_m;
  return T;
}

namespace detail {

bool acceptable(const Pose& pose) {
  for (const float value : {pose.x_m, pose.y_m, pose.z_m, pose.qx, pose.qy, pose.qz, pose.qw}) {
    if (!is_finite(value)) return false;
  }
  if (!near_origin(pose)) return false;
  const float square = pose.qx * pose.qx + pose.qy * pose.qy + pose.qz * pose.qz + pose.qw * pose.qw;
  return square > 0.98f && square < 1.02f;
}

bool near_origin(const Pose& pose) {
  for (const float metres : {pose.x_m, pose.y_m, pose.z_m}) {
    if (metres > Pose::furthest_m || metres < -Pose::furthest_m) return false;
  }
  return true;
}

Pose interpolate(const Pose& a, const Pose& b, std::int64_t time_ns) {
  const float s = static_cast<float>(time_ns - a.time_ns) / static_cast<float>(b.time_ns - a.time_ns);
  const float dot = a.qx * b.qx + a.qy * b.qy + a.qz * b.qz + a.qw * b.qw;
  const float sign = dot < 0.0f ? -1.0f : 1.0f;  // q and -q are one attitude: take the nearer
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

}  // namespace detail
}  // namespace curbline
