// The mixture of planes. Each label is a slot that holds one plane. After every scan line the largest regions become
// planes again and take the label with which their cells overlap most, so that a plane keeps its label while it grows,
// is cut and merged; a label that no region took dies. Cost: three passes over the window, K^3 for the matching.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "curbline/counters.hpp"
#include "curbline/dem.hpp"
#include "curbline/ground.hpp"
#include "curbline/index_set.hpp"
#include "curbline/plane.hpp"
#include "curbline/segmentation.hpp"
#include "curbline/settings.hpp"

namespace curbline {

/// Number of a plane. `no_label<limits>` says none.
template <Limits limits>
using Label = std::conditional_t<(limits.planes < 255), std::uint8_t, std::uint16_t>;
template <Limits limits>
inline constexpr Label<limits> no_label = static_cast<Label<limits>>(-1);

template <Limits limits>
class PlaneMixture {
 public:
  using LabelType = Label<limits>;
  static constexpr LabelType none = no_label<limits>;
  static constexpr int capacity = limits.planes;

  void init(const PlaneSettings& settings) {
    settings_ = settings;
    planes_.fill(Plane{});
    fresh_.fill(false);
    any_fresh_ = any_relabelled_ = false;
    ground_.clear();
    region_label_.fill(none);
    relabelled_.clear();
  }

  /// Births, deaths and matching from the regions; parameters too, unless they come from responsibilities.
  /// label_of(slot) is the cell's label up to now, none if it has none yet.
  template <typename LabelOf>
  void update(const Dem<limits>& dem, const typename Segmentation<limits>::Work& work, const Viewpoint& view,
              LabelOf&& label_of, Counters& counters);

  /// M-step of the paper's EM (PlaneUpdate::responsibilities): for_each_belief(i, j, visit) calls visit(label,
  /// responsibility) for each label that a cell may bear.
  template <typename ForEachBelief>
  void maximise(const Dem<limits>& dem, ForEachBelief&& for_each_belief);

  /// Labels have followed: what is fresh or relabelled counts from here.
  void forget_changes();

  /// Forgets a cell that leaves the window.
  void forget(int slot) { region_label_[static_cast<std::size_t>(slot)] = none; }

  /// The window's lowest corner moved by (dx, dy): planes are kept in its frame.
  void shift(float dx_m, float dy_m) {
    for (Plane& plane : planes_) {
      plane.x_m -= dx_m;
      plane.y_m -= dy_m;
    }
  }

  const Plane& plane(int label) const { return planes_[static_cast<std::size_t>(label)]; }
  /// True if the label was born, died, or became ground or none since forget_changes().
  bool fresh(int label) const { return fresh_[static_cast<std::size_t>(label)]; }
  /// The plane of a cell's region; none if the region is too small for one.
  LabelType region_label(int slot) const { return region_label_[static_cast<std::size_t>(slot)]; }
  /// True if that changed since forget_changes().
  bool relabelled(int slot) const { return relabelled_.contains(slot); }
  /// Is the plane ground, which cells may bear? ground.hpp
  bool ground(int label) const { return ground_.is(label); }
  /// Does it, being ground, fall away from the laser as a veil before an edge does?
  bool falls_as_rays(int label) const { return ground_.falls_as_rays(label); }
  /// False if the cell's region is the face of a curb, an obstacle, a veil or a fringe.
  bool on_ground(int slot) const { return region_label(slot) == none || ground_.is(region_label(slot)); }
  /// Is the ground below it covered, so that its height tells nothing of it? True of an obstacle and a fringe.
  bool covered(int slot) const { return region_label(slot) != none && ground_.covers(region_label(slot)); }
  bool any_fresh() const { return any_fresh_; }
  bool any_relabelled() const { return any_relabelled_; }
  PlaneUpdate mode() const { return settings_.update; }

