#include "curbline/frames.hpp"

namespace curbline {

Transform make_transform(const Pose& pose) {
  // Summed here in a fixed order: Eigen's norm of four numbers depends on the target's vector unit.
  const float norm = square_root(pose.qx * pose.qx + pose.qy * pose.qy + pose.qz * pose.qz + pose.qw * pose.qw);
  const Eigen::Quaternionf q(pose.qw / norm, pose.qx / norm, pose.qy / norm, pose.qz / norm);
  Transform T;
  T.rotation = q.toRotationMatrix();
  T.translation << pose.x_m, pose.y_m, pose.z_m;
  return T;
}

}  // namespace curbline
