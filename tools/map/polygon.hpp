// Polygons in the ground plan, metres: drawn regions, the surfaces of a scene, the footprints of its obstacles.
#pragma once

#include <cmath>
#include <vector>

namespace curbline::tools {

/// A place, or a vector.
struct Point2 {
  double x = 0, y = 0;
};

inline Point2 operator+(Point2 a, Point2 b) {
  return {a.x + b.x, a.y + b.y};
}
inline Point2 operator-(Point2 a, Point2 b) {
  return {a.x - b.x, a.y - b.y};
}
inline Point2 operator*(double s, Point2 a) {
  return {s * a.x, s * a.y};
}
inline double dot(Point2 a, Point2 b) {
  return a.x * b.x + a.y * b.y;
}
inline double cross(Point2 a, Point2 b) {
  return a.x * b.y - a.y * b.x;
}
inline double length(Point2 a) {
  return std::hypot(a.x, a.y);
}

/// Corners in order, clockwise or counterclockwise, the last joined to the first.
using Polygon = std::vector<Point2>;

/// A rectangle along the axes.
struct Bounds {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

Polygon rectangle(Point2 corner, Point2 opposite);
Polygon circle(Point2 centre, double radius_m);  ///< 48 corners on the circle, counterclockwise

/// Each corner is replaced by an arc of that radius, or a smaller one if the adjacent edges are too short.
Polygon with_round_corners(const Polygon& polygon, double radius_m);

Polygon moved(const Polygon& polygon, Point2 by);

double signed_area_m2(const Polygon& polygon);  ///< positive: counterclockwise
bool is_simple(const Polygon& polygon);  ///< at least three corners, nonzero area, no edge crosses or touches another
bool contains(const Polygon& polygon, Point2 point);
Bounds bounds(const Polygon& polygon);
Bounds united(const Bounds& a, const Bounds& b);
Bounds widened(const Bounds& box, double by_m);  ///< on each side
bool overlap(const Bounds& a, const Bounds& b);  ///< or touch

/// A part of a segment, as fractions of its length; or of a ray, in steps from its origin.
struct Share {
  double from = 0, to = 1;
  bool any() const { return from < to; }

  /// Restricts it to where low <= start + t step <= high; then from > to if that is nowhere, or the step is NaN (Liang
  /// and Barsky 1984).
  void clip(double start, double step, double low, double high);
};

/// The part of the segment from a to b inside the rectangle; from > to if there is none.
Share share_in(const Bounds& box, Point2 a, Point2 b);

/// Whether the segment from a to b has a point in the rectangle.
bool crosses(const Bounds& box, Point2 a, Point2 b);

}  // namespace curbline::tools
