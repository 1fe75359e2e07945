#include "simulator/robot_motion.hpp"

#include "formats/bad_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

namespace curbline::tools {
namespace {

constexpr double step_s = 0.01;
constexpr double wheelbase_m = 0.5, track_m = 0.4, wheel_radius_m = 0.15;
constexpr double tread_step_m = 0.01;  // spacing of the ground samples under a wheel

constexpr double abyss_m = -std::numeric_limits<double>::infinity();  // height of the void

double height_m(const GroundPlan& plan, Point2 at) {
  const int region = plan.region_at(at);
  return region < 0 ? abyss_m : plan.regions()[static_cast<std::size_t>(region)].plane.height_m(at);
}

/// The ground under the wheels of one side of a robot that drives straight on for length_m.
class Tread {
 public:
  Tread(const GroundPlan& plan, Point2 from, double yaw_rad, double left_m, double length_m) {
    const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
    const auto places = static_cast<int>(std::ceil((length_m + 2 * reach_m) / tread_step_m)) + 1;
    for (int i = 0; i < places; ++i) {
      const double ahead = tread_step_m * i - reach_m;
      ground_m_.push_back(height_m(plan, {from.x + c * ahead - s * left_m, from.y + s * ahead + c * left_m}));
    }
  }

  /// Height of a wheel whose hub is `ahead_m` along the path: no point of its rim is below the ground.
  double wheel_m(double ahead_m) const {
    const double hub_m = ahead_m + reach_m;
    double highest_m = abyss_m;
    for (auto i = static_cast<std::size_t>(std::ceil((hub_m - wheel_radius_m) / tread_step_m)); i < ground_m_.size();
         ++i) {
      const double before_hub_m = tread_step_m * static_cast<double>(i) - hub_m;
      if (before_hub_m > wheel_radius_m) break;
      const double rim_m = wheel_radius_m - std::sqrt(wheel_radius_m * wheel_radius_m - before_hub_m * before_hub_m);
      highest_m = std::max(highest_m, ground_m_[i] - rim_m);
    }
    return highest_m;
  }

 private:
  static constexpr double reach_m = wheelbase_m / 2 + wheel_radius_m + tread_step_m;  // from the robot's middle
  std::vector<double> ground_m_;
};

/// A straight path from a place.
class Way {
 public:
  Way(const Scene& scene, const GroundPlan& plan, Point2 from, double yaw_rad, double length_m)
      : scene_(scene),
        from_(from),
        yaw_rad_(yaw_rad),
        sides_{Tread(plan, from, yaw_rad, track_m / 2, length_m), Tread(plan, from, yaw_rad, -track_m / 2, length_m)} {}

  /// How the four wheels stand; a wheel over the void takes the height of the other on its side.
  Footing footing(double ahead_m) const {
    std::array<double, 2> height{}, along{};
    for (std::size_t side = 0; side < 2; ++side) {
      double front_m = sides_[side].wheel_m(ahead_m + wheelbase_m / 2);
      double rear_m = sides_[side].wheel_m(ahead_m - wheelbase_m / 2);
      if (front_m == abyss_m) front_m = rear_m;
      if (rear_m == abyss_m) rear_m = front_m;
      if (front_m == abyss_m) stands_on_nothing(ahead_m);
      height[side] = (front_m + rear_m) / 2;
      along[side] = (front_m - rear_m) / wheelbase_m;
    }
    return {(height[0] + height[1]) / 2, (along[0] + along[1]) / 2, (height[0] - height[1]) / track_m};
  }

 private:
  [[noreturn]] void stands_on_nothing(double ahead_m) const {
    std::ostringstream what;
    what << scene_.file << ": the robot stands on nothing at x " << from_.x + std::cos(yaw_rad_) * ahead_m << " y "
         << from_.y + std::sin(yaw_rad_) * ahead_m << "; expected [ground] or a [[region]] there";
    throw BadInput(what.str());
  }

