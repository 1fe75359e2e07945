// The mixture of planes. Each label is a slot for one plane. At each update the largest regions become planes, each
// with the label that its cells overlap most, so that a plane keeps its label while it grows, is cut and merged; a
// label that no region takes dies. Planes of ground are then fitted to the cells that hold nothing else. Cost: four
// passes over the window, K^3 for the matching, and ground.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "curbline/counters.hpp"
#include "curbline/grid.hpp"
#include "curbline/index_set.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/per_cell.hpp"
#include "curbline/plane.hpp"
#include "curbline/planes/clean_fit.hpp"
#include "curbline/planes/ground.hpp"
#include "curbline/planes/region_ranking.hpp"
#include "curbline/regions/segmentation.hpp"
#include "curbline/settings.hpp"

namespace curbline {

template <Limits limits>
class PlaneMixture {
 public:
  static constexpr int capacity = limits.planes;

  void init(const PlaneSettings& settings) {
    settings_ = settings;
    planes_.fill(Plane{});
    fresh_.clear();
    ground_.clear();
    region_label_.fill(no_label);
    relabelled_.clear();
  }

  /// Births, deaths and matching, by the regions; parameters too, unless they come from responsibilities.
  /// label_of(slot) is the cell's label so far, or no_label; `crossed` are the cells that steps cross.
  template <typename LabelOf>
  void update(const Dem<limits>& dem, const typename Segmentation<limits>::Work& work, const Viewpoint& view,
              const CellSet<limits>& crossed, LabelOf&& label_of, Counters& counters);

  /// M-step of the paper's EM (PlaneUpdate::responsibilities): for_each_belief(i, j, visit) calls visit(label,
  /// responsibility) for each candidate of a cell.
  template <typename ForEachBelief>
  void maximise(const Dem<limits>& dem, ForEachBelief&& for_each_belief);

  /// Call when the labels have followed: fresh() and relabelled() count from here.
  void forget_changes();

  /// Forgets a cell that leaves the window.
  void forget(int slot) { region_label_[slot] = no_label; }

  /// The window's lowest corner moved by (dx, dy): planes are kept in its frame.
  void shift(float dx_m, float dy_m) {
    for (Plane& plane : planes_) {
      plane.x_m -= dx_m;
      plane.y_m -= dy_m;
    }
  }

  const Plane& plane(int label) const { return planes_[static_cast<std::size_t>(label)]; }
  /// Was the plane born, did it die, or become ground or cease to be, since forget_changes()?
  bool fresh(int label) const { return fresh_.contains(label); }
  /// The plane of a cell's region; no_label if the region is too small for one.
  Label region_label(int slot) const { return region_label_[slot]; }
  /// Has that changed since forget_changes()?
  bool relabelled(int slot) const { return relabelled_.contains(slot); }
  /// Is the plane ground, so that cells may have its label? See ground.hpp.
  bool ground(int label) const { return ground_.is(label); }
  /// May a plane of ground be a veil? Then it is no side of a curb.
  bool may_be_veil(int label) const { return ground_.may_be_veil(label); }
  /// The largest plane of ground, a level one if there is none.
  Plane largest_ground() const {
    const Plane* largest = nullptr;
    for (std::size_t l = 0; l < planes_.size(); ++l) {
      if (!ground_.is(static_cast<int>(l)) || !planes_[l].alive()) continue;
      if (largest == nullptr || planes_[l].cells > largest->cells) largest = &planes_[l];
    }
    return largest == nullptr ? Plane{} : *largest;
  }
  /// False if the cell's region is the face of a curb, an obstacle, a veil or a fringe.
  bool on_ground(int slot) const { return region_label(slot) == no_label || ground_.is(region_label(slot)); }
  /// Is the ground below the cell covered, by an obstacle or a fringe, so that its height says nothing about it?
  bool covered(int slot) const { return region_label(slot) != no_label && ground_.covers(region_label(slot)); }
  /// Is there an obstacle in the cell: do its heights spread as on 45 degrees, or is its ground covered?
  bool obstructed(const Dem<limits>& dem, int slot) const { return dem.steep(dem.cell(slot)) || covered(slot); }
  bool any_fresh() const { return !fresh_.empty(); }
  bool any_relabelled() const { return !relabelled_.empty(); }
  PlaneUpdate mode() const { return settings_.update; }

