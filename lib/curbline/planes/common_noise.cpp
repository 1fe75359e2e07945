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

void PatchResiduals::add(float x_cells, float y_cells, float above_m, const SinCos& ahead) {
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

  constexpr float last = side - 1;
  const float from_x = ahead.cos < 0.0f ? x_cells - last : x_cells;  // from the corner that is farthest behind
  const float from_y = ahead.sin < 0.0f ? y_cells - last : y_cells;
  Row& row = rows[static_cast<std::size_t>(from_x * ahead.cos + from_y * ahead.sin + 0.5f)];
  row.cells += 1.0f;
  row.x += x_cells;
  row.y += y_cells;
  row.off_m += above_m;
}

auto PatchResiduals::fit() const -> Fit {
  const float n = cells;
  // Scatter times n: integers.
  const float sxx = n * xx - x * x, sxy = n * xy - x * y, syy = n * yy - y * y, determinant = sxx * syy - sxy * sxy;
  const float sxz = n * x_off_m - x * off_m, syz = n * y_off_m - y * off_m;
  const float slope_x = (syy * sxz - sxy * syz) / determinant, slope_y = (sxx * syz - sxy * sxz) / determinant;
  const float left_m2 = (squares_m2 - (off_m * off_m + slope_x * sxz + slope_y * syz) / n) / n;
  return {(off_m - slope_x * x - slope_y * y) / n, {slope_x, slope_y}, left_m2};
}

auto PatchResiduals::noise() const -> Noise {
  const Fit plane = fit();
  return {common_m2(plane), line_m2(plane)};
}

float PatchResiduals::common_m2(const Fit& plane) const {
  const float n = cells;
  if (!(plane.left_m2 > 0.0f)) return 0.0f;

  float common_m2 = plane.left_m2;
  for (int round = 0; round < 2; ++round) {
    const float variance_m2 = plane.left_m2 + 3.0f / n * common_m2;  // what the plane's three parameters absorbed
    common_m2 = variance_m2;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Rises& rise = rises[axis];
      const float slope_m = plane.slope_m[axis];
      if (!(rise.pairs > 0.0f)) continue;
      const float apart_m2 = (rise.squares_m2 + slope_m * (rise.pairs * slope_m - 2.0f * rise.sum_m)) / rise.pairs;
      common_m2 *= inflation(1.0f - 0.5f * apart_m2 / variance_m2);
    }
  }
  return common_m2;
}

/// Mean squares between the rows and within them. Of the plane's parameters, the rows lack two: level and slope ahead.
float PatchResiduals::line_m2(const Fit& plane) const {
  float count = 0.0f, between_m2 = 0.0f;
  for (const Row& row : rows) {
    if (!(row.cells > 0.0f)) continue;
    const float left_m = row.off_m - row.cells * plane.level_m - row.x * plane.slope_m[0] - row.y * plane.slope_m[1];
    count += 1.0f;
    between_m2 += left_m * left_m / row.cells;
  }
  const float between = count - 2.0f, within = cells - count - 1.0f;
  if (!(between > 0.0f && within > 0.0f)) return 0.0f;
  return (between_m2 / between - (plane.left_m2 * cells - between_m2) / within) * count / cells;
}

}  // namespace curbline
