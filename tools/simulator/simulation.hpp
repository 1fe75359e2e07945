// The robot's sensors in a scene: scan lines, tilt frames and poses, one by one, in the order in which a robot's
// computer would get them. Every beam is cast at its own time, from where the robot and its servo truly are. The same
// scene, robot, seed and duration give the same numbers.
//
// Servo: from `sweep.from_rad` to `sweep.to_rad` and back at constant speed, which it takes up and gives up evenly over
// a tenth of the half period at each end. A frame stamped t bears the angle that was true at t - latency_s -
// tilt_latency_s, less what the sweep's own latency differs by, which is drawn at each turn; jitter is added to the
// stamp after that, and stamps stay in order. The angle is rounded as tilt_signal rounds it. Poses: the true pose with
// white noise of position and attitude.
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

/// A scan line's ranges stay until the next call of next(); a range of NaN is no return.
using SimulatedEvent = std::variant<ScanLine, can::Frame, SimulatedPose>;

/// Tilt frames and poses go on for so long before the first and after the last scan line.
inline constexpr double simulated_margin_s = 0.25;

/// Time of the first scan line.
inline constexpr std::int64_t simulated_start_ns = 1'700'000'000'000'000'000;

class Simulation {
 public:
  /// Without a duration: one nod of a robot that stands (1 s if its tilt is fixed), the whole way of one that drives.
  /// Throws BadInput if the robot stands on nothing, or its tilt signal cannot hold the sweep.
  Simulation(const Scene& scene, const Robot& robot, std::uint64_t seed, std::optional<double> duration_s = {});

  double duration_s() const { return duration_s_; }

  /// A scan line comes after its last beam, a frame or a pose at its stamp. Nothing: the end.
  std::optional<SimulatedEvent> next();

  // The truth at a time, seconds after the first scan line.
  double true_tilt_rad(double time_s) const;
  Eigen::Isometry3d true_T_map_base(double time_s) const { return motion_.T_map_base(time_s); }

 private:
  double line_end_s() const;
  ScanLine take_line();
  can::Frame take_frame();
  can::Frame take_position();
  SimulatedPose take_pose();
  void stamp_next_frame();
  void draw_jumps(double time_s);             // times that never go back
  double draw_tilt_latency_s(double time_s);  // times that never go back; anew at each turn

  Robot robot_;
  Scene scene_;  // in the map frame
  RobotMotion motion_;
  RayCaster world_;
  SimulatedLaser laser_;
  Random tilt_random_, pose_random_, sweep_random_, jump_random_;
  Eigen::Isometry3d T_base_tilt_, T_tilt_laser_;
  double duration_s_;
  std::int64_t lines_ = 0, frames_ = 0, poses_ = 0;  // given out
  double frame_stamp_s_;
  double sweep_ = 0.0, sweep_latency_s_ = 0.0;  ///< of the last frame: its number, and what its latency differs by
  bool synced_ = false;                         ///< the position whose SYNC has been given out comes next
  struct {
    std::int64_t times = 0;
    double z_m = 0, roll_rad = 0, pitch_rad = 0;
  } jumped_;  ///< the localisation, up to the last pose
  std::vector<float> ranges_m_;
};

/// A robot that drives does, and one whose description says that poses come.
bool gives_poses(const Scene& scene, const Robot& robot);

/// Angle of a servo, `time_s` after it left from_rad.
double sweep_angle_rad(const Sweep& sweep, double time_s);

}  // namespace curbline::tools
