#include "curbline/plane.hpp"

#include "curbline/math.hpp"

namespace curbline {
namespace {

struct Slopes {
  float x, y;
  float determinant;  ///< of the 2 x 2 scatter plus prior
  float residual_m2;  ///< weighted sum of squares that the slopes leave
};

/// Ridge regression of z on (x, y) about the mean.
Slopes solve(const PlaneMoments& m, float ridge) {
  const float xx = m.xx + ridge, yy = m.yy + ridge;
  const float determinant = xx * yy - m.xy * m.xy;
  const float x = (yy * m.xz - m.xy * m.yz) / determinant;
  const float y = (xx * m.yz - m.xy * m.xz) / determinant;
  const float residual = m.zz - x * m.xz - y * m.yz;
  return {x, y, determinant, residual > 0.0f ? residual : 0.0f};
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

float log_evidence(const PlaneMoments& m, const PlanePrior& prior) {
  const float ridge = prior.noise_m2;
  const Slopes slopes = solve(m, ridge);
  const float shape = prior.degrees + 0.5f * m.points;
  const float rate = prior.degrees + 0.5f * slopes.residual_m2 / prior.noise_m2;  // in units of the expected noise
  // lnG(shape) - shape ln(rate) by Stirling, with the large parts joined so that float keeps the digits.
  const float noise_term = shape * (log(shape / rate) - 1.0f) - 0.5f * log(shape) + (1.0f / 12) / shape;
  const float volume = (m.weight + ridge) * (slopes.determinant / (ridge * ridge * ridge));
  return noise_term - 0.5f * log(volume) + 0.918938533f + prior.degrees * log(prior.degrees) - log_gamma(prior.degrees);
}

Plane fit_plane(const PlaneMoments& m, float cells, const PlanePrior& prior) {
  const Slopes slopes = solve(m, prior.noise_m2);
  const float per_cell = m.weight / cells / slopes.determinant;  // positions weigh by points; one cell is one observation
  Plane plane;
  plane.x_m = m.x;
  plane.y_m = m.y;
  plane.z_m = m.z;
  plane.slope_x = slopes.x;
  plane.slope_y = slopes.y;
  const float mean_square = slopes.residual_m2 / m.weight;
  const float floor_m2 = prior.common_share * prior.noise_m2;
  plane.variance_m2 = mean_square > floor_m2 ? mean_square : floor_m2;
  plane.cells = cells;
  plane.pxx = (m.yy + prior.noise_m2) * per_cell;
  plane.pxy = -m.xy * per_cell;
  plane.pyy = (m.xx + prior.noise_m2) * per_cell;
  return plane;
}

}  // namespace curbline
