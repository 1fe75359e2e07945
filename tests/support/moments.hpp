// Moments of points, each point as a cell of its own.
#pragma once

#include <vector>

#include "curbline/plane.hpp"
#include "curbline/point.hpp"

namespace curbline::test {

inline PlaneMoments of_point(const Point& p, float weight = 1.0f) {
  PlaneMoments m;
  m.points = m.cells = 1.0f;
  m.weight = weight;
  m.x = p.x_m;
  m.y = p.y_m;
  m.z = p.z_m;
  return m;
}

inline PlaneMoments of_points(const std::vector<Point>& points) {
  PlaneMoments m;
  for (const Point& p : points) m.add(of_point(p));
  return m;
}

}  // namespace curbline::test
