#include "curbline/curbs/bend.hpp"

#include <algorithm>

namespace curbline {

void BendSums::add(float x_m, float y_m, float above_m) {
  const float xx = x_m * x_m, xy = x_m * y_m, yy = y_m * y_m;
  cells_ += 1.0f;
  above_m_ += above_m;
  xx_ += xx, xy_ += xy, yy_ += yy;
  x4_ += xx * xx, x3y_ += xx * xy, x2y2_ += xx * yy, xy3_ += xy * yy, y4_ += yy * yy;
  xx_above_ += xx * above_m, xy_above_ += xy * above_m, yy_above_ += yy * above_m;
}

float BendSums::likelier_bent(const Bend& bend, float variance_m2) const {
  if (!(cells_ > 0.0f)) return 0.0f;
  const float a = square(bend.dx), b = 2.0f * bend.dx * bend.dy, c = square(bend.dy);
  const float squares = a * xx_ + b * xy_ + c * yy_;  // of distances along the bend
  const float fourth =
      a * a * x4_ + 2.0f * a * b * x3y_ + (2.0f * a * c + b * b) * x2y2_ + 2.0f * b * c * xy3_ + c * c * y4_;
  const float mean = squares / cells_;
  const float above = a * xx_above_ + b * xy_above_ + c * yy_above_ - mean * above_m_;
  const float half_1_m = 0.5f * bend.curvature_1_m;
  return half_1_m * (above - 0.5f * half_1_m * (fourth - mean * squares)) / variance_m2;
}

bool one_bend(const Plane& first, const BendSums& of_first, const Plane& second, const BendSums& of_second) {
  constexpr float sure = 0.5f * gate;  // three standard deviations, as a log likelihood ratio
  constexpr float contrary = -0.5f;    // one: cells that say hardly anything do so either way
  const Bend bend = Bend::between(first, second);
  const float one = of_first.likelier_bent(bend, first.fit_variance_m2);
  const float other = of_second.likelier_bent(bend, second.fit_variance_m2);
  return one + other > sure && std::min(one, other) > contrary;
}

}  // namespace curbline
