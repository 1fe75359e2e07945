// The cells that steps cross, by the curbs of the last call, within the standard deviation of their positions. They
// hold readings of both sides, although, if the step is low, their heights do not show it. (Without that deviation,
// where all cells of a mixed column bear the lower side's label, the curb lies beside them and they would tilt its
// plane.) Cost: 30 operations for each row or column of cells that a curb goes through.
#pragma once

#include <algorithm>
#include <span>
#include <utility>

#include "curbline/curbs/curb.hpp"
#include "curbline/grid.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/per_cell.hpp"

namespace curbline {

/// Calls visit(x, y) for each cell crossed by a curb from (x0, y0) to (x1, y1), or by one up to `aside` beside it in y,
/// in cells of the window, x being the axis along which it is longer: x from 0 to end_x - 1, y unbounded.
template <typename Visit>
void for_each_crossed(float x0, float y0, float x1, float y1, float aside, int end_x, Visit&& visit) {
  if (x0 > x1) std::swap(x0, x1), std::swap(y0, y1);
  const float slope = x1 > x0 ? (y1 - y0) / (x1 - x0) : 0.0f;
  if (!(x1 >= 0.0f)) return;
  for (int x = x0 > 0.0f ? static_cast<int>(x0) : 0; x < end_x && static_cast<float>(x) <= x1; ++x) {
    const float enters = static_cast<float>(x), leaves = enters + 1.0f;
    const float a = y0 + slope * (std::max(x0, enters) - x0);
    const float b = y0 + slope * (std::min(x1, leaves) - x0);
    const int last = floor_to_int(std::max(b, a) + aside);
    for (int y = floor_to_int(std::min(b, a) - aside); y <= last; ++y) visit(x, y);
  }
}

/// For steps with both sides in view.
template <Limits limits>
CellSet<limits> crossed_cells(const Dem<limits>& dem, std::span<const Curb> curbs) {
  CellSet<limits> crossed;
  const float cells_x = 1.0f / dem.cell_x_m(), cells_y = 1.0f / dem.cell_y_m();
  const auto near = [](float cells) { return cells > -1e6f && cells < 1e6f; };  // else the window has jumped away
  for (const Curb& curb : curbs) {
    if (!is_step(curb) || curb.far_label == no_label) continue;
    float x0 = (curb.x0_m - dem.origin_x_m()) * cells_x, y0 = (curb.y0_m - dem.origin_y_m()) * cells_y;
    float x1 = (curb.x1_m - dem.origin_x_m()) * cells_x, y1 = (curb.y1_m - dem.origin_y_m()) * cells_y;
    if (!near(x0) || !near(y0) || !near(x1) || !near(y1)) continue;
    const int axis = square(x1 - x0) >= square(y1 - y0) ? 0 : 1;
    if (axis == 1) std::swap(x0, y0), std::swap(x1, y1);
    // Aslant to the cells the deviation is up to sqrt(2) times as long along y. At most a cell: more are not a border.
    const float aside = std::min(1.0f, curb.position_sd_m * (axis == 0 ? cells_y : cells_x));
    for_each_crossed(x0, y0, x1, y1, aside, dem.cells_along(axis), [&](int x, int y) {
      const int i = axis == 0 ? x : y, j = axis == 0 ? y : x;
      if (dem.contains(i, j)) crossed.insert(dem.slot(i, j));
    });
  }
  return crossed;
}

}  // namespace curbline
