// The mixture of planes. Each label is a slot for one plane. At each update the largest regions become planes, each
// with the label that its cells overlap most, so that a plane keeps its label while it grows, is cut and merged; a
// label that no region takes dies. Planes of ground are then fitted to the cells that hold nothing else. Cost: two
// passes over the window, K^3 for the matching, and ground.hpp and clean_fit.hpp.
#pragma once

#include <array>
#include <cstddef>

#include "curbline/counters.hpp"
#include "curbline/grid.hpp"
#include "curbline/index_set.hpp"
#include "curbline/map/dem.hpp"
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

  /// Judges planes of ground again and fits planes (PlaneUpdate::regions), by what labels and steps have told since
  /// update(): for a finished map.
  template <typename LabelOf>
  void refine(const Dem<limits>& dem, const Viewpoint& view, const CellSet<limits>& crossed, LabelOf&& label_of);

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
  /// Is there such a plane, and is it ground, so that cells may have its label? See ground.hpp.
  bool ground(int label) const { return plane(label).alive() && ground_.is(label); }
  /// May a plane of ground be a veil? Then it is no side of a curb.
  bool may_be_veil(int label) const { return ground_.may_be_veil(label); }
  /// The largest plane of ground, a level one if there is none.
  Plane largest_ground() const {
    const Plane* largest = nullptr;
    for (std::size_t l = 0; l < planes_.size(); ++l) {
      if (!ground(static_cast<int>(l))) continue;
      if (largest == nullptr || planes_[l].cells > largest->cells) largest = &planes_[l];
    }
    return largest == nullptr ? Plane{} : *largest;
  }
  /// False if the cell's region is not ground (ground.hpp).
  bool on_ground(int slot) const { return region_label(slot) == no_label || ground_.is(region_label(slot)); }
  /// Is the ground below the cell covered, by an obstacle or a fringe, so that its height says nothing about it?
  bool covered(int slot) const { return region_label(slot) != no_label && ground_.covers(region_label(slot)); }
  /// Is there an obstacle in the cell: do its heights spread as on 45 degrees, or is its ground covered?
  bool obstructed(const Dem<limits>& dem, int slot) const { return dem.steep(dem.cell(slot)) || covered(slot); }
  bool any_fresh() const { return !fresh_.empty(); }
  bool any_relabelled() const { return !relabelled_.empty(); }
  PlaneUpdate mode() const { return settings_.update; }

 private:
  using Fitted = typename CleanFits<limits>::Wanted;
  // Not inlined: the ranking takes a kilobyte of stack, which is free again for what follows.
  template <typename LabelOf>
  [[gnu::noinline]] Fitted match_regions(const Dem<limits>& dem, const typename Segmentation<limits>::Work& work,
                                         LabelOf&& label_of, Counters& counters);
  template <typename LabelOf>
  void recheck_ground(const Dem<limits>& dem, const Viewpoint& view, LabelOf&& label_of);
  void take_labels(const RegionRanking<limits>& ranking);
  Fitted fit(const Dem<limits>& dem, const RegionRanking<limits>& ranking);

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
  const Fitted fitted = match_regions(dem, work, label_of, counters);
  ground_.update(dem, planes_, view, region_label_, [this](Label label) { fresh_.insert(label); });
  CleanFits<limits>(dem, ground_, region_label_, view, crossed).fit(planes_, fitted, label_of, settings_.min_cells);
}

/// Gives each region its plane, and each cell that of its region. Returns which planes are fitted to their region.
template <Limits limits>
template <typename LabelOf>
auto PlaneMixture<limits>::match_regions(const Dem<limits>& dem, const typename Segmentation<limits>::Work& work,
                                         LabelOf&& label_of, Counters& counters) -> Fitted {
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
  return fit(dem, ranking);
}

template <Limits limits>
template <typename LabelOf>
void PlaneMixture<limits>::refine(const Dem<limits>& dem, const Viewpoint& view, const CellSet<limits>& crossed,
                                  LabelOf&& label_of) {
  recheck_ground(dem, view, label_of);
  std::array<PlaneMoments, limits.planes> regions{};
  dem.for_each_valid([&](int i, int j, int s) {
    if (region_label_[s] != no_label) regions[region_label_[s]].add(dem.moments(i, j, dem.cell(s)));
  });
  Fitted fitted{};
  for (std::size_t l = 0; l < planes_.size(); ++l) {
    if (!(regions[l].cells > 0.0f)) continue;
    planes_[l] = fit_plane(regions[l], dem.prior());
    fitted[l] = true;
  }
  CleanFits<limits>(dem, ground_, region_label_, view, crossed).fit(planes_, fitted, label_of, settings_.min_cells);
}

/// A region may hold, beside a face or a fringe, cells of the plane next to it, and be too wide for one. What is left
/// when labels have given these back is judged anew. If it is no ground they are of that plane's region from now on.
template <Limits limits>
template <typename LabelOf>
void PlaneMixture<limits>::recheck_ground(const Dem<limits>& dem, const Viewpoint& view, LabelOf&& label_of) {
  CellLabels<limits> labels = region_label_;
  dem.for_each_valid([&](int, int, int s) {
    const Label own = label_of(s);
    if (on_ground(s) && own != no_label) labels[s] = own;
  });
  ground_.recheck(dem, planes_, view, labels, [this](Label label) { fresh_.insert(label); });
  dem.for_each_valid([&](int, int, int s) {
    if (on_ground(s) || labels[s] == region_label_[s]) return;
    region_label_[s] = labels[s];
    relabelled_.insert(s);
  });
}

/// Planes whose label no region has taken die.
template <Limits limits>
void PlaneMixture<limits>::take_labels(const RegionRanking<limits>& ranking) {
  for (std::size_t l = 0; l < planes_.size(); ++l) {
    const bool dies = planes_[l].alive() && !ranking.taken(l);
    if (dies) planes_[l] = Plane{};
    if (dies || ranking.born(l)) fresh_.insert(l);
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
