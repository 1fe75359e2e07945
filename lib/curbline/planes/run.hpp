// Runs: cells of one plane's region on a row or column of the window, with no cell of another between, and how the
// laser sees them. Used to find strips between two planes, or beside an obstacle (ground.hpp). Cost: a pass over the
// window along x, and one along y.
#pragma once

#include <algorithm>
#include <optional>

#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/cell.hpp"
#include "curbline/map/cell_line.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/per_cell.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"

namespace curbline {

/// How the laser sees a row or column.
struct Sight {
  const Viewpoint& view;
  float eye_m;    ///< the laser's coordinate along it, from the window's lowest corner
  float cell_m;   ///< length of a cell
  float end_m;    ///< Viewpoint::end_m()
  float aside_m;  ///< its middle, from the laser

  /// The viewpoint must outlive it.
  template <Limits limits>
  static Sight along(const CellLine<limits>& line, const Viewpoint& view) {
    return {view, view.place_m(line.axis), line.pitch_m(), view.end_m(line.axis),
            line.across_m() - view.place_m(1 - line.axis)};
  }

  bool ahead(int cell) const { return static_cast<float>(cell) * cell_m > eye_m; }
  /// Distance from the laser to the near end of a run; on a robot that drives, the largest from which it may have been
  /// seen. At most 0 if the laser is above the run.
  float away_m(int first, int last) const {
    const bool is_ahead = ahead(first);
    const float away_m =
        is_ahead ? static_cast<float>(first) * cell_m - eye_m : eye_m - static_cast<float>(last + 1) * cell_m;
    const float from_end_m = is_ahead ? end_m - eye_m : eye_m;
    return end_m > 0.0f && away_m > 0.0f && away_m < from_end_m ? from_end_m : away_m;
  }
  /// The same for an edge at an angle to the grid: as if the laser were where the edge's parallel through it crosses
  /// the row or column.
  Sight across(float askew) const { return {view, eye_m - aside_m * askew, cell_m, end_m, aside_m}; }
  /// The same for a laser that stands where cells were last seen from.
  Sight standing() const { return {view, eye_m, cell_m, 0.0f, aside_m}; }
};

/// Tangent of the angle between an axis and the normal of a strip, (pxx, pxy) or (pxy, pyy).
inline float askew(const Plane& strip, int axis) {
  const float along = axis == 0 ? strip.pxx : strip.pyy;
  return along > 0.0f ? strip.pxy / along : 0.0f;
}

/// How far a run falls from its end near the laser to the far one, and how far the rays do there.
struct Fall {
  float own_m = 0.0f, of_rays_m = 0.0f;
};

/// Cells of one plane, with none of another between; of no plane before the first and after the last of a row or
/// column.
struct Run {
  Label label = no_label;
  int first = 0, last = 0;
  int cells = 0;  ///< that have been seen
  float first_height_m = 0.0f, last_height_m = 0.0f, lowest_m = 0.0f, highest_m = 0.0f;
  float scatter_m2 = 0.0f, weight = 0.0f;
  float above_m = 0.0f, above_m2 = 0.0f;  ///< weighted sums of heights above the first one, and of their squares

  Run() = default;
  Run(Label plane, int at, const Cell& cell)
      : label(plane),
        first(at),
        last(at),
        cells(1),
        first_height_m(cell.height_m),
        last_height_m(cell.height_m),
        lowest_m(cell.height_m),
        highest_m(cell.height_m),
        scatter_m2(cell.scatter_m2),
        weight(cell.weight) {}

  void add(int at, const Cell& cell) {
    last = at;
    ++cells;
    last_height_m = cell.height_m;
    if (cell.height_m < lowest_m) lowest_m = cell.height_m;
    if (cell.height_m > highest_m) highest_m = cell.height_m;
    scatter_m2 += cell.scatter_m2;
    weight += cell.weight;
    const float above_first_m = cell.height_m - first_height_m;
    above_m += cell.weight * above_first_m;
    above_m2 += cell.weight * above_first_m * above_first_m;
  }
  bool any() const { return label != no_label; }
  int length() const { return last - first + 1; }
};

/// A run, and the runs before and after it on its row or column.
struct Strip {
  const Run &before, &run, &next;

