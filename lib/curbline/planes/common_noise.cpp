#include "curbline/planes/common_noise.hpp"

namespace curbline {
namespace {

/// Factor of a cell's variance for neighbours along an axis that correlate by r.
float inflation(float r) {
  constexpr float most = 0.9f;  // reaches over ten cells, a patch: a longer correlation looks like its plane
  if (r > most) r = most;
  if (!(r > -most)) r = -most;
  return (1.0f + r) / (1.0f - r);
}

}  // namespace

void PatchResiduals::add(float x_cells, float y_cells, float above_m) {
  cells += 1.0f;
  x += x_cells;
  y += y_cells;
  xx += x_cells * x_cells;
  xy += x_cells * y_cells;
  yy += y_cells * y_cells;
  off_m += above_m;
  x_off_m += x_cells * above_m;
  y_off_m += y_cells * above_m;
  squares_m2 += above_m * above_m;
}

float PatchResiduals::common_m2() const {
  const float n = cells;
  // Scatter times n: integers.
  const float sxx = n * xx - x * x, sxy = n * xy - x * y, syy = n * yy - y * y, determinant = sxx * syy - sxy * sxy;
  const float sxz = n * x_off_m - x * off_m, syz = n * y_off_m - y * off_m;
  const float slope[2] = {(syy * sxz - sxy * syz) / determinant, (sxx * syz - sxy * sxz) / determinant};
  const float left_m2 = (squares_m2 - (off_m * off_m + slope[0] * sxz + slope[1] * syz) / n) / n;
  if (!(left_m2 > 0.0f)) return 0.0f;

  float common_m2 = left_m2;
  for (int round = 0; round < 2; ++round) {
    const float variance_m2 = left_m2 + 3.0f / n * common_m2;  // what the plane's three parameters absorbed
    common_m2 = variance_m2;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Rises& rise = rises[axis];
      if (!(rise.pairs > 0.0f)) continue;
      const float apart_m2 =
          (rise.squares_m2 + slope[axis] * (rise.pairs * slope[axis] - 2.0f * rise.sum_m)) / rise.pairs;
      common_m2 *= inflation(1.0f - 0.5f * apart_m2 / variance_m2);
    }
  }
  return common_m2;
}

}  // namespace curbline
