#include "curbline/curbs/line_weights.hpp"

#include <algorithm>

#include "curbline/math.hpp"

namespace curbline {

LineWeights::LineWeights(const Plane& plane, const SinCos& ahead, float line_pitch_m, float x_m, float y_m)
    : pitch_m(line_pitch_m) {
  const float determinant = plane.pxx * plane.pyy - square(plane.pxy);
  const float scatter =
      plane.pyy * square(ahead.cos) - 2.0f * plane.pxy * ahead.cos * ahead.sin + plane.pxx * square(ahead.sin);
  // Of n rows, their middles' variance is (n^2 - 1) / 12 pitches squared.
  const float variance_m2 = scatter / (determinant * plane.cells) + square(pitch_m) * (1.0f / 12);
  middle_m = plane.x_m * ahead.cos + plane.y_m * ahead.sin;
  half_m = square_root(3.0f * variance_m2);
  growth_1_m = (x_m * ahead.cos + y_m * ahead.sin - middle_m) / variance_m2;
}

float LineWeights::times(const LineWeights& other) const {
  const float from_m = std::max(middle_m - half_m, other.middle_m - other.half_m);
  const float to_m = std::min(middle_m + half_m, other.middle_m + other.half_m);
  if (!(to_m > from_m)) return 0.0f;
  const float at_m = 0.5f * (from_m + to_m), length_m = to_m - from_m;
  const float mean = (1.0f + growth_1_m * (at_m - middle_m)) * (1.0f + other.growth_1_m * (at_m - other.middle_m)) +
                     growth_1_m * other.growth_1_m * square(length_m) * (1.0f / 12);
  return mean * length_m * pitch_m / (4.0f * half_m * other.half_m);
}

}  // namespace curbline
