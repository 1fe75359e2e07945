#include "curbline/beside.hpp"

namespace curbline {

Deviation deviation(const Beside& beside, const Plane& plane, float away, float further_cells) {
  const float n = beside.borders;
  if (!(n > 0.0f)) return {};
  const float away_m = away * (beside.off_m + further_cells * beside.rise_m) / n;
  const float q = beside.away_cells / n + further_cells;
  return {away_m, plane.fit_variance_m2 * (square(1.0f + q) + square(q)) / n};
}

}  // namespace curbline