 private:
  using Node = typename RegionGraph<limits>::Index;
  struct Candidate {
    Node node;
    const PlaneMoments* moments;
  };
  /// Regions by size, and the labels that they take. Of one update().
  struct Ranking {
    std::size_t regions = 0;                        ///< how many are planes
    std::array<LabelType, limits.regions> of_node;  ///< rank of a region's node, `none` if it is too small
    std::array<Candidate, limits.planes> region;    ///< by rank
    std::array<std::array<Slot<limits>, limits.planes>, limits.planes> overlap{};  ///< [rank][label], cells
    std::array<LabelType, limits.planes> label;                                    ///< by rank
  };
  /// Below as many nothing is known of a plane beside its three parameters.
  static constexpr float least_clean_cells = 4.0f;

  void rank_regions(const typename Segmentation<limits>::Work& work, Ranking& ranking, Counters& counters) const;
  void match(Ranking& ranking);
  template <typename RankOf>
  void fit(const Dem<limits>& dem, const Ranking& ranking, RankOf&& rank_of);

  PlaneSettings settings_{};
  std::array<Plane, limits.planes> planes_{};
  std::array<bool, limits.planes> fresh_{};
  bool any_fresh_ = false, any_relabelled_ = false;
  Ground<limits> ground_{};
  std::array<LabelType, Dem<limits>::capacity> region_label_{};
  IndexSet<Dem<limits>::capacity> relabelled_{};
};

template <Limits limits>
template <typename LabelOf>
void PlaneMixture<limits>::update(const Dem<limits>& dem, const typename Segmentation<limits>::Work& work,
                                  const Viewpoint& view, LabelOf&& label_of, Counters& counters) {
  if (!dem.any_touched()) return;
  Ranking ranking;
  rank_regions(work, ranking, counters);
  const auto rank_of = [&](int slot) {
    return ranking.of_node[work.graph.root(work.node_of_cell[static_cast<std::size_t>(slot)])];
  };
  dem.for_each_valid([&](int, int, int s) {
    const LabelType rank = rank_of(s);
    if (rank == none) return;
    // A region may bear a plane that its own cells, asked one by one, leave to another: it keeps it all the same.
    const LabelType before = region_label_[static_cast<std::size_t>(s)];
    const LabelType old = before != none ? before : label_of(s);
    if (old != none) ++ranking.overlap[rank][old];
  });

  match(ranking);
  fit(dem, ranking, rank_of);

  dem.for_each_valid([&](int, int, int s) {
    const LabelType rank = rank_of(s);
    const LabelType label = rank == none ? none : ranking.label[rank];
    LabelType& now = region_label_[static_cast<std::size_t>(s)];
    if (now == label) return;
    now = label;
    relabelled_.insert(s);
    any_relabelled_ = true;
  });
  ground_.update(
      dem, planes_, view, none, [this](int s) { return region_label(s); },
      [this](LabelType label) { fresh_[label] = any_fresh_ = true; });
}

/// Fits planes to their regions, then to those of their cells that hold nothing else: what mixes both sides of a step
/// would tilt the plane of a small region toward the other.
template <Limits limits>
template <typename RankOf>
void PlaneMixture<limits>::fit(const Dem<limits>& dem, const Ranking& ranking, RankOf&& rank_of) {
  std::array<bool, limits.planes> fitted{};
  for (std::size_t r = 0; r < ranking.regions; ++r) {
    Plane& plane = planes_[ranking.label[r]];
    if (settings_.update == PlaneUpdate::responsibilities && plane.alive() && !fresh_[ranking.label[r]]) continue;
    plane = fit_plane(*ranking.region[r].moments, ranking.region[r].moments->cells, dem.prior());
    fitted[r] = true;
  }
  std::array<PlaneMoments, limits.planes> clean{};
  dem.for_each_valid([&](int i, int j, int s) {
    const LabelType rank = rank_of(s);
    if (rank == none || !fitted[rank]) return;
    const Cell& cell = dem.cell(s);
    if (!dem.mixed(cell, planes_[ranking.label[rank]])) clean[rank].add_cell(dem.moments(i, j, cell));
  });
  for (std::size_t r = 0; r < ranking.regions; ++r) {
    if (clean[r].cells < least_clean_cells) continue;
    Plane& plane = planes_[ranking.label[r]];
    const float of_region_m2 = plane.variance_m2;
    plane = fit_plane(clean[r], clean[r].cells, dem.prior());
    plane.variance_m2 = of_region_m2;
  }
}

template <Limits limits>
void PlaneMixture<limits>::forget_changes() {
  if (any_relabelled_) relabelled_.clear();
  any_relabelled_ = false;
  fresh_.fill(false);
  any_fresh_ = false;
}

/// Ranks the largest regions.
template <Limits limits>
void PlaneMixture<limits>::rank_regions(const typename Segmentation<limits>::Work& work, Ranking& ranking,
                                        Counters& counters) const {
  ranking.of_node.fill(none);
  auto& region = ranking.region;
  std::size_t& kept = ranking.regions;
  Segmentation<limits>::for_each_region(work, [&](Node node, const PlaneMoments& moments) {
    if (moments.cells < settings_.min_cells) return;
    if (kept == region.size()) {
      ++counters.planes_full;
      if (region[kept - 1].moments->cells >= moments.cells) return;
    } else {
      ++kept;
    }
    std::size_t place = kept - 1;
    for (; place > 0 && region[place - 1].moments->cells < moments.cells; --place) region[place] = region[place - 1];
    region[place] = {node, &moments};
  });
  for (std::size_t r = 0; r < kept; ++r) ranking.of_node[region[r].node] = static_cast<LabelType>(r);
}

/// Greatest overlap first; regions without one take free labels; labels without one die.
template <Limits limits>
void PlaneMixture<limits>::match(Ranking& ranking) {
  std::array<bool, limits.planes> taken{};
  ranking.label.fill(none);
  for (std::size_t round = 0; round < ranking.regions; ++round) {
    std::size_t best_rank = 0, best_label = 0;
    std::uint32_t best = 0;
    for (std::size_t r = 0; r < ranking.regions; ++r) {
      if (ranking.label[r] != none) continue;
      for (std::size_t l = 0; l < static_cast<std::size_t>(limits.planes); ++l) {
        if (!taken[l] && ranking.overlap[r][l] > best) {
          best = ranking.overlap[r][l];
          best_rank = r;
          best_label = l;
        }
      }
    }
    if (best == 0) break;
    ranking.label[best_rank] = static_cast<LabelType>(best_label);
    taken[best_label] = true;
  }
  std::size_t free = 0;
  for (std::size_t r = 0; r < ranking.regions; ++r) {
    if (ranking.label[r] != none) continue;
    while (taken[free]) ++free;
    taken[free] = true;
    fresh_[free] = any_fresh_ = true;
    ranking.label[r] = static_cast<LabelType>(free);
  }
  for (std::size_t l = 0; l < static_cast<std::size_t>(limits.planes); ++l) {
    if (taken[l] || !planes_[l].alive()) continue;
    planes_[l] = Plane{};
    fresh_[l] = any_fresh_ = true;
  }
}

template <Limits limits>
template <typename ForEachBelief>
void PlaneMixture<limits>::maximise(const Dem<limits>& dem, ForEachBelief&& for_each_belief) {
  std::array<PlaneMoments, limits.planes> moments{};
  std::array<float, limits.planes> cells{};
  dem.for_each_valid([&](int i, int j, int s) {
    const PlaneMoments cell = dem.moments(i, j, dem.cell(s));
    for_each_belief(i, j, [&](int label, float responsibility) {
      PlaneMoments share = cell;
      share.points *= responsibility;
      share.weight *= responsibility;
      share.zz *= responsibility;
      moments[static_cast<std::size_t>(label)].add_cell(share);
      cells[static_cast<std::size_t>(label)] += responsibility;
    });
  });
  for (std::size_t l = 0; l < planes_.size(); ++l) {
    // A plane that nearly no cell answers for keeps its parameters; whether it lives is decided by its region.
    if (!planes_[l].alive() || cells[l] < 3.0f) continue;
    planes_[l] = fit_plane(moments[l], cells[l], dem.prior());
  }
}

}  // namespace curbline
