#include "curbline/beside.hpp"

#include "curbline/math.hpp"

namespace curbline {

Deviation deviation(const Beside& beside, const Plane& plane, float away, float further_cells) {
  const float n = beside.borders;
  if (!(n > 0.0f)) return {};
  const float away_m = away * (beside.off_m + further_cells * beside.rise_m) / n;
  const float q = beside.away_cells / n + further_cells;
  const float variance_m2 = plane.fit_variance_m2 * (square(1.0f + q) + square(q)) / n;
  return away_m > 0.0f && square(away_m) > gate * variance_m2 ? Deviation{away_m, variance_m2} : Deviation{};
}

}  // namespace curbline
