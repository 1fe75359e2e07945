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

/// The way of a scene in its map frame. The base's origin lies at the mean height of the ground under 0.5 m of
/// wheelbase, so it goes up a curb within that length; pitch and roll are those of this ground, or 0 for a level base.
/// The truth is the polyline between poses 10 ms apart: O(1) a call.
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
  Sample on_ground(const Scene& scene, Point2 at, double yaw_rad) const;
  void turn(const Scene& scene, const Leg& leg);
  void drive(const Scene& scene, const Leg& leg);

  double until_s_;
  std::vector<Sample> samples_;
};

}  // namespace curbline::tools
