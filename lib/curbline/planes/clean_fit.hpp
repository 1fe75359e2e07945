// Fits planes of ground again, to the mean heights of the clean cells of their regions, which hold nothing else: cells
// that mix both sides of a step would tilt the plane of a small region toward the other. Grass and gravel spread in
// every cell: roughness is estimated from all cells of a region together. Cost: two passes over the window.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "curbline/grid.hpp"
#include "curbline/map/cell.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/per_cell.hpp"
#include "curbline/plane.hpp"
#include "curbline/planes/ground.hpp"
#include "curbline/point.hpp"

namespace curbline {

/// The fit of one plane.
struct CleanFit {
  /// Of so many cells one in fourteen lies along a side: the fit can do without those that a step crosses.
  static constexpr float wide_cells = 200.0f;
  /// A narrower region is all rim: the spread in its cells may be that of a step on which they lie.
  static constexpr float rim_cells = 3.0f;
  /// Of so many points, in a cell half on each side of a step, all are of one side by chance once in 32 times.
  static constexpr float conclusive_points = 6.0f;

  bool wanted = false;  ///< to be fitted again
  bool wide = false, steep = false;
  bool conclusive = false;                           ///< at least one cell is clean beyond doubt
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
    const bool by_step = step_m > 0.0f;
    (by_step ? beside : inner).add_cell(cell);
    bias_m2 += cell.weight * step_m * step_m * (1.0f / 12);
    conclusive = conclusive || (!by_step && cell_points >= conclusive_points);
  }
  /// Replaces the plane of the region, if there are enough clean cells, or one beyond doubt. The region's variance
  /// stays, for labels. Cells beside a step are off by anything up to half of it, all alike: one observation together.
  void fit(Plane& plane, const PlanePrior& prior, float common_m2, float min_cells) {
    plane.points_a_cell = points / cells;
    if (inner.cells + beside.cells < min_cells && !conclusive) return;
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

/// The fits of all planes, and which cells are clean for them. Lives for one PlaneMixture::update() or refine().
template <Limits limits>
class CleanFits {
 public:
  using Wanted = std::array<bool, limits.planes>;  ///< by label

  /// `region_label`: for each valid cell, the plane of its region. `crossed`: the cells that steps cross.
  CleanFits(const Dem<limits>& dem, const Ground<limits>& ground, const CellLabels<limits>& region_label,
            const Viewpoint& view, const CellSet<limits>& crossed)
      : dem_(dem), ground_(ground), region_label_(region_label), view_(view), crossed_(crossed) {}

  /// Fits those of the wanted planes that are ground, with at least min_cells; sets the roughness of all.
  /// label_of(slot) is a cell's own label, or no_label.
  template <typename LabelOf>
  void fit(std::span<Plane, limits.planes> planes, const Wanted& wanted, LabelOf&& label_of, float min_cells) const;

 private:
  bool lies_nearer(int i, int j, const Cell& cell, const Plane& one, const Plane& other) const;
  float step_beside_m(int i, int j, int s, bool crossed) const;

  const Dem<limits>& dem_;
  const Ground<limits>& ground_;
  const CellLabels<limits>& region_label_;
  const Viewpoint& view_;
  const CellSet<limits>& crossed_;
};

/// Clean cells hold nothing else than their region's plane, and have no other label on whose plane they lie better. If
/// a step is low, the heights within a cell do not show it: a wide plane does without the cells that a step crosses; a
/// small one needs them. Those hold something of the other side, and a cell behind a step down lies too high, all along
/// the step alike: together they are one observation, off by anything up to half of the step.
template <Limits limits>
template <typename LabelOf>
void CleanFits<limits>::fit(std::span<Plane, limits.planes> planes, const Wanted& wanted, LabelOf&& label_of,
                            float min_cells) const {
  std::array<CleanFit, limits.planes> fits{};
  dem_.for_each_valid([&](int, int, int s) {
    if (region_label_[s] != no_label) fits[region_label_[s]].look_at(dem_.cell(s));
  });
  for (std::size_t l = 0; l < fits.size(); ++l) {
    fits[l].wanted = wanted[l] && ground_.is(static_cast<int>(l));
    fits[l].wide = planes[l].cells >= CleanFit::wide_cells;
    fits[l].steep = planes[l].steeper_than_ramp();
    fits[l].slope_m2 = dem_.slope_m2(planes[l]);
    const bool all_rim = planes[l].narrower_than(CleanFit::rim_cells * std::max(dem_.cell_x_m(), dem_.cell_y_m()));
    planes[l].rough_m2 = all_rim ? 0.0f : fits[l].rough_m2(dem_.prior().noise_m2);
  }
  dem_.for_each_valid([&](int i, int j, int s) {
    const Label label = region_label_[s];
    if (label == no_label || !fits[label].wanted) return;
    CleanFit& fit = fits[label];
    const Cell& cell = dem_.cell(s);
    if (dem_.mixed(cell, fit.slope_m2, planes[label].rough_m2)) return;
    const bool is_crossed = crossed_.contains(s);
    if (fit.wide && is_crossed) return;
    const Label own = label_of(s);
    if (own != label && own != no_label && lies_nearer(i, j, cell, planes[own], planes[label])) return;
    fit.add(dem_.moments(i, j, cell), cell.points, fit.wide ? 0.0f : step_beside_m(i, j, s, is_crossed));
  });
  for (std::size_t l = 0; l < fits.size(); ++l) {
    if (fits[l].wanted) fits[l].fit(planes[l], dem_.prior(), dem_.common_m2(), min_cells);
  }
}

/// Is a cell nearer to one plane than to the other?
template <Limits limits>
bool CleanFits<limits>::lies_nearer(int i, int j, const Cell& cell, const Plane& one, const Plane& other) const {
  const float above_one_m = dem_.above_m(i, j, cell, one), above_other_m = dem_.above_m(i, j, cell, other);
  return one.alive() && above_one_m * above_one_m < above_other_m * above_other_m;
}

/// Height of the step beside a cell: how far it lies below the next ones toward the laser, of other regions, and, if a
/// step crosses it, above or below any next one of other regions of ground; 0 if there are none.
template <Limits limits>
float CleanFits<limits>::step_beside_m(int i, int j, int s, bool crossed) const {
  const Cell& cell = dem_.cell(s);
  const int along_x = dem_.centroid_x_m(i, cell) < view_.x_m ? 1 : -1;
  const int along_y = dem_.centroid_y_m(j, cell) < view_.y_m ? 1 : -1;
  const std::array<int, 4> beside{direction(0, along_x), direction(1, along_y),  // toward the laser
                                  direction(0, -along_x), direction(1, -along_y)};
  float most_m = 0.0f;
  for (std::size_t k = 0; k < (crossed ? 4u : 2u); ++k) {
    if (dem_.next_valid(s, beside[k], 1) == 0) continue;
    const int next = dem_.slot_beside(s, beside[k], 1);
    const Label other = region_label_[next];
    if (other == region_label_[s]) continue;
    const float step_m = dem_.cell(next).height_m - cell.height_m;
    if (k < 2) most_m = std::max(most_m, step_m);
    if (crossed && other != no_label && ground_.is(other)) most_m = std::max(most_m, magnitude(step_m));
  }
  return most_m;
}

}  // namespace curbline
