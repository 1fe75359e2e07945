// Planes: moments of points, the prior, and the fit. Moments are about the mean (Chan, Golub and LeVeque 1979), so that
// float suffices wherever the window is.
#pragma once

#include <algorithm>

#include "curbline/math.hpp"

namespace curbline {

inline constexpr float least_ramp = 0.05f;      ///< 1 in 20: a steeper way is a ramp, ISO 21542
inline constexpr float steepest_ramp = 0.125f;  ///< 1 in 8: the steepest curb ramp, AS 1428.1

/// Weighted moments of points (x, y, z), metres in the window's frame. 48 bytes.
struct PlaneMoments {
  float points = 0.0f;                    ///< number of independent points that they are worth
  float cells = 0.0f;                     ///< number of their cells
  float weight = 0.0f;                    ///< sum of their weights, as independent points
  float x = 0.0f, y = 0.0f, z = 0.0f;     ///< mean
  float xx = 0.0f, xy = 0.0f, yy = 0.0f;  ///< scatter about the mean, m^2
  float xz = 0.0f, yz = 0.0f, zz = 0.0f;

  /// Merges two sets of points; exact up to rounding, about 30 operations.
  void add(const PlaneMoments& other);
  /// The same for one cell, whose points count as at one place: only its heights scatter.
  void add_cell(const PlaneMoments& cell);
  /// Reduces the worth of the points to a share.
  void scale(float share);
};

inline void PlaneMoments::add_cell(const PlaneMoments& cell) {
  const float sum = weight + cell.weight;
  if (!(cell.weight > 0.0f)) return;
  const float dx = cell.x - x, dy = cell.y - y, dz = cell.z - z;
  const float share = cell.weight / sum;
  const float between = weight * share;
  x += share * dx;
  y += share * dy;
  z += share * dz;
  xx += between * dx * dx;
  xy += between * dx * dy;
  yy += between * dy * dy;
  xz += between * dx * dz;
  yz += between * dy * dz;
  zz += cell.zz + between * dz * dz;
  weight = sum;
  points += cell.points;
  cells += cell.cells;
}

/// Ridge regression of z on (x, y) about the mean.
struct RidgeFit {
  float slope_x, slope_y;
  float determinant;  ///< of the 2 x 2 scatter plus prior
  float residual_m2;  ///< weighted sum of squares that the slopes leave
};
inline RidgeFit ridge_fit(const PlaneMoments& m, float ridge) {
  const float xx = m.xx + ridge, yy = m.yy + ridge;
  // For a thin strip at an angle to the axes, rounding could take it below the ridge's own share.
  const float determinant = std::max(ridge * (xx + yy - ridge), xx * yy - m.xy * m.xy);
  const float x = (yy * m.xz - m.xy * m.yz) / determinant;
  const float y = (xx * m.yz - m.xy * m.xz) / determinant;
  return {x, y, determinant, std::max(0.0f, m.zz - x * m.xz - y * m.yz)};
}

/// Prior of a plane: normal-inverse-gamma, z = level + slope . (p - centroid) + noise.
struct PlanePrior {
  /// Expected noise of a point of weight 1: repeatability of the range-finder. The pipeline uses at least half of
  /// LaserSettings::range_sd_m squared. [1e-10, 100]
  float noise_m2 = 0.01f * 0.01f;
  /// The part of it that is the ground's: unevenness within a cell, whatever the sensor. [0, noise_m2]
  float texture_m2 = 0.005f * 0.005f;
  float degrees = 2.0f;  ///< shape a0 of the inverse gamma; 2 is the weakest with a finite mean; [1, 1e6]
  /// Largest share of that variance that the points of a cell have in common: tilt timing, mount, texture. The pipeline
  /// estimates the actual one. [least_common_share, 1]
  float common_share = 0.5f;
  /// Standard deviation of the ground's curvature: its slope changes by 1 in 10 over a metre. [0, 10]
  float curvature_1_m = 0.1f;

  static constexpr float least_common_share = 0.01f;
  /// Variance that the points of a cell have in common: averaging over them does not reduce it.
  float common_m2() const { return common_share * noise_m2; }
};
/// A fitted plane with the uncertainty of its height. x and y are the window's, from its lowest corner; z is the map's.
struct Plane {
  float x_m = 0.0f, y_m = 0.0f;              ///< centroid
  float z_m = 0.0f;                          ///< height there
  float slope_x = 0.0f, slope_y = 0.0f;      ///< dz/dx, dz/dy
  float variance_m2 = 0.0f;                  ///< of a point of its region about the plane
  float fit_variance_m2 = 0.0f;              ///< of one observation of the fit: a point, or a cell's mean
  float cells = 0.0f;                        ///< number of cells that it is fitted to; 0: no such plane
  float points_a_cell = 1.0f;                ///< mean, of its region
  float rough_m2 = 0.0f;                     ///< variance within a cell beyond noise and slope (CleanFit)
  float pxx = 0.0f, pxy = 0.0f, pyy = 0.0f;  ///< inverse scatter of the cells' positions, 1/m^2

  bool alive() const { return cells > 0.0f; }
  float height_m(float px_m, float py_m) const { return z_m + slope_x * (px_m - x_m) + slope_y * (py_m - y_m); }

  /// Height of its centroid above another plane.
  float above_m(const Plane& other) const { return z_m - other.height_m(x_m, y_m); }
  /// By the scatter of its cells: those of a rectangle a x b have variances of a^2 / 12 and b^2 / 12.
  bool narrower_than(float width_m) const { return (pxx + pyy) * cells * square(width_m) > 12.0f; }
  /// Its slope beyond 1 in 20, as a plane through the origin.
  Plane lean() const;
  bool steeper_than_ramp() const { return square(slope_x) + square(slope_y) > square(steepest_ramp); }
  /// The same relative to the slope of the ground, lean().
  bool steeper_than_ramp(const Plane& lean) const {
    return square(slope_x - lean.slope_x) + square(slope_y - lean.slope_y) > square(steepest_ramp);
  }
  /// Steeper than ground by three standard deviations of its slopes: a face.
  bool steeper_than_ground() const { return square(slope_x) + square(slope_y) > gate * square(steepest_ramp); }

  /// Does it pass through a place, within five standard deviations?
  bool passes_through(float px_m, float py_m, float pz_m) const {
    return square(pz_m - height_m(px_m, py_m)) <= 25.0f * (variance_m2 + height_variance_m2(px_m, py_m));
  }
  /// Variance of height_m() at a place. Each supporting cell counts as one observation, since the points of a cell
  /// share their errors of tilt and mount.
  float height_variance_m2(float px_m, float py_m) const {
    return fit_variance_m2 / cells + rise_variance_m2(px_m - x_m, py_m - y_m);
  }
  /// Variance of the plane's rise over a distance.
  float rise_variance_m2(float dx_m, float dy_m) const;
};

/// Posterior mean of the plane, with a prior on slopes whose standard deviation is the steepest ramp: what a row of
/// cells leaves open is taken to be no steeper than ground. Its variance is the mean square residual, at least the part
/// of the expected noise that the points of a cell share.
Plane fit_plane(const PlaneMoments& moments, const PlanePrior& prior);

/// The same from mean heights of cells (their own zz is 0): the variance is that of such means, with three degrees of
/// freedom less, at least the variance that the points of a cell were found to share, `common_m2`.
Plane fit_plane_to_means(const PlaneMoments& moments, const PlanePrior& prior, float common_m2);

}  // namespace curbline
