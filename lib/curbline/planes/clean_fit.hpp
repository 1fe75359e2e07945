// Fits a plane of ground again, to the clean cells of its region, which hold nothing else: cells that mix both sides of
// a step would tilt the plane of a small region toward the other. PlaneMixture decides which cells are clean. Grass and
// gravel spread in every cell: roughness is estimated from all cells of a region together.
#pragma once

#include "curbline/map/cell.hpp"
#include "curbline/plane.hpp"

namespace curbline {

struct CleanFit {
  /// Of so many cells one in fourteen lies along a side: the fit can do without those that a step crosses.
  static constexpr float wide_cells = 200.0f;
  /// A narrower region is all rim: the spread in its cells may be that of a step on which they lie.
  static constexpr float rim_cells = 3.0f;
  /// Of so many points, in a cell half on each side of a step, all are of one side by chance once in 32 times.
  static constexpr float telling_points = 6.0f;

  bool wanted = false;  ///< to be fitted again
  bool wide = false, steep = false;
  bool told = false;                                 ///< at least one cell is clean beyond doubt
  float slope_m2 = 0.0f;                             ///< Dem::slope_m2() of the region's plane
  float cells = 0.0f, points = 0.0f, weight = 0.0f;  ///< of the region
  float sure = 0.0f, precision_1_m2 = 0.0f;          ///< sums of look_at(), over cells
  PlaneMoments inner{}, beside{};                    ///< clean cells away from steps, and beside one
  float bias_m2 = 0.0f;                              ///< of the latter, weighted

  /// Call for each cell of the region, before any is added. A cell that mixes both sides of a step spreads by any
  /// amount more than the others, so precisions are averaged, not variances. The precision from n points is (n - 3) /
  /// scatter, with a relative variance of 2 / (n - 5).
  void look_at(const Cell& cell) {
    cells += 1.0f;
    points += cell.points;
    weight += cell.weight;
    const float sureness = cell.points - 5.0f;
    if (!(sureness > 0.0f)) return;
    sure += sureness;
    precision_1_m2 += sureness * (cell.points - 3.0f) / cell.scatter_m2;
  }
  /// Variance of the heights within a cell beyond expected noise and slope.
  float rough_m2(float expected_m2) const {
    const float beyond_m2 = (sure / precision_1_m2 - expected_m2) * points / weight - slope_m2;
    return beyond_m2 > 0.0f ? beyond_m2 : 0.0f;  // 0 too if no cell has points enough
  }
  /// A clean cell with so many points. step_m: height of the step beside it or across it, 0 if there is none.
  void add(PlaneMoments cell, float cell_points, float step_m) {
    if (!steep) cell.zz = 0.0f;
    if (!(step_m > 0.0f)) {
      told = told || cell_points >= telling_points;
      return inner.add_cell(cell);
    }
    beside.add_cell(cell);
    bias_m2 += cell.weight * step_m * step_m * (1.0f / 12);
  }
  /// Replaces the plane of the region, if there are enough clean cells, or one beyond doubt. The region's variance
  /// stays, for labels. Cells beside a step are off by anything up to half of it, all alike: one observation together.
  void fit(Plane& plane, const PlanePrior& prior, float common_m2, float min_cells) {
    plane.points_a_cell = points / cells;
    if (inner.cells + beside.cells < min_cells && !told) return;
    if (bias_m2 > prior.noise_m2) beside.scale(prior.noise_m2 / bias_m2);
    inner.add(beside);
    const float share_m2 = common_m2 * (1.0f + plane.rough_m2 / prior.noise_m2);
    Plane anew = steep ? fit_plane(inner, prior) : fit_plane_to_means(inner, prior, share_m2);
    anew.variance_m2 = plane.variance_m2;
    anew.points_a_cell = plane.points_a_cell;
    anew.rough_m2 = plane.rough_m2;
    plane = anew;
  }
};

}  // namespace curbline