  const Scene& scene_;
  Point2 from_;
  double yaw_rad_;
  std::array<Tread, 2> sides_;  ///< left, right
};

Footing standing(const Scene& scene, const GroundPlan& plan, Point2 at, double yaw_rad) {
  return Way(scene, plan, at, yaw_rad, 0).footing(0);
}

}  // namespace

Scene in_map_frame(const Scene& scene) {
  if (!scene.path.stands()) {
    return scene;
  }
  const Point2 at = scene.path.waypoints.front();
  const double c = std::cos(scene.path.yaw_rad), s = std::sin(scene.path.yaw_rad);
  const double z = standing(scene, GroundPlan(scene.regions), at, scene.path.yaw_rad).z_m;
  const auto turn_back = [&](Point2 p) { return Point2{c * p.x + s * p.y, -s * p.x + c * p.y}; };
  Scene out = scene;
  for (GroundRegion& region : out.regions) {
    for (Point2& p : region.outline) p = turn_back(p - at);
    const SurfacePlane& plane = region.plane;
    const Point2 slope = turn_back({plane.sx, plane.sy}), crown = plane.camber.crown;
    region.plane = {plane.level_m(at) - z,
                    slope.x,
                    slope.y,
                    {plane.camber.bend_1_m, turn_back(crown - at), turn_back(plane.camber.across)}};
  }
  for (Obstacle& obstacle : out.obstacles) {
    for (Point2& p : obstacle.outline) p = turn_back(p - at);
    obstacle.velocity_m_s = turn_back(obstacle.velocity_m_s);
    if (obstacle.base_m) *obstacle.base_m -= z;
  }
  out.path = RobotPath{};
  return out;
}

RobotMotion::RobotMotion(const Scene& scene, double until_s) : until_s_(until_s) {
  const GroundPlan plan(scene.regions);
  const std::vector<Leg> way = legs(scene.path);
  const Point2 begin = scene.path.waypoints.front();
  const double yaw_rad = way.empty() ? scene.path.yaw_rad : way.front().from_rad;
  samples_.push_back(sample(scene, begin, yaw_rad, standing(scene, plan, begin, yaw_rad)));
  for (const Leg& leg : way) {
    turn(scene, plan, leg);
    drive(scene, plan, leg);
  }
}

RobotMotion::Sample RobotMotion::sample(const Scene& scene, Point2 at, double yaw_rad, const Footing& ground) {
  if (!scene.path.follows_terrain) {
    return {at.x, at.y, ground.z_m, 0, 0, yaw_rad};
  }
  return {at.x, at.y, ground.z_m, std::atan(ground.across), -std::atan(ground.along), yaw_rad};
}

void RobotMotion::turn(const Scene& scene, const GroundPlan& plan, const Leg& leg) {
  const double whole_rad = leg.to_rad - leg.from_rad;
  const double steps = std::ceil(std::abs(whole_rad) / (scene.path.turn_rate_rad_s * step_s));
  for (double i = 1; i <= steps && duration_s() < until_s_; ++i) {
    const double yaw_rad = leg.from_rad + whole_rad * i / steps;
    samples_.push_back(sample(scene, leg.from, yaw_rad, standing(scene, plan, leg.from, yaw_rad)));
  }
}

void RobotMotion::drive(const Scene& scene, const GroundPlan& plan, const Leg& leg) {
  const Point2 whole = leg.to - leg.from;
  const double length_m = length(whole);
  const double steps = std::ceil(length_m / (scene.path.speed_m_s * step_s));
  const double time_left_s = until_s_ - duration_s() + step_s;
  const Way way(scene, plan, leg.from, leg.to_rad,
                std::min(length_m, scene.path.speed_m_s * std::max(0.0, time_left_s)));
  for (double i = 1; i <= steps && duration_s() < until_s_; ++i) {
    const double t = i / steps;
    samples_.push_back(sample(scene, leg.from + t * whole, leg.to_rad, way.footing(t * length_m)));
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
