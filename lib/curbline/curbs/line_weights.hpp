// How much a plane's height at a place owes to each of the scan lines that have seen its cells. Lines run across the
// way ahead, and each errs by its own tilt and pose: a curb that runs along them has other lines on each side; of one
// that leads ahead, both sides have the same, and their errors cancel in its height. Cost: 20 operations a plane and
// place.
#pragma once

#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// The lines lie evenly over the plane's length ahead. In a least-squares fit the weight of one is a linear function of
/// where it lies.
struct LineWeights {
  float middle_m, half_m;  ///< of that length: middle, ahead of the window's corner, and half
  float growth_1_m;        ///< of the weight, over its mean, for each metre ahead
  float pitch_m;           ///< distance of two lines, or of the rows of cells that count as such

  /// For the height at (x_m, y_m) in the window's frame.
  LineWeights(const Plane& plane, const SinCos& ahead, float line_pitch_m, float x_m, float y_m);
  /// Covariance of two planes' heights at their places, over the variance of a line's error; of a plane and itself, the
  /// variance.
  float times(const LineWeights& other) const;
};

}  // namespace curbline
