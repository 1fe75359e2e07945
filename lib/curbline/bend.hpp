// Roads are cambered, and evidence follows bent ground with two or three planes, however little it is bent. Do two
// planes that meet follow one bent surface? If they do, the slope changes within each as it does from the one to the
// other; at a crease it changes between them alone. By that the residuals of their cells tell one from the other.
#pragma once

#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// How ground would be bent that two planes follow. Cost of a BendTally: 30 operations a cell.
struct Bend {
  /// Standard deviation of how bent roads and pavements are along which one walks: the recorded ones 0.005 to 0.02 / m.
  static constexpr float usual_1_m = 0.01f;

  float dx = 0.0f, dy = 0.0f;  ///< unit vector along which the slope changes
  float curvature_1_m = 0.0f;  ///< by how much a metre; 0: they follow none
  bool any() const { return curvature_1_m != 0.0f; }
};

/// What the cells of both planes tell of the curvature along a bend: the regression of their residuals on the square of
/// the way, in each plane from its centroid, together.
class BendTally {
 public:
  explicit BendTally(const Bend& bend) : bend_(bend) {}

  /// A cell of one of the planes; mean_m2: square_m2() of that.
  void add(PlaneMoments cell, const Plane& plane, float mean_m2);
  /// Mean square of the way of points from their centroid.
  float square_m2(const PlaneMoments& m) const {
    return (m.xx * square(bend_.dx) + 2.0f * m.xy * bend_.dx * bend_.dy + m.yy * square(bend_.dy)) / m.weight;
  }
  /// Is the ground likelier bent as both planes want it than not at all, by three standard deviations of heights of
  /// that variance?
  bool bent(float noise_m2) const {
    const PlaneMoments& r = residuals_;  // half the curvature is its slope along y
    const float half_1_m = 0.5f * bend_.curvature_1_m, share = r.xy / r.xx;
    return half_1_m * (r.yz - share * r.xz - 0.5f * half_1_m * (r.yy - share * r.xy)) > 0.5f * gate * noise_m2;
  }

 private:
  Bend bend_;
  PlaneMoments residuals_;
};

}  // namespace curbline
