#include "simulator/random_street.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/decimals.hpp"
#include "map/polygon.hpp"
#include "simulator/random.hpp"

namespace curbline::tools {
namespace {

constexpr double far_m = 16;          // extent of what is drawn
constexpr double robot_room_m = 0.9;  // minimum distance to obstacles
constexpr double curb_room_m = 0.35;  // minimum distance to curbs

/// Height z + su u + sv v. The street's own coordinates: u along the main curb, v from the road to the pavement.
struct Surface {
  double z = 0, su = 0, sv = 0;
  double at(Point2 p) const { return z + su * p.x + sv * p.y; }
  Surface raised(double by) const { return {z + by, su, sv}; }
};

/// The surface through three points with given heights.
Surface through(const Point2 (&p)[3], const double (&z)[3]) {
  const double ax = p[1].x - p[0].x, ay = p[1].y - p[0].y, bx = p[2].x - p[0].x, by = p[2].y - p[0].y;
  const double det = ax * by - ay * bx, dz1 = z[1] - z[0], dz2 = z[2] - z[0];
  const double su = (dz1 * by - dz2 * ay) / det, sv = (ax * dz2 - bx * dz1) / det;
  return {z[0] - su * p[0].x - sv * p[0].y, su, sv};
}

class Street {
 public:
  Street(std::uint64_t seed, StreetRobot robot) : random_(seed), half_way_m_(robot == StreetRobot::drives ? 3 : 0) {}

  std::string text(std::uint64_t seed) {
    stand_beside_the_curb();
    const double kind = random_.uniform();
    std::string about;
    if (kind < 1.0 / 3) {
      about = "a straight street";
      draw_straight();
    } else if (kind < 2.0 / 3) {
      about = "a street that bends";
      draw_bend();
    } else {
      about = "a side road";
      draw_side_road();
    }
    draw_obstacles();
    if (half_way_m_ > 0) {
      text_ += "\n[robot]\npath = [[" + decimals(-half_way_m_, 1) + ", 0], [" + decimals(half_way_m_, 1) +
               ", 0]]\nspeed = 1\nattitude = \"terrain\"\n";
    }
    return "about = \"Random street " + std::to_string(seed) + ": " + about + ".\"\n" + text_;
  }

 private:
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  bool chance(double share) { return random_.uniform() < share; }
  // Every draw is a separate statement or stands in braces, because the evaluation order of a call's arguments is
  // unspecified.
  double step_m() { return chance(0.4) ? between(0.02, 0.04) : between(0.04, 0.15); }

  double up_or_down_m() {
    const double step = step_m();
    return chance(0.5) ? step : -step;
  }

  /// The robot stands at the scene's origin and looks along x; the curb passes through the middle of its window.
  void stand_beside_the_curb() {
    do {
      turn_rad_ = between(-std::numbers::pi, std::numbers::pi);
      const double aside = between(-1.2, 1.2);
      origin_ = {2 - std::sin(turn_rad_) * aside, std::cos(turn_rad_) * aside};
    } while (std::abs(robot().y) < curb_room_m);
    base_ = {0, between(-0.03, 0.03), between(-0.03, 0.03)};
  }

  Point2 robot() const {
    const double c = std::cos(turn_rad_), s = std::sin(turn_rad_);
    return {-c * origin_.x - s * origin_.y, s * origin_.x - c * origin_.y};
  }

  Point2 in_scene(Point2 p) const {
    const double c = std::cos(turn_rad_), s = std::sin(turn_rad_);
    return {origin_.x + c * p.x - s * p.y, origin_.y + s * p.x + c * p.y};
  }

  /// Draws `surface` with the common slope added.
  void draw_surface(Surface surface) {
    surface = {surface.z + base_.z, surface.su + base_.su, surface.sv + base_.sv};
    const double c = std::cos(turn_rad_), s = std::sin(turn_rad_);
    const double sx = c * surface.su - s * surface.sv, sy = s * surface.su + c * surface.sv;
    text_ += "z = " + decimals(surface.z - sx * origin_.x - sy * origin_.y, 9) + "\n";
    text_ += "slope = [" + decimals(sx, 9) + ", " + decimals(sy, 9) + "]\n";
  }

  void draw_ground(const Surface& surface) {
    text_ += "\n[ground]\n";
    draw_surface(surface);
  }

