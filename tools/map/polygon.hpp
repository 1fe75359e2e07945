// Polygons on the ground plan, metres: drawn regions, the surfaces of a scene, the footprints of its obstacles.
#pragma once

#include <vector>

namespace curbline::tools {

struct Point2 {
  double x = 0, y = 0;
};

/// Corners in order, either way round, the last joined to the first.
using Polygon = std::vector<Point2>;

/// A rectangle along the axes.
struct Bounds {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

Polygon rectangle(Point2 corner, Point2 opposite);
Polygon circle(Point2 centre, double radius_m);  ///< 48 corners on the circle, counterclockwise

/// Each corner replaced by an arc of that radius, cut smaller where the edges beside it are too short.
Polygon with_round_corners(const Polygon& polygon, double radius_m);

Polygon moved(const Polygon& polygon, Point2 by);

double signed_area_m2(const Polygon& polygon);  ///< above 0: counterclockwise
bool is_simple(const Polygon& polygon);  ///< three corners or more, some area, no edge crosses or touches another
bool contains(const Polygon& polygon, Point2 point);
Bounds bounds(const Polygon& polygon);

/// A part of a segment, as shares of the way from its start to its end; or of a ray, in steps from its origin on.
struct Share {
  double from = 0, to = 1;
  bool any() const { return from < to; }

  /// Leaves what of it lies where low <= start + t step <= high; from > to if nothing does, or the step is NaN
  /// (Liang and Barsky 1984).
  void clip(double start, double step, double low, double high);
};

/// The part of the segment from a to b that lies in the rectangle; from > to if none does.
Share share_in(const Bounds& box, Point2 a, Point2 b);

/// True if the segment from a to b has a point in the rectangle.
bool crosses(const Bounds& box, Point2 a, Point2 b);

}  // namespace curbline::tools
