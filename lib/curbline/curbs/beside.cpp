#include "curbline/curbs/beside.hpp"

namespace curbline {

Deviation deviation(const Beside& beside, const Plane& plane, float away, float further_cells, float common_m2) {
  const float n = beside.borders;
  if (!(n > 0.0f)) return {};
  const float away_m = away * (beside.off_m + further_cells * beside.rise_m) / n;
  const float q = beside.away_cells / n + further_cells;
  const float of_two = square(1.0f + q) + square(q);
  return {away_m, plane.fit_variance_m2 * of_two / n, common_m2 * of_two, n};
}

}  // namespace curbline