  void draw_region(const std::string& name, const Polygon& outline, const Surface& surface,
                   double corner_radius_m = 0) {
    text_ += "\n[[region]]\nname = \"" + name + "\"\npolygon = [";
    for (const Point2 p : outline) {
      const Point2 q = in_scene(p);
      text_ += "[" + decimals(q.x, 6) + ", " + decimals(q.y, 6) + "], ";
    }
    text_ += "]\n";
    if (corner_radius_m > 0) text_ += "corner_radius = " + decimals(corner_radius_m, 3) + "\n";
    draw_surface(surface);
  }

  /// A strip whose lower edge is at v, where it is `step` above the road.
  Surface beside(const Surface& road, double v, double step) {
    const double fall = between(-0.025, 0.025);
    return {road.at({0, v}) + step - fall * v, road.su, fall};
  }

  /// Strips across the road and beyond the pavement.
  void draw_other_strips(const Surface& road, const Surface& pavement) {
    if (chance(0.7)) {
      const double v = clear_of_robot(-4.5, -2.2);
      draw_region("pavement across the road", rectangle({-far_m, -far_m}, {far_m, v}), beside(road, v, step_m()));
    }
    if (chance(0.5)) {
      const double v = clear_of_robot(1.0, 2.2);
      draw_region("strip beyond", rectangle({-far_m, v}, {far_m, far_m}), beside(pavement, v, up_or_down_m()));
    }
  }

  double clear_of_robot(double low, double high) {
    double v = between(low, high);
    while (std::abs(robot().y - v) < curb_room_m) v += v < 0 ? -0.1 : 0.1;
    return v;
  }

  void draw_straight() {
    const Surface road{0, 0, between(-0.025, 0.025)};
    const double step = step_m();
    const Surface pavement = beside(road, 0, step);
    draw_ground(road);
    const bool table = chance(0.3);
    if (table) draw_table(road, std::min(step, 0.06));
    draw_region("pavement", rectangle({-far_m, 0}, {far_m, far_m}), pavement);
    draw_other_strips(road, pavement);
    if (!table && step > 0.05 && chance(0.6)) draw_lowered_curb(road, pavement, step);
  }

  /// The road rises by a ramp of 4 to 8 % to a raised table.
  void draw_table(const Surface& road, double rise_m) {
    const double u = between(-1.2, 0.6), to = u + rise_m / between(0.04, 0.08);
    const Surface ramp{road.z - rise_m * u / (to - u), rise_m / (to - u), road.sv};
    draw_region("ramp", rectangle({u, -far_m}, {to, far_m}), ramp);
    draw_region("table", rectangle({to, -far_m}, {far_m, far_m}), road.raised(rise_m));
  }

  /// A ramp of at most 12 % through the curb, with a flank on either side.
  void draw_lowered_curb(const Surface& road, const Surface& pavement, double step) {
    const double left_over = between(0, 0.01), depth = std::max(0.8, (step - left_over) / between(0.06, 0.12));
    const double u = between(-1.5, 0.3), to = u + between(1.0, 1.5), flank = between(0.4, 0.8);
    const double low = road.at({u, 0}) + left_over;
    const auto high = [&](Point2 p) { return pavement.at(p); };
    draw_region("lowered curb", rectangle({u, 0}, {to, depth}),
                through({{u, 0}, {to, 0}, {u, depth}}, {low, low, high({u, depth})}));
    for (const double side : {-1.0, 1.0}) {
      const double inner = side < 0 ? u : to, outer = inner + side * flank;
      const Point2 corners[3] = {{inner, 0}, {outer, 0}, {inner, depth}};
      draw_region("flank", {corners[0], corners[1], corners[2]},
                  through(corners, {low, high(corners[1]), high(corners[2])}));
    }
  }