 private:
  using Fitted = std::array<bool, limits.planes>;  ///< by label
  void take_labels(const RegionRanking<limits>& ranking);
  Fitted fit(const Dem<limits>& dem, const RegionRanking<limits>& ranking);
  template <typename LabelOf>
  void refine(const Dem<limits>& dem, const Viewpoint& view, const Fitted& fitted, const CellSet<limits>& crossed,
              LabelOf&& label_of);
  static bool lies_nearer(const Dem<limits>& dem, int i, int j, const Cell& cell, const Plane& one, const Plane& other);
  float step_beside_m(const Dem<limits>& dem, const Viewpoint& view, int i, int j, int s, bool crossed) const;

  PlaneSettings settings_{};
  std::array<Plane, limits.planes> planes_{};
  IndexSet<limits.planes> fresh_{};  ///< labels
  Ground<limits> ground_{};
  CellLabels<limits> region_label_{};
  CellSet<limits> relabelled_{};
};

template <Limits limits>
template <typename LabelOf>
void PlaneMixture<limits>::update(const Dem<limits>& dem, const typename Segmentation<limits>::Work& work,
                                  const Viewpoint& view, const CellSet<limits>& crossed, LabelOf&& label_of,
                                  Counters& counters) {
  if (!dem.any_touched()) return;
  RegionRanking<limits> ranking(work, settings_.min_cells, counters);
  dem.for_each_valid([&](int, int, int s) {
    const Label rank = ranking.rank_of_cell(s);
    if (rank == no_label) return;
    // The region's plane counts before the cells' own labels: it stays even if these prefer another.
    const Label before = region_label_[s];
    const Label old = before != no_label ? before : label_of(s);
    if (old != no_label) ranking.count(rank, old);
  });
  ranking.match();
  take_labels(ranking);
  dem.for_each_valid([&](int, int, int s) {
    const Label label = ranking.label_of_cell(s);
    if (region_label_[s] == label) return;
    region_label_[s] = label;
    relabelled_.insert(s);
  });
  const Fitted fitted = fit(dem, ranking);
  ground_.update(dem, planes_, view, region_label_, [this](Label label) { fresh_.insert(label); });
  refine(dem, view, fitted, crossed, label_of);
}

/// Planes whose label no region has taken die.
template <Limits limits>
void PlaneMixture<limits>::take_labels(const RegionRanking<limits>& ranking) {
  for (std::size_t l = 0; l < planes_.size(); ++l) {
    const bool dies = planes_[l].alive() && !ranking.taken(l);
    if (dies) planes_[l] = Plane{};
    if (dies || ranking.born(l)) fresh_.insert(static_cast<int>(l));
  }
}

/// Fits planes to whole regions, except those whose parameters come from responsibilities.
template <Limits limits>
auto PlaneMixture<limits>::fit(const Dem<limits>& dem, const RegionRanking<limits>& ranking) -> Fitted {
  Fitted fitted{};
  for (std::size_t r = 0; r < ranking.size(); ++r) {
    const Label label = ranking.label(r);
    Plane& plane = planes_[label];
    if (settings_.update == PlaneUpdate::responsibilities && plane.alive() && !fresh(label)) continue;
    plane = fit_plane(ranking.moments(r), dem.prior());
    fitted[label] = true;
  }
  return fitted;
}

/// Fits planes of ground to the mean heights of the clean cells of their regions: those that hold nothing else, and
/// have no other label on whose plane they lie better. Cells that mix both sides of a step would tilt the plane of a
/// small region toward the other; if the step is low, the heights within a cell do not show it. A wide plane does
/// without the cells that a step crosses; a small one needs them. Those hold something of the other side, and a cell
/// behind a step down lies too high, all along the step alike: together they are one observation, off by anything up to
/// half of the step.
template <Limits limits>
template <typename LabelOf>
void PlaneMixture<limits>::refine(const Dem<limits>& dem, const Viewpoint& view, const Fitted& fitted,
                                  const CellSet<limits>& crossed, LabelOf&& label_of) {
  std::array<CleanFit, limits.planes> fits{};
  dem.for_each_valid([&](int, int, int s) {
    if (region_label(s) != no_label) fits[region_label(s)].look_at(dem.cell(s));
  });
  for (std::size_t l = 0; l < fits.size(); ++l) {
    fits[l].wanted = fitted[l] && ground_.is(static_cast<int>(l));
    fits[l].wide = planes_[l].cells >= CleanFit::wide_cells;
    fits[l].steep = planes_[l].steeper_than_ramp();
    fits[l].slope_m2 = dem.slope_m2(planes_[l]);
    const bool all_rim = planes_[l].narrower_than(CleanFit::rim_cells * std::max(dem.cell_x_m(), dem.cell_y_m()));
    planes_[l].rough_m2 = all_rim ? 0.0f : fits[l].rough_m2(dem.prior().noise_m2);
  }
  dem.for_each_valid([&](int i, int j, int s) {
    const Label label = region_label(s);
    if (label == no_label || !fits[label].wanted) return;
    CleanFit& fit = fits[label];
    const Cell& cell = dem.cell(s);
    if (dem.mixed(cell, fit.slope_m2, planes_[label].rough_m2)) return;
    const bool is_crossed = crossed.contains(s);
    if (fit.wide && is_crossed) return;
    const Label borne = label_of(s);
    if (borne != label && borne != no_label && lies_nearer(dem, i, j, cell, planes_[borne], planes_[label])) return;
    fit.add(dem.moments(i, j, cell), cell.points, fit.wide ? 0.0f : step_beside_m(dem, view, i, j, s, is_crossed));
  });
  for (std::size_t l = 0; l < fits.size(); ++l) {
    if (fits[l].wanted) fits[l].fit(planes_[l], dem.prior(), dem.common_m2(), settings_.min_cells);
  }
}

/// Is a cell nearer to one plane than to the other?
template <Limits limits>
bool PlaneMixture<limits>::lies_nearer(const Dem<limits>& dem, int i, int j, const Cell& cell, const Plane& one,
                                       const Plane& other) {
  const float above_one_m = dem.above_m(i, j, cell, one), above_other_m = dem.above_m(i, j, cell, other);
  return one.alive() && above_one_m * above_one_m < above_other_m * above_other_m;
}

/// Height of the step beside a cell: how far it lies below the next ones toward the laser, of other regions, and, if a
/// step crosses it, above or below any next one of other regions of ground; 0 if there are none.
template <Limits limits>
float PlaneMixture<limits>::step_beside_m(const Dem<limits>& dem, const Viewpoint& view, int i, int j, int s,
                                          bool crossed) const {
  const Cell& cell = dem.cell(s);
  const int along_x = dem.centroid_x_m(i, cell) < view.x_m ? 1 : -1;
  const int along_y = dem.centroid_y_m(j, cell) < view.y_m ? 1 : -1;
  const std::array<int, 4> beside{direction(0, along_x), direction(1, along_y),  // toward the laser
                                  direction(0, -along_x), direction(1, -along_y)};
  float most_m = 0.0f;
  for (std::size_t k = 0; k < (crossed ? 4u : 2u); ++k) {
    if (dem.next_valid(s, beside[k], 1) == 0) continue;
    const auto d = static_cast<std::size_t>(beside[k]);
    const int next = dem.slot(i + step_i[d], j + step_j[d]);
    const Label other = region_label(next);
    if (other == region_label(s)) continue;
    const float step_m = dem.cell(next).height_m - cell.height_m;
    if (k < 2) most_m = std::max(most_m, step_m);
    if (crossed && other != no_label && ground_.is(other)) most_m = std::max(most_m, magnitude(step_m));
  }
  return most_m;
}

template <Limits limits>
void PlaneMixture<limits>::forget_changes() {
  relabelled_.clear();
  fresh_.clear();
}

template <Limits limits>
template <typename ForEachBelief>
void PlaneMixture<limits>::maximise(const Dem<limits>& dem, ForEachBelief&& for_each_belief) {
  std::array<PlaneMoments, limits.planes> moments{};
  dem.for_each_valid([&](int i, int j, int s) {
    const PlaneMoments cell = dem.moments(i, j, dem.cell(s));
    for_each_belief(i, j, [&](int label, float responsibility) {
      PlaneMoments share = cell;
      share.scale(responsibility);
      moments[static_cast<std::size_t>(label)].add(share);
    });
  });
  for (std::size_t l = 0; l < planes_.size(); ++l) {
    // A plane with hardly any responsibility keeps its parameters; its region decides whether it lives.
    if (!planes_[l].alive() || moments[l].cells < 3.0f) continue;
    Plane anew = fit_plane(moments[l], dem.prior());
    anew.points_a_cell = planes_[l].points_a_cell;
    anew.rough_m2 = planes_[l].rough_m2;
    planes_[l] = anew;
  }
}

}  // namespace curbline
