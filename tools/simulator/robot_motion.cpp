#include "simulator/robot_motion.hpp"

#include "formats/bad_input.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace curbline::tools {
namespace {

constexpr double step_s = 0.01;
constexpr double wheelbase_m = 0.5, track_m = 0.4;
constexpr int feet = 11;  // points of the wheelbase at which the ground is felt, on either side

struct Footing {
  double z_m, along, across;  // height under the middle, slope ahead, slope to the left
};

/// Mean height and slopes of the ground under the wheels; points in the void are left out.
Footing footing(const Scene& scene, Point2 at, double yaw_rad) {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  double n[2] = {}, z[2] = {}, n_all = 0, u = 0, uu = 0, uz = 0;
  for (int side = 0; side < 2; ++side) {
    for (int i = 0; i < feet; ++i) {
      const double ahead = wheelbase_m * (i / (feet - 1.0) - 0.5), left = track_m * (side - 0.5);
      const Point2 foot{at.x + c * ahead - s * left, at.y + s * ahead + c * left};
      const int region = region_at(scene.regions, foot);
      if (region >= 0) {
        const double height = scene.regions[static_cast<std::size_t>(region)].plane.height_m(foot);
        ++n[side], ++n_all, z[side] += height, u += ahead, uu += ahead * ahead, uz += ahead * height;
      }
    }
  }
  if (n[0] == 0 || n[1] == 0) {
    std::ostringstream what;
    what << scene.file << ": the robot stands on nothing at x " << at.x << " y " << at.y
         << "; expected [ground] or a [[region]] there";
    throw BadInput(what.str());
  }
  const double mean = (z[0] + z[1]) / n_all;
  return {mean, (uz - u * mean) / (uu - u * u / n_all), (z[1] / n[1] - z[0] / n[0]) / track_m};
}

}  // namespace

Scene in_map_frame(const Scene& scene) {
  if (!scene.path.stands()) {
    return scene;
  }
  const Point2 at = scene.path.waypoints.front();
  const double c = std::cos(scene.path.yaw_rad), s = std::sin(scene.path.yaw_rad);
  const double z = footing(scene, at, scene.path.yaw_rad).z_m;
  const auto turn_back = [&](Point2 p) { return Point2{c * p.x + s * p.y, -s * p.x + c * p.y}; };
  Scene out = scene;
  for (GroundRegion& region : out.regions) {
    for (Point2& p : region.outline) p = turn_back({p.x - at.x, p.y - at.y});
    const Point2 slope = turn_back({region.plane.sx, region.plane.sy});
    region.plane = {region.plane.height_m(at) - z, slope.x, slope.y};
  }
  for (Obstacle& obstacle : out.obstacles) {
    for (Point2& p : obstacle.outline) p = turn_back({p.x - at.x, p.y - at.y});
    obstacle.velocity_m_s = turn_back(obstacle.velocity_m_s);
    if (obstacle.base_m) *obstacle.base_m -= z;
  }
  out.path = RobotPath{};
  return out;
}

RobotMotion::RobotMotion(const Scene& scene, double until_s) : until_s_(until_s) {
  const std::vector<Leg> way = legs(scene.path);
  const double yaw_rad = way.empty() ? scene.path.yaw_rad : way.front().from_rad;
  samples_.push_back(on_ground(scene, scene.path.waypoints.front(), yaw_rad));
  for (const Leg& leg : way) {
    turn(scene, leg);
    drive(scene, leg);
  }
}

RobotMotion::Sample RobotMotion::on_ground(const Scene& scene, Point2 at, double yaw_rad) const {
  const Footing ground = footing(scene, at, yaw_rad);
  if (!scene.path.follows_terrain) {
    return {at.x, at.y, ground.z_m, 0, 0, yaw_rad};
  }
  return {at.x, at.y, ground.z_m, std::atan(ground.across), -std::atan(ground.along), yaw_rad};
}

void RobotMotion::turn(const Scene& scene, const Leg& leg) {
  const double whole_rad = leg.to_rad - leg.from_rad;
  const double steps = std::ceil(std::abs(whole_rad) / (scene.path.turn_rate_rad_s * step_s));
  for (double i = 1; i <= steps && duration_s() < until_s_; ++i) {
    samples_.push_back(on_ground(scene, leg.from, leg.from_rad + whole_rad * i / steps));
  }
}

void RobotMotion::drive(const Scene& scene, const Leg& leg) {
  const double dx = leg.to.x - leg.from.x, dy = leg.to.y - leg.from.y;
  const double steps = std::ceil(std::hypot(dx, dy) / (scene.path.speed_m_s * step_s));
  for (double i = 1; i <= steps && duration_s() < until_s_; ++i) {
    const double t = i / steps;
    samples_.push_back(on_ground(scene, {leg.from.x + t * dx, leg.from.y + t * dy}, leg.to_rad));
  }
}

double RobotMotion::duration_s() const {
  return step_s * static_cast<double>(samples_.size() - 1);
}

Eigen::Isometry3d RobotMotion::T_map_base(double time_s) const {
  const double place = std::clamp(time_s / step_s, 0.0, static_cast<double>(samples_.size() - 1));
  const auto i = static_cast<std::size_t>(place);
  const Sample& a = samples_[i];
  const Sample& b = samples_[std::min(i + 1, samples_.size() - 1)];
  const double t = place - static_cast<double>(i);
  const auto mix = [t](double from, double to) { return from + t * (to - from); };
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = (Eigen::AngleAxisd(mix(a.yaw, b.yaw), Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(mix(a.pitch, b.pitch), Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(mix(a.roll, b.roll), Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = Eigen::Vector3d(mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z));
  return pose;
}

}  // namespace curbline::tools
