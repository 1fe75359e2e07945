#include "curbline/curbs/off_plane.hpp"

namespace curbline {

float share_beyond(float chance_m2, float found_m) {
  const float found_m2 = square(found_m);
  return found_m2 > chance_m2 ? 1.0f - chance_m2 / found_m2 : 0.0f;
}

GroundAlong GroundAlong::of(float cells, float borders, float above_m, const Plane& plane) {
  if (!(cells > 0.0f)) return {};
  const float mean_m = above_m / cells, share = share_beyond(4.0f * plane.fit_variance_m2 / cells, mean_m);
  return {share * mean_m, share, plane.fit_variance_m2 / borders + square(mean_m)};
}

Deviation deviation(const Beside& beside, const Plane& plane, float away, float further_cells, float common_m2,
                    float line_m2) {
  const float n = beside.borders;
  if (!(n > 0.0f)) return {};
  const float away_m = away * (beside.off_m + further_cells * beside.rise_m) / n;
  const float q = beside.away_cells / n + further_cells;
  const float both = square(1.0f + q) + square(q);
  return {away_m, both * plane.fit_variance_m2 / n, 0.5f * common_m2 + both * line_m2 * beside.inverse_points / n, n};
}

}  // namespace curbline
