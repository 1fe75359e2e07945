// Where the simulated robot truly is at a time.
#pragma once

#include "simulator/scene.hpp"

#include <Eigen/Geometry>
#include <limits>
#include <vector>

namespace curbline::tools {

/// The scene in the map frame of what is simulated: for a robot that stands, its base frame (x ahead, level, z = 0
/// where it stands), since a pipeline without poses knows no other; for one that drives, the scene's own. Throws
/// BadInput if the robot stands on nothing.
Scene in_map_frame(const Scene& scene);

/// How four wheels stand on the ground.
struct Footing {
  double z_m;            ///< mean of their heights
  double along, across;  ///< slopes ahead and to the left
};

/// The way of a scene in its map frame. The base's origin lies at the mean height of four wheels, 0.15 m in radius, 0.5
/// m from axle to axle and 0.4 m across, that roll over what the ground has: up a curb of 12 cm, one axle after the
/// other, each within 0.15 m. Pitch and roll are theirs, or 0 for a level base. The truth is the polyline between poses
/// 10 ms apart: O(1) a call.
class RobotMotion {
 public:
  /// Up to `until_s`: the robot stays there. Throws BadInput if it would leave the ground before.
  explicit RobotMotion(const Scene& scene, double until_s = std::numeric_limits<double>::infinity());

  double duration_s() const;                          ///< 0 if it stands
  Eigen::Isometry3d T_map_base(double time_s) const;  ///< before and after the way, it stands at its ends

 private:
  struct Sample {
    double x, y, z, roll, pitch, yaw;
  };
  static Sample sample(const Scene& scene, Point2 at, double yaw_rad, const Footing& ground);
  void turn(const Scene& scene, const Leg& leg);
  void drive(const Scene& scene, const Leg& leg);

  double until_s_;
  std::vector<Sample> samples_;
};

}  // namespace curbline::tools
