// A scene: the ground as planes over polygons, obstacles that stand or move on it, and the robot's path. Read from a
// TOML file (tools/scenes/README.md lists the keys); metres, radians, seconds, z up.
//
// The height of the ground is that of the last region that contains a point; a point in no region is void and returns
// no beam. Where two regions meet at different heights, a vertical face joins them. Obstacles are upright prisms.
#pragma once

#include "map/polygon.hpp"

#include <optional>
#include <string>
#include <vector>

namespace curbline::tools {

/// A road falls on both sides of its crown, by half the camber times the squared distance from the crown.
struct Camber {
  double bend_1_m = 0;  ///< 0: none
  Point2 crown;         ///< a point of the crown
  Point2 across;        ///< unit vector across the crown
  double away_m(Point2 p) const { return dot(across, p - crown); }
};

/// z = z0 + sx x + sy y, minus the camber's fall.
struct SurfacePlane {
  double z0_m = 0, sx = 0, sy = 0;
  Camber camber{};
  double level_m(Point2 p) const { return z0_m + sx * p.x + sy * p.y; }  ///< without the camber
  double height_m(Point2 p) const {
    const double away_m = camber.away_m(p);
    return level_m(p) - 0.5 * camber.bend_1_m * away_m * away_m;
  }
  Point2 slope(Point2 p) const {
    const double falls = camber.bend_1_m * camber.away_m(p);
    return {sx - falls * camber.across.x, sy - falls * camber.across.y};
  }
};

/// A part of the ground. Unbounded without an outline.
struct GroundRegion {
  std::string name;
  Polygon outline;
  SurfacePlane plane;
  bool holds(Point2 p) const { return outline.empty() || contains(outline, p); }
};

/// An upright prism: box, wall, post, person, car.
struct Obstacle {
  std::string name;
  Polygon outline;  ///< footprint at time 0: convex, counterclockwise
  double height_m = 1;
  std::optional<double> base_m;  ///< z of its underside; if empty, it stands on the ground below its centre
  Point2 velocity_m_s;
  bool moves() const { return velocity_m_s.x != 0 || velocity_m_s.y != 0; }
};

/// A single waypoint is a robot that stands. Otherwise it drives along the legs in turn and turns on the spot between
/// them.
struct RobotPath {
  std::vector<Point2> waypoints{{0, 0}};
  double yaw_rad = 0;  ///< of a robot that stands
  double speed_m_s = 1;
  double turn_rate_rad_s = 0.6;
  bool follows_terrain = false;  ///< true: pitch and roll follow the ground; false: the base stays level
  bool stands() const { return waypoints.size() == 1; }
};

inline constexpr double longest_s = 86'400;  ///< duration of a simulation

/// To the next waypoint: a turn on the spot, then straight on.
struct Leg {
  Point2 from, to;
  double from_rad, to_rad;  ///< yaw before and after the turn
};
std::vector<Leg> legs(const RobotPath& path);

struct Scene {
  std::string file;    ///< where it was read from, for messages
  std::string source;  ///< its text, to be copied beside the simulated data
  std::vector<GroundRegion> regions;
  std::vector<Obstacle> obstacles;
  RobotPath path;
};

/// Reads a scene file. Throws BadInput with file, line and key: an unknown key, a wrong type, a polygon that crosses
/// itself.
Scene read_scene(const std::string& path);

/// The same for text that has been read; messages name it `file`.
Scene parse_scene(const std::string& text, const std::string& file);

/// The same for a file (a name with '/' or ending in .toml), the name of a scene that ships, random:SEED or
/// random-drive:SEED.
Scene find_scene(const std::string& name_or_path);

/// Names of the scenes that ship, sorted.
std::vector<std::string> shipped_scenes();

}  // namespace curbline::tools
