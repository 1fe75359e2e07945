#include "curbline/curbs/line_fit.hpp"

#include <algorithm>

#include "curbline/math.hpp"

namespace curbline {

float LineFit::squares() const {
  const float half_difference = 0.5f * (xx_ - yy_);
  return std::max(0.0f, 0.5f * (xx_ + yy_) - square_root(half_difference * half_difference + xy_ * xy_));
}

float LineFit::grown(float x_m, float y_m) const {
  const float dx_m = x_m - x_, dy_m = y_m - y_, along = xx_ + yy_ - squares();
  return along > 0.0f ? 1.0f + weight_ * (dx_m * dx_m + dy_m * dy_m) / along : 1.0f;
}

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
  if ((x1_m - x0_m) * ux + (y1_m - y0_m) * uy < 0.0f) ux = -ux, uy = -uy;
  const float t0 = (x0_m - x_) * ux + (y0_m - y_) * uy - margin_m, t1 = (x1_m - x_) * ux + (y1_m - y_) * uy + margin_m;
  return {x_ + t0 * ux, y_ + t0 * uy, x_ + t1 * ux, y_ + t1 * uy, -uy, ux};
}

void LineFit::Segment::reach(float x_m, float y_m, float margin_m) {
  const float ux = normal_y, uy = -normal_x;  // from the first end to the second
  const float before_m = (x0_m - x_m) * ux + (y0_m - y_m) * uy + margin_m;
  const float after_m = (x_m - x1_m) * ux + (y_m - y1_m) * uy + margin_m;
  if (before_m > 0.0f) x0_m -= before_m * ux, y0_m -= before_m * uy;
  if (after_m > 0.0f) x1_m += after_m * ux, y1_m += after_m * uy;
}

LineFit::Segment LineFit::across(float x_m, float y_m, float way_x, float way_y, float margin_m) {
  const float length = square_root(way_x * way_x + way_y * way_y);
  const float nx = length > 0.0f ? way_x / length : 1.0f, ny = length > 0.0f ? way_y / length : 0.0f;
  const float dx_m = margin_m * ny, dy_m = margin_m * nx;
  return {x_m + dx_m, y_m - dy_m, x_m - dx_m, y_m + dy_m, -nx, -ny};
}

}  // namespace curbline
