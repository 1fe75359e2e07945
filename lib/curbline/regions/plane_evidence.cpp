#include "curbline/regions/plane_evidence.hpp"

#include <cstddef>

#include "curbline/math.hpp"

namespace curbline {

PlaneEvidence::PlaneEvidence(const PlanePrior& prior)
    : prior_(prior), constant_(0.918938533f + prior.degrees * log(prior.degrees) - log_gamma(prior.degrees)) {
  for (std::size_t n = 1; n < log_gamma_.size(); ++n) log_gamma_[n] = log_gamma(static_cast<float>(n));
}

float PlaneEvidence::log_evidence(const PlaneMoments& m) const {
  const float ridge = prior_.noise_m2;
  const RidgeFit fit = ridge_fit(m, ridge);
  const float shape = prior_.degrees + 0.5f * m.points;
  const float rate = prior_.degrees + 0.5f * fit.residual_m2 / prior_.noise_m2;  // in units of the expected noise
  const float volume = (m.weight + ridge) * (fit.determinant / (ridge * ridge * ridge));
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

/// Does the ground jump along the border, up if `toward` is above 0, else down? One bent surface rises there by the
/// mean of both planes' slopes.
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

/// The angle, across the line along which they meet, against its uncertainty; both multiplied by the angle's square.
bool PlaneEvidence::crease_between(const Plane& first, const Plane& second) const {
  const float x = second.slope_x - first.slope_x, y = second.slope_y - first.slope_y;
  const float bend = prior_.curvature_1_m * (x * (second.x_m - first.x_m) + y * (second.y_m - first.y_m));
  return square(x * x + y * y) > gate * (first.rise_variance_m2(x, y) + second.rise_variance_m2(x, y) + bend * bend);
}

}  // namespace curbline
