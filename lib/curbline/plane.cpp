#include "curbline/plane.hpp"

#include <algorithm>

#include "curbline/math.hpp"

namespace curbline {
namespace {

/// The variance is the residual sum of squares over `weight`, at least least_m2.
Plane fitted(const PlaneMoments& m, const PlanePrior& prior, float weight, float least_m2) {
  const float ridge = prior.noise_m2 / (steepest_ramp * steepest_ramp);
  const RidgeFit fit = ridge_fit(m, ridge);
  // Moments are weighted by points; a cell is one observation.
  const float per_cell = m.weight / m.cells / fit.determinant;
  Plane plane;
  plane.x_m = m.x;
  plane.y_m = m.y;
  plane.z_m = m.z;
  plane.slope_x = fit.slope_x;
  plane.slope_y = fit.slope_y;
  plane.variance_m2 = plane.fit_variance_m2 = std::max(least_m2, fit.residual_m2 / weight);
  plane.cells = m.cells;
  plane.pxx = (m.yy + ridge) * per_cell;
  plane.pxy = -m.xy * per_cell;
  plane.pyy = (m.xx + ridge) * per_cell;
  return plane;
}

}  // namespace

void PlaneMoments::add(const PlaneMoments& other) {
  const float sum = weight + other.weight;
  if (!(other.weight > 0.0f)) return;
  const float dx = other.x - x, dy = other.y - y, dz = other.z - z;
  const float share = other.weight / sum;
  const float between = weight * share;
  x += share * dx;
  y += share * dy;
  z += share * dz;
  xx += other.xx + between * dx * dx;
  xy += other.xy + between * dx * dy;
  yy += other.yy + between * dy * dy;
  xz += other.xz + between * dx * dz;
  yz += other.yz + between * dy * dz;
  zz += other.zz + between * dz * dz;
  weight = sum;
  points += other.points;
  cells += other.cells;
}

void PlaneMoments::scale(float share) {
  points *= share;
  cells *= share;
  weight *= share;
  xx *= share;
  xy *= share;
  yy *= share;
  xz *= share;
  yz *= share;
  zz *= share;
}

Plane Plane::lean() const {
  Plane beyond;
  const float slope = square_root(square(slope_x) + square(slope_y));
  if (slope > least_ramp) {
    const float share = 1.0f - least_ramp / slope;
    beyond.slope_x = share * slope_x;
    beyond.slope_y = share * slope_y;
  }
  return beyond;
}

float Plane::rise_variance_m2(float dx_m, float dy_m) const {
  const float away = dx_m * dx_m * pxx + 2.0f * dx_m * dy_m * pxy + dy_m * dy_m * pyy;
  return away > 0.0f ? fit_variance_m2 * away : 0.0f;
}

Plane fit_plane(const PlaneMoments& m, const PlanePrior& prior) {
  return fitted(m, prior, m.weight, prior.common_m2());
}

Plane fit_plane_to_means(const PlaneMoments& m, const PlanePrior& prior, float common_m2) {
  const float left = m.cells > 4.0f ? m.cells - 3.0f : 1.0f;
  return fitted(m, prior, m.weight * left / m.cells, common_m2);
}

}  // namespace curbline
