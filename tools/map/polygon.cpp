#include "map/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace curbline::tools {
namespace {

constexpr int circle_corners = 48;
constexpr double arc_step_rad = std::numbers::pi / 16;

bool on_segment(Point2 p, Point2 a, Point2 b) {
  const double along = dot(p - a, b - a);
  return std::abs(cross(b - a, p - a)) <= 1e-9 * length(b - a) && along >= 0 && along <= dot(b - a, b - a);
}

bool segments_meet(Point2 a, Point2 b, Point2 c, Point2 d) {
  if (on_segment(a, c, d) || on_segment(b, c, d) || on_segment(c, a, b) || on_segment(d, a, b)) {
    return true;
  }
  return (cross(b - a, c - a) > 0) != (cross(b - a, d - a) > 0) &&
         (cross(d - c, a - c) > 0) != (cross(d - c, b - c) > 0);
}

/// The arc that rounds the corner between two neighbours.
void append_arc(Point2 before, Point2 corner, Point2 after, double radius_m, Polygon& out) {
  const Point2 u = (1 / length(before - corner)) * (before - corner);
  const Point2 v = (1 / length(after - corner)) * (after - corner);
  const double half_angle = 0.5 * std::acos(std::clamp(dot(u, v), -1.0, 1.0));
  const double turn = std::numbers::pi - 2 * half_angle;
  if (turn < 1e-6) {
    out.push_back(corner);
    return;
  }
  const double room = 0.5 * std::min(length(before - corner), length(after - corner));
  const double cut = std::min(radius_m / std::tan(half_angle), room);
  const double radius = cut * std::tan(half_angle);
  const Point2 bisector = (1 / length(u + v)) * (u + v);
  const Point2 centre = corner + (radius / std::sin(half_angle)) * bisector;
  const Point2 start = corner + cut * u - centre;
  const double sense = cross(u, v) < 0 ? 1 : -1;
  const int steps = std::max(1, static_cast<int>(std::ceil(turn / arc_step_rad)));
  for (int i = 0; i <= steps; ++i) {
    const double angle = sense * turn * i / steps;
    const double c = std::cos(angle), s = std::sin(angle);
    out.push_back(centre + Point2{c * start.x - s * start.y, s * start.x + c * start.y});
  }
}

}  // namespace

Polygon rectangle(Point2 corner, Point2 opposite) {
  return {corner, {opposite.x, corner.y}, opposite, {corner.x, opposite.y}};
}

Polygon circle(Point2 centre, double radius_m) {
  Polygon polygon;
  for (int i = 0; i < circle_corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / circle_corners;
    polygon.push_back({centre.x + radius_m * std::cos(angle), centre.y + radius_m * std::sin(angle)});
  }
  return polygon;
}

Polygon with_round_corners(const Polygon& polygon, double radius_m) {
  Polygon out;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    append_arc(polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n], radius_m, out);
  }
  // Two arcs that together use up the edge between them meet in one point.
  const auto same = [](Point2 a, Point2 b) { return length(a - b) < 1e-6; };
  out.erase(std::unique(out.begin(), out.end(), same), out.end());
  if (same(out.front(), out.back())) {
    out.pop_back();
  }
  return out;
}

Polygon moved(const Polygon& polygon, Point2 by) {
  Polygon out = polygon;
  for (Point2& corner : out) {
    corner = corner + by;
  }
  return out;
}

double signed_area_m2(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    twice += cross(polygon[j], polygon[i]);
  }
  return 0.5 * twice;
}

bool is_simple(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  if (n < 3 || std::abs(signed_area_m2(polygon)) < 1e-6) {
    return false;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 a = polygon[i], b = polygon[(i + 1) % n], next = polygon[(i + 2) % n];
    if (on_segment(next, a, b) || on_segment(a, b, next)) {
      return false;
    }
    for (std::size_t j = i + 2; j < n; ++j) {
      if ((j + 1) % n != i && segments_meet(a, b, polygon[j], polygon[(j + 1) % n])) {
        return false;
      }
    }
  }
  return true;
}

bool contains(const Polygon& polygon, Point2 point) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point2 a = polygon[i], b = polygon[j];
    if ((a.y > point.y) != (b.y > point.y) && point.x < (b.x - a.x) * (point.y - a.y) / (b.y - a.y) + a.x) {
      inside = !inside;
    }
  }
  return inside;
}

Bounds bounds(const Polygon& polygon) {
  Bounds box{polygon.front().x, polygon.front().y, polygon.front().x, polygon.front().y};
  for (const Point2 corner : polygon) {
    box = {std::min(box.x0, corner.x), std::min(box.y0, corner.y), std::max(box.x1, corner.x),
           std::max(box.y1, corner.y)};
  }
  return box;
}

Bounds united(const Bounds& a, const Bounds& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

Bounds widened(const Bounds& box, double by_m) {
  return {box.x0 - by_m, box.y0 - by_m, box.x1 + by_m, box.y1 + by_m};
}

bool overlap(const Bounds& a, const Bounds& b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

void Share::clip(double start, double step, double low, double high) {
  if (std::isnan(step) || (step == 0 && (start < low || start > high))) to = -1;
  if (step == 0) return;
  const double t0 = (low - start) / step, t1 = (high - start) / step;
  from = std::max(from, std::min(t0, t1));
  to = std::min(to, std::max(t0, t1));
}

Share share_in(const Bounds& box, Point2 a, Point2 b) {
  Share share;
  share.clip(a.x, b.x - a.x, box.x0, box.x1);
  share.clip(a.y, b.y - a.y, box.y0, box.y1);
  return share;
}

bool crosses(const Bounds& box, Point2 a, Point2 b) {
  const Share share = share_in(box, a, b);
  return share.from <= share.to;
}

}  // namespace curbline::tools
