// Do two planes that meet follow one bent surface? Roads are cambered, and evidence fits two or three planes to bent
// ground, however little it is bent. On one bent surface the slope changes within each plane at the same rate as from
// one to the other; at a crease it changes between them only, and the cells of each are flat about it.
#pragma once

#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// The bend of the ground that two planes follow.
struct Bend {
  float dx, dy;         ///< unit vector along which the slope changes
  float curvature_1_m;  ///< change of slope a metre; NaN if the slopes do not differ

  /// The difference of their slopes over the distance of their centroids, in the direction of that difference.
  static Bend between(const Plane& first, const Plane& second);
};

inline Bend Bend::between(const Plane& first, const Plane& second) {
  const float x = second.slope_x - first.slope_x, y = second.slope_y - first.slope_y;
  const float square_of_angle = square(x) + square(y), angle = square_root(square_of_angle);
  const float way_m = x * (second.x_m - first.x_m) + y * (second.y_m - first.y_m);  // times the angle
  return {x / angle, y / angle, square_of_angle / way_m};
}

/// Sums over a plane's cells that give the likelihood of any bend. Cost: 30 operations a cell, 50 a bend.
class BendSums {
 public:
  /// Adds a cell, at a place from the plane's centroid, with its height above the plane.
  [[gnu::cold]] void add(float x_m, float y_m, float above_m);

  /// Log likelihood ratio of the bend against flat ground, each cell one observation of variance_m2. Residuals of a
  /// plane along a bend of curvature k are k / 2 times the square of the distance from its centroid along the bend,
  /// less its mean.
  [[gnu::cold]] float likelier_bent(const Bend& bend, float variance_m2) const;

 private:
  float cells_ = 0.0f, above_m_ = 0.0f;
  float xx_ = 0.0f, xy_ = 0.0f, yy_ = 0.0f;
  float x4_ = 0.0f, x3y_ = 0.0f, x2y2_ = 0.0f, xy3_ = 0.0f, y4_ = 0.0f;
  float xx_above_ = 0.0f, xy_above_ = 0.0f, yy_above_ = 0.0f;
};

/// Do two planes follow one bent surface? Their cells must say so by three standard deviations together, and those of
/// neither the contrary by one: one plane may hold more than one surface, and look bent.
[[gnu::cold]] bool one_bend(const Plane& first, const BendSums& of_first, const Plane& second,
                            const BendSums& of_second);

}  // namespace curbline
