// Fits a plane of ground anew to those cells of its region that hold nothing else: what mixes both sides of a step
// would tilt the plane of a small region toward the other. PlaneMixture says which cells these are. Grass and gravel
// spread in every cell: how rough the ground is all cells of a region tell together.
#pragma once

#include "curbline/map/cell.hpp"
#include "curbline/plane.hpp"

namespace curbline {

struct CleanFit {
  /// Of as many one in fourteen lies along a side: those that a step crosses are not missed.
  static constexpr float wide_cells = 200.0f;
  /// A region narrower than that is all rim: what spreads in its cells may be a step that they lie on.
  static constexpr float rim_cells = 3.0f;
  /// Of so many points of a cell that holds both sides of a step in halves all are of one by chance once in 32 times.
  static constexpr float telling_points = 6.0f;

  bool wanted = false;  ///< of no other plane anything is counted
  bool wide = false, steep = false;
  bool told = false;                                 ///< a clean cell is sure to be one
  float slope_m2 = 0.0f;                             ///< Dem::slope_m2() of the region's plane
  float cells = 0.0f, points = 0.0f, weight = 0.0f;  ///< of the region
  float sure = 0.0f, precision_1_m2 = 0.0f;          ///< sums over cells of what look_at() tells
  PlaneMoments inner{}, beside{};                    ///< of clean cells away from steps, and of those beside one
  float bias_m2 = 0.0f;                              ///< of those, each by its weight

  /// Each cell of the region, before any is added. What mixes both sides of a step spreads more than the others, by any
  /// amount: so the precisions that cells tell are averaged, not the variances. Of n points that is (n - 3) / scatter,
  /// its relative variance 2 / (n - 5).
  void look_at(const Cell& cell) {
    cells += 1.0f;
    points += cell.points;
    weight += cell.weight;
    const float sureness = cell.points - 5.0f;
    if (!(sureness > 0.0f)) return;
    sure += sureness;
    precision_1_m2 += sureness * (cell.points - 3.0f) / cell.scatter_m2;
  }
  /// Variance of the heights within a cell beyond what the expected noise and the slope make.
  float rough_m2(float expected_m2) const {
    const float beyond_m2 = (sure / precision_1_m2 - expected_m2) * points / weight - slope_m2;
    return beyond_m2 > 0.0f ? beyond_m2 : 0.0f;  // 0 if no cell tells, too
  }
  /// A clean cell of so many points that lies beside a step, or of which one crosses it; of none the step is 0.
  void add(PlaneMoments cell, float cell_points, float step_m) {
    if (!steep) cell.zz = 0.0f;
    if (!(step_m > 0.0f)) {
      told = told || cell_points >= telling_points;
      return inner.add_cell(cell);
    }
    beside.add_cell(cell);
    bias_m2 += cell.weight * step_m * step_m * (1.0f / 12);
  }
  /// The plane, if there are cells enough, or one that is sure to hold nothing else, where it was that of the region.
  /// What is the region's stays: by it labels go. Cells beside a step are off by up to the half of it, anywhere, all
  /// alike: one observation together.
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
