// Reads a scene file; tools/scenes/README.md documents its keys.
#include "formats/bad_input.hpp"
#include "formats/toml_table.hpp"
#include "simulator/scene.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace curbline::tools {
namespace {

constexpr double rad = std::numbers::pi / 180;
constexpr Range any{-1e5, 1e5};  // metres, metres per second or degrees: values beyond are taken for typing errors
constexpr Range positive{1e-6, 1e5};

struct Repeat {
  int count_x = 1, count_y = 1;
  double step_x_m = 0, step_y_m = 0;

  template <typename Do>
  void each(Do call) const {
    for (int i = 0; i < count_x; ++i) {
      for (int j = 0; j < count_y; ++j) {
        call(Point2{i * step_x_m, j * step_y_m});
      }
    }
  }
};

/// (0, 0) if absent.
Point2 read_point(TomlTable& table, const char* key) {
  if (!table.has(key)) return {};
  const std::vector<double> xy = table.numbers(key, 2, any);
  return {xy[0], xy[1]};
}

/// 0 if absent.
double read_angle_rad(TomlTable& table, const char* key) {
  double degrees = 0;
  table.read(key, degrees, any);
  return degrees * rad;
}

Repeat read_repeat(TomlTable& owner) {
  Repeat repeat;
  if (!owner.has("repeat")) {
    return repeat;
  }
  TomlTable table = owner.table("repeat");
  const std::vector<double> count = table.numbers("count", 2, {1, 100}), step = table.numbers("step", 2, any);
  for (const double n : count) {
    if (n != std::floor(n)) table.refuse("count", "has a fraction; expected two whole numbers from 1 to 100");
  }
  if ((count[0] > 1 && step[0] == 0) || (count[1] > 1 && step[1] == 0))
    table.refuse("step", "puts copies in one place; expected one other than 0 wherever the count is above 1");
  repeat = {static_cast<int>(count[0]), static_cast<int>(count[1]), step[0], step[1]};
  table.done();
  return repeat;
}

Polygon read_outline(TomlTable& table) {
  if (table.has("polygon") + table.has("rectangle") + table.has("circle") != 1) {
    table.refuse("polygon",
                 "is one outline of several, or there is none; expected exactly one of polygon, rectangle and circle");
  }
  if (table.has("circle")) {
    const std::vector<double> c = table.numbers("circle", 3, any);
    if (!(c[2] > 0)) table.refuse("circle", "has no area; expected [x, y, radius] with a radius above 0");
    return circle({c[0], c[1]}, c[2]);
  }
  if (table.has("rectangle")) {
    const std::vector<double> r = table.numbers("rectangle", 4, any);
    if (!(r[0] < r[2] && r[1] < r[3])) {
      table.refuse("rectangle", "has no area; expected [x0, y0, x1, y1] with x0 < x1 and y0 < y1");
    }
    return rectangle({r[0], r[1]}, {r[2], r[3]});
  }
  Polygon polygon = table.points("polygon", 3, any);
  if (!is_simple(polygon)) {
    table.refuse("polygon", "crosses or touches itself, or has no area; expected corners in order");
  }
  return polygon;
}

/// Whether the first three corners lie on one line, and so fix no plane.
bool first_on_one_line(const Polygon& corners) {
  const Point2 a = corners[1] - corners[0], b = corners[2] - corners[0];
  return std::abs(cross(a, b)) <= 1e-9 * length(a) * length(b);
}

/// The plane through three corners with given heights.
SurfacePlane plane_through(const Polygon& corners, const std::vector<double>& z) {
  Eigen::Matrix3d rows;
  for (int i = 0; i < 3; ++i) {
    const Point2 corner = corners[static_cast<std::size_t>(i)];
    rows.row(i) << 1, corner.x, corner.y;
  }
  const Eigen::Vector3d w = rows.inverse() * Eigen::Vector3d(z[0], z[1], z[2]);
  return {w[0], w[1], w[2], {}};
}

SurfacePlane read_level(TomlTable& table, const Polygon& corners) {
  if (table.has("corner_z")) {
    if (corners.empty() || table.has("circle") || table.has("z") || table.has("slope")) {
      table.refuse("corner_z", "does not fit; expected a polygon or a rectangle, and neither z nor slope beside it");
    }
    if (first_on_one_line(corners)) {
      table.refuse("corner_z", "is of corners on one line; expected the first three corners of the polygon not to be");
    }
    return plane_through(corners, table.numbers("corner_z", 3, any));
  }
  SurfacePlane plane{table.number("z", any), 0, 0, {}};
  if (table.has("slope")) {
    const std::vector<double> slope = table.numbers("slope", 2, any);
    plane.sx = slope[0];
    plane.sy = slope[1];
  }
  return plane;
}

/// Requires both of its keys, or neither.
Camber read_camber(TomlTable& table) {
  if (!table.has("camber") && !table.has("crown")) return {};
  const double bend_1_m = table.number("camber", {-1, 1});
  const std::vector<Point2> crown = table.points("crown", 2, any);
  const Point2 along = crown[1] - crown[0];
  const double length_m = length(along);
  if (crown.size() != 2 || !(length_m > 0)) table.refuse("crown", "is no line; expected two points of it");
  return {bend_1_m, crown[0], {-along.y / length_m, along.x / length_m}};
}

SurfacePlane read_plane(TomlTable& table, const Polygon& corners) {
  SurfacePlane plane = read_level(table, corners);
  plane.camber = read_camber(table);
  return plane;
}

void read_region(TomlTable& table, Scene& scene) {
  std::string name = "region " + std::to_string(scene.regions.size());
  table.read("name", name);
  Polygon outline = read_outline(table);
  const SurfacePlane plane = read_plane(table, outline);
  if (table.has("corner_radius")) {
    outline = with_round_corners(outline, table.number("corner_radius", positive));
  }
  read_repeat(table).each([&](Point2 by) {
    SurfacePlane here = plane;
    here.z0_m -= plane.sx * by.x + plane.sy * by.y;
    here.camber.crown = plane.camber.crown + by;
    scene.regions.push_back({name, moved(outline, by), here});
  });
  table.done();
}

/// What boxes, cylinders and walls have in common.
void read_obstacle(TomlTable& table, const char* kind, const Polygon& outline, Scene& scene) {
  Obstacle obstacle;
  obstacle.name = kind;
  table.read("name", obstacle.name);
  obstacle.height_m = table.number("height", positive);
  if (table.has("z")) {
    obstacle.base_m = table.number("z", any);
  }
  obstacle.velocity_m_s = read_point(table, "velocity");
  read_repeat(table).each([&](Point2 by) {
    obstacle.outline = moved(outline, by);
    scene.obstacles.push_back(obstacle);
  });
  table.done();
}

Polygon turned_rectangle(Point2 centre, double length_m, double width_m, double yaw_rad) {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  Polygon out = rectangle({-length_m / 2, -width_m / 2}, {length_m / 2, width_m / 2});
  for (Point2& p : out) {
    p = {centre.x + c * p.x - s * p.y, centre.y + s * p.x + c * p.y};
  }
  return out;
}

void read_box(TomlTable& table, Scene& scene) {
  const std::vector<double> at = table.numbers("at", 2, any), size = table.numbers("size", 2, positive);
  const double yaw_rad = read_angle_rad(table, "yaw_deg");
  read_obstacle(table, "box", turned_rectangle({at[0], at[1]}, size[0], size[1], yaw_rad), scene);
}

void read_cylinder(TomlTable& table, Scene& scene) {
  const std::vector<double> at = table.numbers("at", 2, any);
  read_obstacle(table, "cylinder", circle({at[0], at[1]}, table.number("radius", positive)), scene);
}

void read_wall(TomlTable& table, Scene& scene) {
  const std::vector<double> a = table.numbers("from", 2, any), b = table.numbers("to", 2, any);
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
  if (!(length > 0)) table.refuse("to", "is the same point as from; expected another");
  const Point2 middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
  const double yaw_rad = std::atan2(b[1] - a[1], b[0] - a[0]);
  double thickness = 0.2;
  table.read("thickness", thickness, positive);
  read_obstacle(table, "wall", turned_rectangle(middle, length, thickness, yaw_rad), scene);
}

double duration_s(const RobotPath& path) {
  double out = 0;
  for (const Leg& leg : legs(path)) {
    out += std::abs(leg.to_rad - leg.from_rad) / path.turn_rate_rad_s + length(leg.to - leg.from) / path.speed_m_s;
  }
  return out;
}

/// The path of a robot that drives.
RobotPath read_drive(TomlTable& table) {
  for (const char* standing : {"at", "yaw_deg"}) {
    if (table.has(standing)) table.refuse(standing, "is beside path; expected one of the two: a path implies it");
  }
  RobotPath path;
  path.waypoints = table.points("path", 2, any);
  for (std::size_t i = 1; i < path.waypoints.size(); ++i) {
    if (length(path.waypoints[i] - path.waypoints[i - 1]) < 0.01) {
      table.refuse("path", "has two way points in a row at one place; expected 1 cm between them or more");
    }
  }
  table.read("speed", path.speed_m_s, positive);
  double turn_rate_deg_s = path.turn_rate_rad_s / rad;
  table.read("turn_rate_deg_s", turn_rate_deg_s, positive);
  path.turn_rate_rad_s = turn_rate_deg_s * rad;
  std::string attitude = "level";
  table.read("attitude", attitude);
  if (attitude != "level" && attitude != "terrain") {
    table.refuse_word("attitude", attitude, "level or terrain");
  }
  path.follows_terrain = attitude == "terrain";
  if (const double whole_s = duration_s(path); whole_s > longest_s) {
    table.refuse("path", "takes " + std::to_string(std::llround(whole_s)) + " s; expected a day at most");
  }
  return path;
}

RobotPath read_stand(TomlTable& table) {
  for (const char* driving : {"speed", "turn_rate_deg_s", "attitude"}) {
    if (table.has(driving)) table.refuse(driving, "is without path; expected robot.path beside it");
  }
  RobotPath path;
  path.waypoints = {read_point(table, "at")};
  path.yaw_rad = read_angle_rad(table, "yaw_deg");
  return path;
}

RobotPath read_path(TomlTable table) {
  const RobotPath path = table.has("path") ? read_drive(table) : read_stand(table);
  table.done();
  return path;
}

Scene read_tables(TomlTable root) {
  Scene scene;
  std::string about;
  root.read("about", about);
  if (root.has("ground")) {
    TomlTable ground = root.table("ground");
    scene.regions.push_back({"ground", {}, read_plane(ground, {})});
    ground.done();
  }
  for (TomlTable& table : root.tables("region")) read_region(table, scene);
  for (TomlTable& table : root.tables("box")) read_box(table, scene);
  for (TomlTable& table : root.tables("cylinder")) read_cylinder(table, scene);
  for (TomlTable& table : root.tables("wall")) read_wall(table, scene);
  scene.path = read_path(root.table("robot"));
  root.done();
  if (scene.regions.empty()) root.refuse("region", "is missing: no ground; expected [ground] or [[region]]");
  return scene;
}

}  // namespace

Scene parse_scene(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  Scene scene = read_tables({root, "", file});
  scene.file = file;
  scene.source = text;
  return scene;
}

Scene read_scene(const std::string& path) {
  return parse_scene(read_toml_text(path, "a scene"), path);
}

}  // namespace curbline::tools