  /// Is it between two other runs, neither more than `gap` cells away?
  bool between(int gap) const { return follows(gap) && precedes(gap); }
  /// Is no other run within `gap` cells of it, on either side?
  bool alone(int gap) const { return !follows(gap) && !precedes(gap); }
  /// Is it between the heights of those two?
  bool rises_between() const {
    const float from = before.last_height_m, to = next.first_height_m;
    return (from < run.lowest_m && run.highest_m < to) || (from > run.highest_m && run.lowest_m > to);
  }
  /// Is it between two runs and above both?
  bool stands() const {
    return before.any() && next.any() && run.lowest_m > before.last_height_m && run.lowest_m > next.first_height_m;
  }
  /// The scatter of its cells if each held, with its mean height, nothing but the levels of the two runs beside it.
  float two_levels_m2() const {
    const float before_m = before.last_height_m - run.first_height_m, next_m = next.first_height_m - run.first_height_m;
    return (before_m + next_m) * run.above_m - run.above_m2 - before_m * next_m * run.weight;
  }
  /// For a strip between two planes (between(), rises_between()): if the step leads down as the laser sees
  /// it, and the strip is no wider than its shadow (shadow.hpp) and a cell, as those at its ends hold some of the
  /// planes, how far the strip falls. Inlined: calls would cost the worst line of a Cortex-M7 20,000 instructions
  /// (tools/budget).
  [[gnu::always_inline]] std::optional<Fall> fall_in_shadow(const Sight& sight) const {
    const bool ahead = sight.ahead(run.first);
    const float near_m = ahead ? before.last_height_m : next.first_height_m;
    const float drop_m = ahead ? near_m - next.first_height_m : near_m - before.last_height_m;
    const float above_m = sight.view.z_m - near_m, away_m = sight.away_m(run.first, run.last);
    if (!(above_m > 0.0f) || !(away_m > 0.0f)) return std::nullopt;
    const float of_rays_m = static_cast<float>(run.length() - 1) * sight.cell_m * above_m / away_m;
    const float own_m = ahead ? run.first_height_m - run.last_height_m : run.last_height_m - run.first_height_m;
    if (!(of_rays_m <= drop_m)) return std::nullopt;
    return Fall{own_m, of_rays_m};
  }
  /// Number of cells that hold something of both sides of an edge here, when they were last seen like this: one, as
  /// many more as an edge at an angle to the grid crosses on a row (one if that is 45 degrees; beyond, it lies along
  /// the row), and the length of the laser's spot on the ground.
  float blurred_cells(const Sight& sight, float askew) const {
    const float above_m = sight.view.z_m - run.first_height_m, away_m = sight.standing().away_m(run.first, run.last);
    if (!(above_m > 0.0f)) return 0.0f;
    const float range_m2 = above_m * above_m + away_m * away_m + sight.aside_m * sight.aside_m;
    const float crossed = std::min(1.0f, magnitude(askew));
    return 1.0f + crossed + sight.view.spot_m(range_m2, above_m) / sight.cell_m;
  }

 private:
  bool follows(int gap) const { return before.any() && run.first - before.last <= gap; }
  bool precedes(int gap) const { return next.any() && next.first - run.last <= gap; }
};

/// Calls visit(strip, line) for each run along x (axis 0) or y (1), column by column, or row by row.
template <Limits limits, typename Visit>
void for_each_run(const Dem<limits>& dem, int axis, const CellLabels<limits>& region_label, Visit&& visit) {
  for (int across = 0; across < dem.cells_along(1 - axis); ++across) {
    const CellLine<limits> line{dem, axis, across};
    Run before, run;
    const auto end_run = [&](const Run& next) {
      if (run.any()) visit(Strip{before, run, next}, line);
      before = run;
      run = next;
    };
    dem.for_each_valid_along(axis, across, [&](int k, int s) {
      const Label label = region_label[s];
      if (label == no_label) return;
      const Cell& cell = dem.cell(s);
      if (label == run.label) {
        run.add(k, cell);
      } else {
        end_run(Run(label, k, cell));
      }
    });
    end_run(Run{});
  }
}

}  // namespace curbline
