#include "curbline/plane.hpp"

#include <algorithm>

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
  // Of a thin strip that lies across the axes rounding takes it below what the ridge alone makes of it.
  const float determinant = std::max(ridge * (xx + yy - ridge), xx * yy - m.xy * m.xy);
  const float x = (yy * m.xz - m.xy * m.yz) / determinant;
  const float y = (xx * m.yz - m.xy * m.xz) / determinant;
  return {x, y, determinant, std::max(0.0f, m.zz - x * m.xz - y * m.yz)};
}

/// With the variance that a sum of squares has by a weight.
Plane fitted(const PlaneMoments& m, const PlanePrior& prior, float weight, float least_m2) {
  const float ridge = prior.noise_m2 / (steepest_ramp * steepest_ramp);
  const Slopes slopes = solve(m, ridge);
  // Positions weigh by points; one cell is one observation.
  const float per_cell = m.weight / m.cells / slopes.determinant;
  Plane plane;
  plane.x_m = m.x;
  plane.y_m = m.y;
  plane.z_m = m.z;
  plane.slope_x = slopes.x;
  plane.slope_y = slopes.y;
  plane.variance_m2 = plane.fit_variance_m2 = std::max(least_m2, slopes.residual_m2 / weight);
  plane.cells = m.cells;
  plane.scatter_m2 = (m.xx + m.yy) / m.weight;
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

PlaneEvidence::PlaneEvidence(const PlanePrior& prior)
    : prior_(prior), constant_(0.918938533f + prior.degrees * log(prior.degrees) - log_gamma(prior.degrees)) {
  for (std::size_t n = 1; n < log_gamma_.size(); ++n) log_gamma_[n] = log_gamma(static_cast<float>(n));
}

float PlaneEvidence::log_evidence(const PlaneMoments& m) const {
  const float ridge = prior_.noise_m2;
  const Slopes slopes = solve(m, ridge);
  const float shape = prior_.degrees + 0.5f * m.points;
  const float rate = prior_.degrees + 0.5f * slopes.residual_m2 / prior_.noise_m2;  // in units of the expected noise
  const float volume = (m.weight + ridge) * (slopes.determinant / (ridge * ridge * ridge));
  // lnG(shape) - shape ln(rate) by Stirling, with the large parts joined so that float keeps the digits.
  return shape * (log(shape / rate) - 1.0f) + (1.0f / 12) / shape - 0.5f * log(shape * volume) + constant_;
}

bool PlaneEvidence::parted(const PlaneMoments& a, const PlaneMoments& b, const BorderRise& border) const {
  const Plane first = fit_plane(a, prior_), second = fit_plane(b, prior_);
  return step_between(first, second, border) || crease_between(first, second);
}

bool PlaneEvidence::step_between(const Plane& first, const Plane& second, const BorderRise& border) const {
  const float share_m2 = prior_.common_m2();
  const auto above_m = [&](const Plane& at) {
    return second.height_m(at.x_m, at.y_m) - first.height_m(at.x_m, at.y_m);
  };
  const auto apart = [&](const Plane& at, float step_m) {
    const float square_m2 = step_m * step_m;
    return square_m2 > gate * (first.height_variance_m2(at.x_m, at.y_m) + second.height_variance_m2(at.x_m, at.y_m)) &&
           square_m2 > 4.0f * share_m2;
  };
  const float at_first_m = above_m(first), at_second_m = above_m(second);
  if (at_first_m * at_second_m > 0.0f && apart(first, at_first_m) && apart(second, at_second_m)) return true;
  const float mean_m = 0.5f * (at_first_m + at_second_m);
  return mean_m * mean_m > 4.0f * share_m2 && rises(first, second, border, mean_m);
}

/// Does the ground jump along the border, up if `toward` is above 0, else down? Where it is one bent surface it rises
/// there by the mean of both planes' slopes.
bool PlaneEvidence::rises(const Plane& first, const Plane& second, const BorderRise& border, float toward) const {
  if (!(border.pairs > 0.0f)) return false;
  const float share_m2 = prior_.common_m2();
  const float slope_x = 0.5f * (first.slope_x + second.slope_x), slope_y = 0.5f * (first.slope_y + second.slope_y);
  const float jump_m = border.rise_m - slope_x * border.dx_m - slope_y * border.dy_m;
  const float variance_m2 =
      2.0f * share_m2 / border.pairs +
      0.25f * (first.rise_variance_m2(border.dx_m, border.dy_m) + second.rise_variance_m2(border.dx_m, border.dy_m));
  const float square_m2 = jump_m * jump_m;
  return jump_m * toward > 0.0f && square_m2 > share_m2 && square_m2 > gate * variance_m2;
}

/// The angle, across the line along which they meet, and what is known of it; all times its own square.
bool PlaneEvidence::crease_between(const Plane& first, const Plane& second) const {
  const float x = second.slope_x - first.slope_x, y = second.slope_y - first.slope_y;
  const float bend = prior_.curvature_1_m * (x * (second.x_m - first.x_m) + y * (second.y_m - first.y_m));
  return square(x * x + y * y) > gate * (first.rise_variance_m2(x, y) + second.rise_variance_m2(x, y) + bend * bend);
}

Plane fit_plane(const PlaneMoments& m, const PlanePrior& prior) {
  return fitted(m, prior, m.weight, prior.common_m2());
}

Plane fit_plane_to_means(const PlaneMoments& m, const PlanePrior& prior, float common_m2) {
  const float left = m.cells > 4.0f ? m.cells - 3.0f : 1.0f;
  return fitted(m, prior, m.weight * left / m.cells, common_m2);
}

}  // namespace curbline
