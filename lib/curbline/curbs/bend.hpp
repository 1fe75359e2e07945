// Roads are cambered, and evidence follows bent ground with two planes or three, however little it is bent. Do two
// planes that meet follow one bent surface? If they do, the slope changes within each as it does from the one to the
// other; where they meet at a crease it changes between them alone, and the cells of each lie evenly about it.
#pragma once

#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// How the ground is bent that two planes follow.
struct Bend {
  float dx, dy;         ///< unit vector along which the slope changes
  float curvature_1_m;  ///< by how much a metre; no number if they do not differ

  /// From one to the other the slope changes by their difference, over the way between their centroids along it.
  static Bend between(const Plane& first, const Plane& second);
};

inline Bend Bend::between(const Plane& first, const Plane& second) {
  const float x = second.slope_x - first.slope_x, y = second.slope_y - first.slope_y;
  const float square_of_angle = square(x) + square(y), angle = square_root(square_of_angle);
  const float way_m = x * (second.x_m - first.x_m) + y * (second.y_m - first.y_m);  // times the angle
  return {x / angle, y / angle, square_of_angle / way_m};
}

/// How far cells lie off their plane, and what that says of a bend. Cost: 30 operations a cell, 50 a bend.
class BendSums {
 public:
  /// A cell, by its way from the plane's centroid.
  [[gnu::cold]] void add(float x_m, float y_m, float above_m);

  /// By how much the ground is likelier bent so than even, logarithm of the ratio, each cell one observation of that
  /// variance: residuals of a plane that follows a bend of k lie as k / 2 times the square of the way from its centroid
  /// along the bend, less its mean.
  [[gnu::cold]] float likelier_bent(const Bend& bend, float variance_m2) const;

 private:
  float cells_ = 0.0f, above_m_ = 0.0f;
  float xx_ = 0.0f, xy_ = 0.0f, yy_ = 0.0f;
  float x4_ = 0.0f, x3y_ = 0.0f, x2y2_ = 0.0f, xy3_ = 0.0f, y4_ = 0.0f;
  float xx_above_ = 0.0f, xy_above_ = 0.0f, yy_above_ = 0.0f;
};

/// Do two planes follow one bent surface, by their cells, each one observation? Both together are sure of it to three
/// standard deviations, and neither says the contrary: one of them may hold more than one surface, and look bent.
[[gnu::cold]] bool one_bend(const Plane& first, const BendSums& of_first, const Plane& second,
                            const BendSums& of_second);

}  // namespace curbline
