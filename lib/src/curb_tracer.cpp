#include "curbline/curb_tracer.hpp"

#include <cmath>

namespace curbline {

const char* to_string(CurbKind kind) {
  switch (kind) {
    case CurbKind::step_up: return "step_up";
    case CurbKind::step_down: return "step_down";
    case CurbKind::crease: return "crease";
  }
  return "unknown";
}

bool is_crease(const Plane& first, const Plane& second, const LineFit::Segment& border, const DrawnBorder& drawn) {
  const float across = border.normal_x * (second.slope_x - first.slope_x) + border.normal_y * (second.slope_y - first.slope_y);
  const float steep = across < 0.0f ? -across : across, step_m = drawn.height_m < 0.0f ? -drawn.height_m : drawn.height_m;
  const float cell_sd_m = square_root(0.5f * (first.variance_m2 + second.variance_m2));
  const bool meet_near = step_m <= steep * drawn.reach_m + 2.0f * drawn.height_sd_m;
  return meet_near && step_m <= steep * drawn.half_gap_m + 2.0f * (drawn.height_sd_m + cell_sd_m);
}

float square_root(float x) { return std::sqrt(x); }

LineFit::Segment LineFit::segment(float x0_m, float y0_m, float x1_m, float y1_m, float margin_m) const {
  // Eigenvector of the larger eigenvalue of the scatter, from whichever row keeps more digits.
  const float half_difference = 0.5f * (xx_ - yy_);
  const float radius = square_root(half_difference * half_difference + xy_ * xy_);
  float ux = half_difference >= 0.0f ? half_difference + radius : xy_;
  float uy = half_difference >= 0.0f ? xy_ : radius - half_difference;
  const float length = square_root(ux * ux + uy * uy);
  if (!(length > 0.0f)) return {x0_m, y0_m, x1_m, y1_m, 0.0f, 0.0f};
  ux /= length;
  uy /= length;
  const float margin = margin_m * ((x1_m - x0_m) * ux + (y1_m - y0_m) * uy < 0.0f ? -1.0f : 1.0f);
  const float t0 = (x0_m - x_) * ux + (y0_m - y_) * uy - margin, t1 = (x1_m - x_) * ux + (y1_m - y_) * uy + margin;
  return {x_ + t0 * ux, y_ + t0 * uy, x_ + t1 * ux, y_ + t1 * uy, -uy, ux};
}

}  // namespace curbline
