#include "simulator/simulation.hpp"

#include "curbline/can/signal.hpp"
#include "formats/bad_input.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace curbline::tools {
namespace {

constexpr double never_s = RayCaster::nothing;
constexpr double sync_answer_s = 300e-6;  // from a SYNC to the position: a frame at 500 kbit/s after another

std::int64_t stamp_ns(double time_s) {
  return simulated_start_ns + std::llround(time_s * 1e9);
}

Eigen::Isometry3d rotation(double roll_rad, double pitch_rad, double yaw_rad) {
  return Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
         Eigen::Isometry3d(Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()));
}

Eigen::Isometry3d transform(const MountSettings& mount) {
  return Eigen::Translation3d(mount.x_m, mount.y_m, mount.z_m) *
         rotation(mount.roll_rad, mount.pitch_rad, mount.yaw_rad);
}

/// A signal clips values outside its range, so the sweep must lie within it.
void check_sweep(const Robot& robot) {
  if (robot.tilt.fixed) return;
  const auto check = [&](const char* key, double angle_rad) {
    can::Frame frame;
    can::encode(robot.tilt_signal, angle_rad, frame);
    const double held_rad = can::decode(robot.tilt_signal, frame).value_or(0);
    if (std::abs(held_rad - angle_rad) <= std::abs(robot.tilt_signal.scale)) return;
    std::ostringstream what;
    what << robot.file << ": sweep." << key << " is " << angle_rad << "; expected an angle that tilt.signal holds, "
         << held_rad << (held_rad < angle_rad ? " at most" : " at least");
    throw BadInput(what.str());
  };
  check("from_rad", robot.sweep.from_rad);
  check("to_rad", robot.sweep.to_rad);
}

/// The last pose and the last beam are after the end.
double motion_until_s(const Robot& robot, std::optional<double> duration_s) {
  return duration_s.value_or(never_s) + simulated_margin_s + 1 / robot.scan_rate_hz;
}

double default_duration_s(const Robot& robot, const RobotMotion& motion) {
  if (motion.duration_s() > 0) {
    return motion.duration_s();
  }
  return robot.tilt.fixed ? 1.0 : robot.sweep.period_s;
}

}  // namespace

bool gives_poses(const Scene& scene, const Robot& robot) {
  return !scene.path.stands() || !robot.pose.still;
}

double sweep_angle_rad(const Sweep& sweep, double time_s) {
  const double half = sweep.period_s / 2, blend = 0.1 * half;
  const double phase = time_s - sweep.period_s * std::floor(time_s / sweep.period_s);
  const double t = phase < half ? phase : sweep.period_s - phase;
  const double whole = sweep.to_rad - sweep.from_rad, rate = whole / (half - blend);
  if (t < blend) {
    return sweep.from_rad + rate * t * t / (2 * blend);
  }
  if (t > half - blend) {
    return sweep.to_rad - rate * (half - t) * (half - t) / (2 * blend);
  }
  return sweep.from_rad + rate * (t - blend / 2);
}

Simulation::Simulation(const Scene& scene, const Robot& robot, std::uint64_t seed, std::optional<double> duration_s)
    : robot_(robot),
      scene_(in_map_frame(scene)),
      motion_(scene_, motion_until_s(robot, duration_s)),
      world_(scene_),
      laser_(robot.laser, robot.simulated, 3 * seed),
      tilt_random_(3 * seed + 1),
      pose_random_(3 * seed + 2),
      sweep_random_(~seed),
      jump_random_(~seed - 1),
      T_base_tilt_(transform(robot.tilt.T_base_tilt)),
      T_tilt_laser_(transform(robot.tilt.T_tilt_laser)),
      duration_s_(duration_s.value_or(default_duration_s(robot, motion_))),
      frame_stamp_s_(-never_s),
      ranges_m_(static_cast<std::size_t>(robot.laser.beams)) {
  check_sweep(robot);
  stamp_next_frame();
}

double Simulation::true_tilt_rad(double time_s) const {
  return robot_.tilt.fixed ? static_cast<double>(robot_.tilt.fixed_tilt_rad) : sweep_angle_rad(robot_.sweep, time_s);
}

std::optional<SimulatedEvent> Simulation::next() {
  const double last_s = duration_s_ + simulated_margin_s;
  const double pose_s = static_cast<double>(poses_) / robot_.simulated.pose_rate_hz - simulated_margin_s;
  const double line_due_s = line_end_s();
  const double pose_due_s = !gives_poses(scene_, robot_) || pose_s > last_s ? never_s : pose_s;
  const double frame_due_s = robot_.tilt.fixed || frame_stamp_s_ > last_s ? never_s : frame_stamp_s_;
  const double due_s = std::min({line_due_s, pose_due_s, frame_due_s});
  if (due_s == never_s) {
    return std::nullopt;
  }
  if (due_s == frame_due_s) {
    return take_frame();
  }
  return due_s == pose_due_s ? SimulatedEvent(take_pose()) : SimulatedEvent(take_line());
}

