// The robot's sensors in a scene: scan lines, tilt frames and poses, one by one, in the order in which a robot's
// computer would receive them. Every beam is cast at its own time, from the true pose of the robot and its servo. The
// same scene, robot, seed and duration give the same numbers.
//
// Servo: from `sweep.from_rad` to `sweep.to_rad` and back at constant speed, with uniform acceleration over a tenth of
// the half period at each end. A frame stamped t has the true angle at t - latency_s - tilt_latency_s, minus the
// deviation of the sweep's own latency, which is drawn at each turn. After that, jitter is added to the stamp, and
// stamps stay in order. The angle is quantised as by tilt_signal. Poses: the true pose with white noise in position and
// attitude.
#pragma once

#include "curbline/can/frame.hpp"
#include "curbline/scan_line.hpp"
#include "simulator/ray_caster.hpp"
#include "simulator/robot_motion.hpp"
#include "simulator/simulated_laser.hpp"

#include <optional>
#include <variant>
#include <vector>

namespace curbline::tools {

struct SimulatedPose {
  std::int64_t time_ns = 0;
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
};

/// A scan line's ranges are valid until the next call of next(); NaN means no return.
using SimulatedEvent = std::variant<ScanLine, can::Frame, SimulatedPose>;

/// Tilt frames and poses begin this long before the first scan line and end this long after the last.
inline constexpr double simulated_margin_s = 0.25;

/// Time of the first scan line.
inline constexpr std::int64_t simulated_start_ns = 1'700'000'000'000'000'000;

class Simulation {
 public:
  /// Without a duration: one nod for a robot that stands (1 s if its tilt is fixed), the whole path for one that
  /// drives. Throws BadInput if there is no ground below a standing robot, or its tilt signal cannot represent the
  /// sweep.
  Simulation(const Scene& scene, const Robot& robot, std::uint64_t seed, std::optional<double> duration_s = {});

  double duration_s() const { return duration_s_; }

  /// A scan line comes after its last beam, a frame or a pose at its stamp. Nothing at the end.
  std::optional<SimulatedEvent> next();

  // The truth at a time in seconds after the first scan line.
  double true_tilt_rad(double time_s) const;
  Eigen::Isometry3d true_T_map_base(double time_s) const { return motion_.T_map_base(time_s); }

 private:
  double line_end_s() const;
  ScanLine take_line();
  can::Frame take_frame();
  can::Frame take_position();
  SimulatedPose take_pose();
  void stamp_next_frame();
  void draw_jumps(double time_s);             // times must not go back
  double draw_tilt_latency_s(double time_s);  // times must not go back; drawn anew at each turn

  Robot robot_;
  Scene scene_;  // in the map frame
  RobotMotion motion_;
  RayCaster world_;
  SimulatedLaser laser_;
  Random tilt_random_, pose_random_, sweep_random_, jump_random_;
  Eigen::Isometry3d T_base_tilt_, T_tilt_laser_;
  double duration_s_;
  std::int64_t lines_ = 0, frames_ = 0, poses_ = 0;  // counts of events returned
  double frame_stamp_s_;
  double sweep_ = 0.0, sweep_latency_s_ = 0.0;  ///< of the last frame: its sweep's number, and deviation in latency
  bool synced_ = false;                         ///< the SYNC has been returned, and its position comes next
  struct {
    std::int64_t times = 0;
    double z_m = 0, roll_rad = 0, pitch_rad = 0;
  } jumped_;  ///< accumulated jumps of the localisation, up to the last pose
  std::vector<float> ranges_m_;
};

/// True for a robot that drives, and for one whose description has poses.
bool gives_poses(const Scene& scene, const Robot& robot);

/// Angle of a servo, `time_s` after it left from_rad.
double sweep_angle_rad(const Sweep& sweep, double time_s);

}  // namespace curbline::tools
