// A scene file to a Scene: tools/scenes/README.md is the manual of its keys.
#include "simulator/scene.hpp"
#include "simulator/scene_table.hpp"

#include <Eigen/LU>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>

namespace curbline::tools {
namespace {

constexpr double rad = std::numbers::pi / 180;

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

Repeat read_repeat(SceneTable& owner) {
  Repeat repeat;
  if (!owner.has("repeat")) {
    return repeat;
  }
  SceneTable table = owner.table("repeat");
  const std::vector<double> count = table.numbers("count", 2), step = table.numbers("step", 2);
  for (const double n : count) {
    if (n != std::floor(n) || n < 1 || n > 100) {
      table.refuse("count", "not two whole numbers from 1 to 100");
    }
  }
  repeat = {static_cast<int>(count[0]), static_cast<int>(count[1]), step[0], step[1]};
  table.done();
  return repeat;
}

Polygon read_outline(SceneTable& table) {
  if (table.has("polygon") + table.has("rectangle") + table.has("circle") != 1) {
    table.refuse("polygon", "expected exactly one of polygon, rectangle and circle");
  }
  if (table.has("circle")) {
    const std::vector<double> c = table.numbers("circle", 3);
    if (!(c[2] > 0)) {
      table.refuse("circle", "radius not above 0; expected [x, y, radius]");
    }
    return circle({c[0], c[1]}, c[2]);
  }
  if (table.has("rectangle")) {
    const std::vector<double> r = table.numbers("rectangle", 4);
    if (!(r[0] < r[2] && r[1] < r[3])) {
      table.refuse("rectangle", "no area; expected [x0, y0, x1, y1] with x0 < x1 and y0 < y1");
    }
    return rectangle({r[0], r[1]}, {r[2], r[3]});
  }
  Polygon polygon = table.points("polygon", 3);
  if (!is_simple(polygon)) {
    table.refuse("polygon", "crosses or touches itself, or has no area");
  }
  return polygon;
}

/// The plane through three corners at their heights.
SurfacePlane plane_through(const Polygon& corners, const std::vector<double>& z) {
  Eigen::Matrix3d rows;
  for (int i = 0; i < 3; ++i) {
    const Point2 corner = corners[static_cast<std::size_t>(i)];
    rows.row(i) << 1, corner.x, corner.y;
  }
  const Eigen::Vector3d w = rows.inverse() * Eigen::Vector3d(z[0], z[1], z[2]);
  return {w[0], w[1], w[2]};
}

SurfacePlane read_plane(SceneTable& table, const Polygon& corners) {
  if (table.has("corner_z")) {
    if (corners.empty() || table.has("circle") || table.has("z") || table.has("slope")) {
      table.refuse("corner_z", "expected a polygon or a rectangle, and neither z nor slope beside it");
    }
    return plane_through(corners, table.numbers("corner_z", 3));
  }
  SurfacePlane plane{table.required_number("z"), 0, 0};
  if (table.has("slope")) {
    const std::vector<double> slope = table.numbers("slope", 2);
    plane.sx = slope[0];
    plane.sy = slope[1];
  }
  return plane;
}

void read_region(SceneTable& table, Scene& scene) {
  const std::string name = table.text("name", "region " + std::to_string(scene.regions.size()));
  Polygon outline = read_outline(table);
  const SurfacePlane plane = read_plane(table, outline);
  if (table.has("corner_radius")) {
    outline = with_round_corners(outline, table.required_positive("corner_radius"));
  }
  read_repeat(table).each([&](Point2 by) {
    const SurfacePlane here{plane.z0_m - plane.sx * by.x - plane.sy * by.y, plane.sx, plane.sy};
    scene.regions.push_back({name, moved(outline, by), here});
  });
  table.done();
}

/// What boxes, cylinders and walls have in common.
void read_obstacle(SceneTable& table, const char* kind, const Polygon& outline, Scene& scene) {
  Obstacle obstacle;
  obstacle.name = table.text("name", kind);
  obstacle.height_m = table.required_positive("height");
  if (table.has("z")) {
    obstacle.base_m = table.required_number("z");
  }
  obstacle.velocity_m_s = table.point("velocity", {0, 0});
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

void read_box(SceneTable& table, Scene& scene) {
  const std::vector<double> at = table.numbers("at", 2), size = table.numbers("size", 2);
  if (!(size[0] > 0 && size[1] > 0)) {
    table.refuse("size", "not above 0; expected [length, width]");
  }
  const double yaw_rad = table.number("yaw_deg", 0) * rad;
  read_obstacle(table, "box", turned_rectangle({at[0], at[1]}, size[0], size[1], yaw_rad), scene);
}

void read_cylinder(SceneTable& table, Scene& scene) {
  const std::vector<double> at = table.numbers("at", 2);
  read_obstacle(table, "cylinder", circle({at[0], at[1]}, table.required_positive("radius")), scene);
}

void read_wall(SceneTable& table, Scene& scene) {
  const std::vector<double> a = table.numbers("from", 2), b = table.numbers("to", 2);
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
  if (!(length > 0)) {
    table.refuse("to", "the same point as from");
  }
  const Point2 middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
  const double yaw_rad = std::atan2(b[1] - a[1], b[0] - a[0]);
  const double thickness = table.positive("thickness", 0.2);
  read_obstacle(table, "wall", turned_rectangle(middle, length, thickness, yaw_rad), scene);
}

RobotPath read_path(SceneTable table) {
  RobotPath path;
  if (table.has("path")) {
    path.waypoints = table.points("path", 2);
    for (std::size_t i = 1; i < path.waypoints.size(); ++i) {
      const Point2 a = path.waypoints[i - 1], b = path.waypoints[i];
      if (std::hypot(b.x - a.x, b.y - a.y) < 0.01) {
        table.refuse("path", "two way points closer than 1 cm");
      }
    }
    path.speed_m_s = table.positive("speed", path.speed_m_s);
    path.turn_rate_rad_s = table.positive("turn_rate_deg_s", path.turn_rate_rad_s / rad) * rad;
    const std::string attitude = table.text("attitude", "level");
    if (attitude != "level" && attitude != "terrain") {
      table.refuse("attitude", "expected \"level\" or \"terrain\"");
    }
    path.follows_terrain = attitude == "terrain";
  } else {
    path.waypoints = {table.point("at", {0, 0})};
    path.yaw_rad = table.number("yaw_deg", 0) * rad;
  }
  table.done();
  return path;
}

Scene read_tables(SceneTable root, std::string file, std::string source) {
  Scene scene;
  scene.file = std::move(file);
  scene.source = std::move(source);
  root.text("about", "");
  if (root.has("ground")) {
    SceneTable ground = root.table("ground");
    scene.regions.push_back({"ground", {}, read_plane(ground, {})});
    ground.done();
  }
  for (SceneTable& table : root.tables("region")) read_region(table, scene);
  for (SceneTable& table : root.tables("box")) read_box(table, scene);
  for (SceneTable& table : root.tables("cylinder")) read_cylinder(table, scene);
  for (SceneTable& table : root.tables("wall")) read_wall(table, scene);
  scene.path = read_path(root.table("robot"));
  if (scene.regions.empty()) {
    root.refuse("region", "no ground; expected [ground] or [[region]]");
  }
  root.done();
  return scene;
}

}  // namespace

Scene read_scene(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string source{std::istreambuf_iterator<char>(in), {}};
  if (!in || source.empty()) {
    throw BadInput(path + ": cannot be read, or is empty; expected a scene in TOML");
  }
  try {
    const toml::table root = toml::parse(source, path);
    return read_tables({root, path}, path, source);
  } catch (const toml::parse_error& error) {
    throw BadInput(path, static_cast<long>(error.source().begin.line), std::string(error.description()));
  }
}

}  // namespace curbline::tools
