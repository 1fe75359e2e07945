// The true pose of the simulated robot as a function of time.
#pragma once

#include "simulator/ground_plan.hpp"
#include "simulator/scene.hpp"

#include <Eigen/Geometry>
#include <limits>
#include <vector>

namespace curbline::tools {

/// The scene in the map frame of the simulated data. For a robot that stands, this is its base frame (x ahead, level, z
/// = 0 where it stands), since a pipeline without poses knows no other; for one that drives, the scene's own frame.
/// Throws BadInput if there is no ground below the standing robot.
Scene in_map_frame(const Scene& scene);

/// How four wheels stand on the ground.
struct Footing {
  double z_m;            ///< mean of their heights
  double along, across;  ///< slopes ahead and to the left
};

/// The path of a scene in its map frame. The base's origin is at the mean height of four wheels that roll over the
/// ground, 0.15 m in radius, with a wheelbase of 0.5 m and a track of 0.4 m: they climb a curb of 12 cm one axle after
/// the other, each within 0.15 m. Pitch and roll are those of the wheels, or 0 for a level base. The truth is the
/// polyline between poses 10 ms apart: O(1) a call.
class RobotMotion {
 public:
  /// The motion up to `until_s`, after which the robot stays. Throws BadInput if it would leave the ground before.
  explicit RobotMotion(const Scene& scene, double until_s = std::numeric_limits<double>::infinity());

  double duration_s() const;                          ///< 0 if it stands
  Eigen::Isometry3d T_map_base(double time_s) const;  ///< before and after the motion, the robot stands at its ends

 private:
  struct Sample {
    double x, y, z, roll, pitch, yaw;
  };
  static Sample sample(const Scene& scene, Point2 at, double yaw_rad, const Footing& ground);
  void turn(const Scene& scene, const GroundPlan& plan, const Leg& leg);
  void drive(const Scene& scene, const GroundPlan& plan, const Leg& leg);

  double until_s_;
  std::vector<Sample> samples_;
};

}  // namespace curbline::tools
