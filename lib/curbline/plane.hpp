// Planes: the moments of points from which they are fitted, what is known before any point, and the fit. Moments are
// about the mean (Chan, Golub and LeVeque 1979), so that float is enough wherever the window is.
#pragma once

#include <algorithm>

#include "curbline/math.hpp"

namespace curbline {

inline constexpr float least_ramp = 0.05f;      ///< 1 in 20: a way that rises by more is a ramp, ISO 21542
inline constexpr float steepest_ramp = 0.125f;  ///< 1 in 8: of a kerb ramp, AS 1428.1

/// Weighted moments of points (x, y, z), metres in the window's frame. 48 bytes.
struct PlaneMoments {
  float points = 0.0f;                    ///< how many independent points they are worth
  float cells = 0.0f;                     ///< in how many cells
  float weight = 0.0f;                    ///< sum of their weights, by the same measure
  float x = 0.0f, y = 0.0f, z = 0.0f;     ///< mean
  float xx = 0.0f, xy = 0.0f, yy = 0.0f;  ///< scatter about the mean, m^2
  float xz = 0.0f, yz = 0.0f, zz = 0.0f;

  /// Merges two sets of points; exact up to rounding, about 30 operations.
  void add(const PlaneMoments& other);
  /// The same for one cell, whose points lie at one place: its scatter is that of heights alone.
  void add_cell(const PlaneMoments& cell);
  /// The same points, each worth a share of what it was.
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
  // Of a thin strip that lies across the axes rounding takes it below what the ridge alone makes of it.
  const float determinant = std::max(ridge * (xx + yy - ridge), xx * yy - m.xy * m.xy);
  const float x = (yy * m.xz - m.xy * m.yz) / determinant;
  const float y = (xx * m.yz - m.xy * m.xz) / determinant;
  return {x, y, determinant, std::max(0.0f, m.zz - x * m.xz - y * m.yz)};
}

/// What is known of a plane before any point: normal-inverse-gamma, z = level + slope . (p - centroid) + noise.
struct PlanePrior {
  /// Expected noise of a point of weight 1: repeatability of the range-finder. The pipeline takes no less than half of
  /// LaserSettings::range_sd_m squared. [1e-10, 100]
  float noise_m2 = 0.01f * 0.01f;
  /// Part of it that is the ground's: unevenness within a cell, whatever the sensor. [0, 100]
  float texture_m2 = 0.005f * 0.005f;
  float degrees = 2.0f;  ///< how firmly: shape a0 of the inverse gamma; 2 is the weakest with a finite mean; [1, 1e6]
  /// The share of that variance that all points of a cell have in common: tilt timing, mount, texture;
  /// [least_common_share, 1]. At most: the pipeline finds what it is.
  float common_share = 0.5f;
  /// Standard deviation of how bent ground is: its slope changes by 1 in 10 over a metre. [0, 10]
  float curvature_1_m = 0.1f;

  static constexpr float least_common_share = 0.01f;
  /// Variance that the points of a cell have in common: averaging over them does not help against it.
  float common_m2() const { return common_share * noise_m2; }
};
/// A fitted plane with the uncertainty of its height.
struct Plane {
  float x_m = 0.0f, y_m = 0.0f;              ///< centroid
  float z_m = 0.0f;                          ///< height there
  float slope_x = 0.0f, slope_y = 0.0f;      ///< dz/dx, dz/dy
  float variance_m2 = 0.0f;                  ///< of a point of its region about the plane
  float fit_variance_m2 = 0.0f;              ///< of what a cell that it is fitted to counts for: a point, or their mean
  float cells = 0.0f;                        ///< how many these are; 0: no such plane
  float points_a_cell = 1.0f;                ///< of its region, on the mean
  float rough_m2 = 0.0f;                     ///< variance within a cell beyond noise and slope, as CleanFit found it
  float scatter_m2 = 0.0f;                   ///< mean square of how far the cells lie from the centroid
  float pxx = 0.0f, pxy = 0.0f, pyy = 0.0f;  ///< inverse scatter of the cells' positions, 1/m^2

  bool alive() const { return cells > 0.0f; }
  float height_m(float px_m, float py_m) const { return z_m + slope_x * (px_m - x_m) + slope_y * (py_m - y_m); }

  /// How far its centroid lies above another plane.
  float above_m(const Plane& other) const { return z_m - other.height_m(x_m, y_m); }
  /// By how far its cells lie from the centroid: those of a rectangle a x b have variances of a^2 / 12 and b^2 / 12.
  bool narrower_than(float width_m) const { return (pxx + pyy) * cells * square(width_m) > 12.0f; }
  /// What its slope is more than 1 in 20, as a plane through the origin.
  Plane lean() const;
  bool steeper_than_ramp() const { return square(slope_x) + square(slope_y) > square(steepest_ramp); }
  /// The same against ground that leans.
  bool steeper_than_ramp(const Plane& lean) const {
    return square(slope_x - lean.slope_x) + square(slope_y - lean.slope_y) > square(steepest_ramp);
  }
  /// By three standard deviations of the slopes of ground: a face.
  bool steeper_than_ground() const { return square(slope_x) + square(slope_y) > gate * square(steepest_ramp); }

  /// Variance of height_m() at a place: each supporting cell counts as one observation, since the points of a cell
  /// share their errors of tilt and mount.
  float height_variance_m2(float px_m, float py_m) const {
    return fit_variance_m2 / cells + rise_variance_m2(px_m - x_m, py_m - y_m);
  }
  /// Variance of what the plane rises over a distance.
  float rise_variance_m2(float dx_m, float dy_m) const {
    const float away = dx_m * dx_m * pxx + 2.0f * dx_m * dy_m * pxy + dy_m * dy_m * pyy;
    return away > 0.0f ? fit_variance_m2 * away : 0.0f;
  }
};

/// Posterior mean of the plane, the slopes' standard deviation being that of the steepest ramp: what a row of cells
/// leaves open is no steeper than ground is. And mean square residual, not below what the points of a cell share of the
/// expected noise: averaging over a cell does not help against that.
Plane fit_plane(const PlaneMoments& moments, const PlanePrior& prior);

/// The same from the mean heights of cells alone (their own zz is 0): the mean square residual is that of such means,
/// of which three have gone into the plane, not below what the points of a cell were found to share, `common_m2`.
Plane fit_plane_to_means(const PlaneMoments& moments, const PlanePrior& prior, float common_m2);

}  // namespace curbline
