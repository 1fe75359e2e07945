// Rigid transforms between the frames: map <- base (the robot) <- tilt (the servo's axis) <- laser. Right-handed, x
// ahead, y left, z up, metres and radians (REP 103). Names cancel: p_map = T_map_base * p_base.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "curbline/math.hpp"
#include "curbline/pose.hpp"
#include "curbline/settings.hpp"

namespace curbline {

// Sums of three are written out: Eigen would order them, and fuse them with multiplications, to suit the target's
// vector unit.

inline float dot(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

inline Eigen::Vector3f rotated(const Eigen::Matrix3f& rotation, const Eigen::Vector3f& p) {
  return {dot(rotation.row(0), p), dot(rotation.row(1), p), dot(rotation.row(2), p)};
}

struct Transform {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();

  Eigen::Vector3f operator*(const Eigen::Vector3f& p) const { return rotated(rotation, p) + translation; }
};

/// R_z(yaw) R_y(pitch) R_x(roll), then translation.
inline Transform make_transform(const MountSettings& mount) {
  const SinCos a = sin_cos(mount.roll_rad), b = sin_cos(mount.pitch_rad), c = sin_cos(mount.yaw_rad);
  Transform T;
  T.rotation << c.cos * b.cos, c.cos * b.sin * a.sin - c.sin * a.cos, c.cos * b.sin * a.cos + c.sin * a.sin,  //
      c.sin * b.cos, c.sin * b.sin * a.sin + c.cos * a.cos, c.sin * b.sin * a.cos - c.cos * a.sin,            //
      -b.sin, b.cos * a.sin, b.cos * a.cos;
  T.translation << mount.x_m, mount.y_m, mount.z_m;
  return T;
}

/// T_map_base. The quaternion is normalised here and must not be zero.
Transform make_transform(const Pose& pose);

/// Horizontal direction of a frame's x axis; that of the map's x axis if it points straight up or down.
inline SinCos heading(const Transform& T) {
  const float x = T.rotation(0, 0), y = T.rotation(1, 0), level = square_root(x * x + y * y);
  return level > 0.0f ? SinCos{y / level, x / level} : SinCos{0.0f, 1.0f};
}

/// R_y(tilt) p: tilt > 0 turns x down. s = sin_cos(tilt).
inline Eigen::Vector3f tilted(const SinCos& s, const Eigen::Vector3f& p) {
  return {s.cos * p.x() + s.sin * p.z(), p.y(), s.cos * p.z() - s.sin * p.x()};
}

}  // namespace curbline
