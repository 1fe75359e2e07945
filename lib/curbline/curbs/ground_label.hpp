// The plane of the ground under the middle of a cell. A cell's label is that of its readings. Beside a step those are
// of the side that the laser sees: at a step down, whose shadow hides where the lower side begins, the upper side, even
// if most of the cell lies below. The curb's line, known to a part of a cell, decides, for faces steeper than the
// laser's rays. Cost: 15 operations a curb.
#pragma once

#include <span>

#include "curbline/curbs/curb.hpp"
#include "curbline/labels/label_field.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/planes/plane_mixture.hpp"

namespace curbline {

/// By the step nearest to the middle of cell (i, j), within two cells (farther away readings are of their own side), if
/// it parts the plane of the readings from another that is in view and still ground (a curb may be a scan line old).
/// Else the cell's label.
template <Limits limits>
Label ground_label(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field,
                   std::span<const Curb> curbs, int i, int j) {
  const Label of_readings = field.label(dem.slot(i, j));
  if (of_readings == no_label) return of_readings;
  const float x_m = dem.middle_x_m(i), y_m = dem.middle_y_m(j);
  float nearest_m = dem.cell_x_m() + dem.cell_y_m();
  Label found = of_readings;
  for (const Curb& curb : curbs) {
    if (!is_step(curb) || curb.far_label == no_label) continue;
    if (of_readings != curb.near_label && of_readings != curb.far_label) continue;
    const float to_far_m = to_far_side_m(curb, x_m, y_m);
    const float away_m = magnitude(to_far_m);
    const Label there = to_far_m > 0.0f ? curb.far_label : curb.near_label;
    if (!(away_m < nearest_m) || !mixture.ground(there)) continue;
    nearest_m = away_m;
    found = there;
  }
  return found;
}

}  // namespace curbline