  /// Strips as concentric discs, with the road inside or outside.
  void draw_bend() {
    const double radius = between(2.5, 12), step = step_m();
    const bool road_inside = chance(0.5);
    const Point2 centre{0, road_inside ? -radius : radius};
    const Point2 from{robot().x - centre.x, robot().y - centre.y};
    const double away = std::hypot(from.x, from.y);
    const auto disc = [&](const std::string& name, double r, double height) {
      while (std::abs(away - r) < curb_room_m) r += r < radius ? -0.1 : 0.1;
      Polygon outline;
      for (int i = 0; i < 120; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.5) / 120;
        outline.push_back({centre.x + r * std::cos(angle), centre.y + r * std::sin(angle)});
      }
      draw_region(name, outline, {height, 0, 0});
    };
    const double inside_m = road_inside ? 0 : step, outside_m = road_inside ? step : 0;
    if (chance(0.5)) {
      const double beyond_m = outside_m + (road_inside ? up_or_down_m() : step_m());
      draw_ground({beyond_m, 0, 0});
      disc(road_inside ? "pavement" : "road", radius + between(1.0, 2.0), outside_m);
    } else {
      draw_ground({outside_m, 0, 0});
    }
    disc(road_inside ? "road" : "pavement", radius, inside_m);
    if (radius > 4 && chance(0.5)) {
      const double inner = radius - between(1.0, 2.2), height = inside_m + step_m();
      disc("inner strip", inner, height);
    }
  }

  /// The pavement opens, with rounded corners, for a side road in the plane of the main one.
  void draw_side_road() {
    const Surface road{0, 0, between(-0.015, 0.015)};
    const double left = between(-1.8, 0.2), width = between(2.2, 4), step = step_m();
    const double radius = between(0.3, 1.0);
    draw_ground(road);
    const Surface near = beside(road, 0, step), far = beside(road, 0, step);
    draw_region("pavement", rectangle({-far_m, 0}, {left, far_m}), near, radius);
    draw_region("pavement beyond", rectangle({left + width, 0}, {far_m, far_m}), far, radius);
    if (chance(0.7)) {
      const double v = clear_of_robot(-4.0, -1.8);
      draw_region("pavement across the road", rectangle({-far_m, -far_m}, {far_m, v}), beside(road, v, step_m()));
    }
  }

  /// Whether a place keeps clear of the robot or its path.
  bool clear(Point2 p, double radius_m) const {
    const Point2 q = in_scene(p);
    return std::hypot(q.x - std::clamp(q.x, -half_way_m_, half_way_m_), q.y) > robot_room_m + radius_m;
  }

  void draw_obstacles() {
    const auto place = [&](Point2 p) {
      const Point2 q = in_scene(p);
      return "at = [" + decimals(q.x, 6) + ", " + decimals(q.y, 6) + "]\n";
    };
    const auto box = [&](const char* name, Point2 p, double length, double width, double height, double turned_rad) {
      if (!clear(p, std::hypot(length, width) / 2)) return;
      text_ += std::string("\n[[box]]\nname = \"") + name + "\"\n" + place(p) + "size = [" + decimals(length, 3) +
               ", " + decimals(width, 3) +
               "]\nyaw_deg = " + decimals((turn_rad_ + turned_rad) * 180 / std::numbers::pi, 6) +
               "\nheight = " + decimals(height, 3) + "\n";
    };
    for (int posts = static_cast<int>(between(0, 4)); posts > 0; --posts) {
      const Point2 p{between(-3, 3), between(0.2, 0.5)};
      const double radius = between(0.03, 0.08), height = between(0.8, 1.2);
      if (!clear(p, radius)) continue;
      text_ += "\n[[cylinder]]\nname = \"post\"\n" + place(p) + "radius = " + decimals(radius, 3) +
               "\nheight = " + decimals(height, 3) + "\n";
    }
    for (int boxes = static_cast<int>(between(0, 3)); boxes > 0; --boxes) {
      const Point2 p{between(-3, 3), between(-2, 2.5)};
      const double length = between(0.25, 0.7), width = between(0.25, 0.7), height = between(0.3, 1.2);
      box("box", p, length, width, height, between(-1.5, 1.5));
    }
    if (chance(0.5)) box("parked car", {between(-5, 5), -between(1.1, 1.4)}, 4.2, 1.8, 1.45, 0);
    if (chance(0.6)) box("house", {0, 7.5}, 24, 4, 6, 0);
  }

  Random random_;
  double half_way_m_;  // along x, on either side of the scene's origin; 0 if the robot stands
  double turn_rad_ = 0;
  Point2 origin_;
  Surface base_;
  std::string text_;
};

}  // namespace

std::string random_street(std::uint64_t seed, StreetRobot robot) {
  return Street(seed, robot).text(seed);
}

}  // namespace curbline::tools
