// A cell of the elevation map: the heights that fell in it, as the normal-inverse-gamma posterior of a Gaussian with
// unknown mean and variance (paper, section III-B), and the centroid of its points. 24 bytes, O(1) a point.
#pragma once

#include "curbline/cell_prior.hpp"

namespace curbline {

/// Sufficient statistics. A point of weight w is a height with the variance (noise variance of the cell) / w, so that a
/// noisier reading moves the mean less. Offsets are from the cell's centre: equally exact in float wherever the map is.
struct Cell {
  float points = 0.0f;      ///< their number; faded ones count in part
  float weight = 0.0f;      ///< kappa: sum of their weights
  float height_m = 0.0f;    ///< posterior mean
  float scatter_m2 = 0.0f;  ///< weighted sum of squares about the mean
  float dx_m = 0.0f;        ///< centroid, weighted, from the cell's centre
  float dy_m = 0.0f;

  bool valid() const { return points > 0.0f; }

  /// Takes in a point. weight > 0.
  void add(float point_dx_m, float point_dy_m, float point_height_m, float point_weight) {
    points += 1.0f;
    weight += point_weight;
    const float gain = point_weight / weight;
    const float innovation = point_height_m - height_m;
    height_m += gain * innovation;
    scatter_m2 += point_weight * innovation * (point_height_m - height_m);
    dx_m += gain * (point_dx_m - dx_m);
    dy_m += gain * (point_dy_m - dy_m);
  }

  /// What was seen so far keeps a share of its weight.
  void fade(float share) {
    points *= share;
    weight *= share;
    scatter_m2 *= share;
  }

  /// Posterior mode of the variance, for a point of weight 1.
  float variance_m2(const CellPrior& prior) const {
    return (prior.degrees * prior.variance_m2 + scatter_m2) / (prior.degrees + points);
  }
};

}  // namespace curbline