double Simulation::line_end_s() const {
  const double start_s = static_cast<double>(lines_) / robot_.scan_rate_hz;
  const double end_s = start_s + static_cast<double>(robot_.laser.beam_interval_s) * (robot_.laser.beams - 1);
  return start_s < duration_s_ - 1e-9 ? end_s : never_s;
}

ScanLine Simulation::take_line() {
  const double start_s = static_cast<double>(lines_++) / robot_.scan_rate_hz;
  for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
    const auto beam = static_cast<double>(i);
    const double t = start_s + beam * static_cast<double>(robot_.laser.beam_interval_s);
    world_.move_to(t);
    const Eigen::Isometry3d T_map_laser =
        motion_.T_map_base(t) * T_base_tilt_ * rotation(0, true_tilt_rad(t), 0) * T_tilt_laser_;
    const double bearing_rad =
        static_cast<double>(robot_.laser.first_bearing_rad) + beam * static_cast<double>(robot_.laser.bearing_step_rad);
    ranges_m_[i] = laser_.measure(world_, T_map_laser, bearing_rad);
  }
  return {stamp_ns(start_s), ranges_m_};
}

/// Jitter shifts the stamp, not the time of the angle; stamps never go back, as in a log.
void Simulation::stamp_next_frame() {
  const double due_s = static_cast<double>(frames_) / robot_.simulated.tilt_rate_hz - simulated_margin_s;
  const double stamp_s = due_s + robot_.simulated.tilt_jitter_s * tilt_random_.normal();
  frame_stamp_s_ = std::max(stamp_s, frame_stamp_s_ + 1e-6);
}

/// A drive that answers SYNC sends its position slightly later; the angle is that at the SYNC.
can::Frame Simulation::take_frame() {
  if (!robot_.tilt_sync_id || synced_) return take_position();
  can::Frame sync;
  sync.id = *robot_.tilt_sync_id;
  sync.time_ns = stamp_ns(frame_stamp_s_);
  frame_stamp_s_ += std::min(sync_answer_s, 0.3 / robot_.simulated.tilt_rate_hz);
  synced_ = true;
  return sync;
}

double Simulation::draw_tilt_latency_s(double time_s) {
  const double sweep = std::floor(2 * time_s / robot_.sweep.period_s);
  if (sweep != sweep_) sweep_latency_s_ = robot_.simulated.tilt_latency_sweep_sd_s * sweep_random_.normal();
  sweep_ = sweep;
  return static_cast<double>(robot_.tilt.latency_s) + robot_.simulated.tilt_latency_s + sweep_latency_s_;
}

can::Frame Simulation::take_position() {
  const double due_s = static_cast<double>(frames_) / robot_.simulated.tilt_rate_hz - simulated_margin_s;
  can::Frame frame;
  can::encode(robot_.tilt_signal, true_tilt_rad(due_s - draw_tilt_latency_s(due_s)), frame);
  frame.time_ns = stamp_ns(frame_stamp_s_);
  ++frames_;
  synced_ = false;
  stamp_next_frame();
  return frame;
}

SimulatedPose Simulation::take_pose() {
  const double t = static_cast<double>(poses_++) / robot_.simulated.pose_rate_hz - simulated_margin_s;
  const auto noise = [this](double sd) { return sd * pose_random_.normal(); };
  const double position = robot_.simulated.pose_position_sd_m, attitude = robot_.simulated.pose_attitude_sd_rad;
  SimulatedPose pose{stamp_ns(t), motion_.T_map_base(t)};
  const double dx = noise(position), dy = noise(position), dz = noise(position);
  pose.T_map_base.translation() += Eigen::Vector3d(dx, dy, dz);
  const double roll = noise(attitude), pitch = noise(attitude), yaw = noise(attitude);
  draw_jumps(t);
  pose.T_map_base.translation().z() += jumped_.z_m;
  pose.T_map_base = pose.T_map_base * rotation(roll + jumped_.roll_rad, pitch + jumped_.pitch_rad, yaw);
  return pose;
}

void Simulation::draw_jumps(double time_s) {
  const SimulatedErrors& errors = robot_.simulated;
  if (errors.pose_jump_every_s == 0) return;
  const auto up_or_down = [this](double by) { return jump_random_.uniform() < 0.5 ? -by : by; };
  for (; time_s >= static_cast<double>(jumped_.times + 1) * errors.pose_jump_every_s; ++jumped_.times) {
    jumped_.z_m += up_or_down(errors.pose_jump_height_m);
    jumped_.roll_rad += up_or_down(errors.pose_jump_attitude_rad);
    jumped_.pitch_rad += up_or_down(errors.pose_jump_attitude_rad);
  }
}

}  // namespace curbline::tools
