// Where a robot may drive, given the steps and slopes that it can take: answers for cells of the map and for curbs.
// Unknown ground is not passable.
#pragma once

#include <algorithm>
#include <span>

#include "curbline/curbs/curb.hpp"
#include "curbline/labels/label_field.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/planes/plane_mixture.hpp"

namespace curbline {

struct Mobility {
  float max_step_m = 0.0f;     ///< up or down, >= 0
  float max_slope_rad = 0.0f;  ///< against the map's x-y plane, [0, pi / 2)
};

/// May a plane be driven on?
bool passable(const Plane& plane, const Mobility& mobility);

/// May a curb be crossed? A step, if it is no higher than max_step_m with a probability of 97.5 %; a crease or a ramp
/// edge, if neither of its planes is steeper than max_slope_rad.
bool passable(const Curb& curb, const Plane& near, const Plane& far, const Mobility& mobility);

/// Does a curb go through the rectangle of half sides half_x_m and half_y_m around (x_m, y_m) of the map, with a
/// probability of more than 2.5 %? Its place is uncertain by position_sd_m, at its ends by twice that.
bool crosses(const Curb& curb, float x_m, float y_m, float half_x_m, float half_y_m);

/// Does a step that is too high go through cell (i, j)? Its cell may hold nothing but what the laser sees of the upper
/// side, if the step hides the rest of it. 20 operations a curb.
template <Limits limits>
bool in_the_way(const Dem<limits>& dem, std::span<const Curb> curbs, int i, int j, const Mobility& mobility) {
  return std::ranges::any_of(curbs, [&](const Curb& curb) {
    return is_step(curb) && !passable(curb, {}, {}, mobility) &&
           crosses(curb, dem.middle_x_m(i), dem.middle_y_m(j), 0.5f * dem.cell_x_m(), 0.5f * dem.cell_y_m());
  });
}

/// May a wheel stand in cell (i, j), which must be one of the window, and leave it? Yes, if its plane is ground and not
/// too steep, if the heights within it spread over no more than the step (the width of a uniform distribution of their
/// variance, less that of noise and of the plane's slope), if neither it nor the next cell within two cells along x and
/// y lies a step off the plane, and if the next ones to either side lie no more than a step apart: a cell of readings
/// that mix both sides of a step would make two lower ones of it. O(1).
template <Limits limits>
bool passable(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field, int i,
              int j, const Mobility& mobility) {
  const int slot = dem.slot(i, j);
  const Label label = field.label(slot);
  if (!dem.cell(slot).valid() || label == no_label || !mixture.ground(label)) return false;
  const Plane& plane = mixture.plane(label);
  if (!passable(plane, mobility)) return false;
  const float square_m2 = mobility.max_step_m * mobility.max_step_m;
  const Cell& here = dem.cell(slot);
  const float spread_m2 = dem.spread_m2(here) - dem.slope_m2(plane) * here.weight;
  if (square(dem.above_m(i, j, here, plane)) > square_m2 || 12.0f * spread_m2 > square_m2 * here.weight) return false;
  float before_m = 0.0f;
  for (std::size_t d = 0; d < directions; ++d) {
    const int g = dem.next_valid(slot, static_cast<int>(d), 2);
    const int a = i + g * step_i[d], b = j + g * step_j[d];
    const float above_m = g > 0 ? dem.above_m(a, b, dem.cell(dem.slot(a, b)), plane) : 0.0f;
    const bool other_side = d % 2 != 0;
    if (square(above_m) > square_m2 || (other_side && square(above_m - before_m) > square_m2)) return false;
    before_m = above_m;
  }
  return true;
}

}  // namespace curbline
