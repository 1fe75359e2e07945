#include "curbline/curbs/plane_pair.hpp"

#include <algorithm>

namespace curbline {

CurbKind PlanePair::kind(const LineFit::Segment& border, const MeasuredStep& step) const {
  const float steep = magnitude(slope_across(border));
  const float cell_m2 = std::max(step.texture_m2, 0.5f * (one.fit_variance_m2 + other.fit_variance_m2));
  const float unknown_m2 = square(step.height_sd_m) + cell_m2 + square(steep) * step.place_variance_m2;
  const float open_m = one.steeper_than_ground() || other.steeper_than_ground() ? steep * step.half_gap_m : 0.0f;
  if (magnitude(step.height_m) > open_m + 2.0f * square_root(unknown_m2)) return CurbKind::step_up;
  const auto is_ramp = [&](const Plane& plane) {
    return magnitude(border.normal_x * plane.slope_x + border.normal_y * plane.slope_y) > least_ramp;
  };
  return is_ramp(one) != is_ramp(other) ? CurbKind::ramp_edge : CurbKind::crease;
}

}  // namespace curbline
