// The mixture of planes. Each label is a slot that holds one plane. After every scan line the largest regions become planes
// again and take the label with which their cells overlap most, so that a plane keeps its label while it grows, is
// cut and merged; a label that no region took dies. Cost: three passes over the window, K^2 for the matching.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "curbline/counters.hpp"
#include "curbline/dem.hpp"
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
    region_label_.fill(none);
    relabelled_.fill(0);
  }

  /// Births, deaths and matching from the regions; parameters too, unless they come from responsibilities.
  /// label_of(slot) is the cell's label up to now, none if it has none yet.
  template <typename LabelOf>
  void update(const Dem<limits>& dem, const Segmentation<limits>& segmentation, LabelOf&& label_of, Counters& counters);

  /// M-step of the paper's EM (PlaneUpdate::responsibilities): for_each_belief(i, j, visit) calls visit(label, responsibility)
  /// for each label that a cell may bear.
  template <typename ForEachBelief>
  void maximise(const Dem<limits>& dem, ForEachBelief&& for_each_belief);

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
  /// True if the label was born or died in the last update().
  bool fresh(int label) const { return fresh_[static_cast<std::size_t>(label)]; }
  /// The plane of a cell's region; none if the region is too small for one.
  LabelType region_label(int slot) const { return region_label_[static_cast<std::size_t>(slot)]; }
  /// True if that changed in the last update().
  bool relabelled(int slot) const { return relabelled_[static_cast<std::size_t>(slot)] != 0; }
  /// Cells that planes claim, together.
  float cells() const { return cells_; }
  PlaneUpdate mode() const { return settings_.update; }

 private:
  struct Candidate {
    Slot<limits> region;
    std::uint32_t cells;
  };
  int largest_regions(const Dem<limits>& dem, const Segmentation<limits>& segmentation, Counters& counters);
  void match(int regions);

  PlaneSettings settings_{};
  std::array<Plane, limits.planes> planes_{};
  std::array<bool, limits.planes> fresh_{};
  float cells_ = 0.0f;
  std::array<LabelType, Dem<limits>::capacity> region_label_{};
  std::array<std::uint8_t, Dem<limits>::capacity> relabelled_{};

  // Working memory of one update().
  std::array<Slot<limits>, Dem<limits>::capacity> count_{};  ///< cells of a region, then its rank + 1
  std::array<Candidate, limits.planes> largest_{};
  std::array<PlaneMoments, limits.planes> moments_{};
  std::array<std::array<Slot<limits>, limits.planes>, limits.planes> overlap_{};  ///< [rank][label], cells
  std::array<LabelType, limits.planes> label_of_rank_{};
};

template <Limits limits>
template <typename LabelOf>
void PlaneMixture<limits>::update(const Dem<limits>& dem, const Segmentation<limits>& segmentation, LabelOf&& label_of,
                                  Counters& counters) {
  const int regions = largest_regions(dem, segmentation, counters);
  const auto rank_of = [&](int slot) { return static_cast<int>(count_[segmentation.region(slot)]) - 1; };
  const auto for_each_cell = [&](auto&& visit) {
    for (int i = 0; i < dem.rows(); ++i) {
      for (int j = 0; j < dem.cols(); ++j) {
        const int s = dem.slot(i, j);
        if (dem.cell(s).valid()) visit(i, j, s);
      }
    }
  };

  moments_.fill(PlaneMoments{});
  for (auto& row : overlap_) row.fill(0);
  for_each_cell([&](int i, int j, int s) {
    const int rank = rank_of(s);
    if (rank < 0) return;
    const auto r = static_cast<std::size_t>(rank);
    moments_[r].add(dem.moments(i, j, dem.cell(s)));
    // A cell that still waits for its label counts for the plane that its region had.
    const LabelType old = label_of(s) != none ? label_of(s) : region_label_[static_cast<std::size_t>(s)];
    if (old != none) ++overlap_[r][old];
  });

  match(regions);
  cells_ = 0.0f;
  for (int r = 0; r < regions; ++r) {
    const auto n = static_cast<std::size_t>(r);
    Plane& plane = planes_[label_of_rank_[n]];
    const auto cells = static_cast<float>(largest_[n].cells);
    cells_ += cells;
    if (settings_.update == PlaneUpdate::responsibilities && plane.alive() && !fresh_[label_of_rank_[n]]) continue;
    plane = fit_plane(moments_[n], cells, settings_.prior);
  }

  for_each_cell([&](int, int, int s) {
    const int rank = rank_of(s);
    const LabelType label = rank < 0 ? none : label_of_rank_[static_cast<std::size_t>(rank)];
    relabelled_[static_cast<std::size_t>(s)] = region_label_[static_cast<std::size_t>(s)] != label;
    region_label_[static_cast<std::size_t>(s)] = label;
  });
}

/// Counts the cells of each region, keeps the largest in largest_, and leaves each region's rank + 1 (0: none) in count_.
template <Limits limits>
int PlaneMixture<limits>::largest_regions(const Dem<limits>& dem, const Segmentation<limits>& segmentation, Counters& counters) {
  count_.fill(0);
  for (int i = 0; i < dem.rows(); ++i) {
    for (int j = 0; j < dem.cols(); ++j) {
      const int s = dem.slot(i, j);
      if (dem.cell(s).valid()) ++count_[segmentation.region(s)];
    }
  }
  int kept = 0;
  for (std::size_t region = 0; region < count_.size(); ++region) {
    const std::uint32_t cells = count_[region];
    count_[region] = 0;
    if (static_cast<float>(cells) < settings_.min_cells) continue;
    if (kept == limits.planes) {
      ++counters.planes_full;
      if (largest_[static_cast<std::size_t>(kept - 1)].cells >= cells) continue;
    } else {
      ++kept;
    }
    auto place = static_cast<std::size_t>(kept - 1);
    for (; place > 0 && largest_[place - 1].cells < cells; --place) largest_[place] = largest_[place - 1];
    largest_[place] = {static_cast<Slot<limits>>(region), cells};
  }
  for (int r = 0; r < kept; ++r) count_[largest_[static_cast<std::size_t>(r)].region] = static_cast<Slot<limits>>(r + 1);
  return kept;
}

/// Greatest overlap first; regions without one take free labels; labels without one die.
template <Limits limits>
void PlaneMixture<limits>::match(int regions) {
  std::array<bool, limits.planes> taken{};
  label_of_rank_.fill(none);
  for (int round = 0; round < regions; ++round) {
    std::size_t best_rank = 0, best_label = 0;
    std::uint32_t best = 0;
    for (std::size_t r = 0; r < static_cast<std::size_t>(regions); ++r) {
      if (label_of_rank_[r] != none) continue;
      for (std::size_t l = 0; l < static_cast<std::size_t>(limits.planes); ++l) {
        if (!taken[l] && overlap_[r][l] > best) {
          best = overlap_[r][l];
          best_rank = r;
          best_label = l;
        }
      }
    }
    if (best == 0) break;
    label_of_rank_[best_rank] = static_cast<LabelType>(best_label);
    taken[best_label] = true;
  }
  fresh_.fill(false);
  std::size_t free = 0;
  for (std::size_t r = 0; r < static_cast<std::size_t>(regions); ++r) {
    if (label_of_rank_[r] != none) continue;
    while (taken[free]) ++free;
    taken[free] = true;
    fresh_[free] = true;
    label_of_rank_[r] = static_cast<LabelType>(free);
  }
  for (std::size_t l = 0; l < static_cast<std::size_t>(limits.planes); ++l) {
    if (taken[l] || !planes_[l].alive()) continue;
    planes_[l] = Plane{};
    fresh_[l] = true;
  }
}

template <Limits limits>
template <typename ForEachBelief>
void PlaneMixture<limits>::maximise(const Dem<limits>& dem, ForEachBelief&& for_each_belief) {
  std::array<float, limits.planes> cells{};
  moments_.fill(PlaneMoments{});
  for (int i = 0; i < dem.rows(); ++i) {
    for (int j = 0; j < dem.cols(); ++j) {
      const int s = dem.slot(i, j);
      if (!dem.cell(s).valid()) continue;
      const PlaneMoments cell = dem.moments(i, j, dem.cell(s));
      for_each_belief(i, j, [&](int label, float responsibility) {
        PlaneMoments share = cell;
        share.points *= responsibility;
        share.weight *= responsibility;
        share.zz *= responsibility;
        moments_[static_cast<std::size_t>(label)].add(share);
        cells[static_cast<std::size_t>(label)] += responsibility;
      });
    }
  }
  for (std::size_t l = 0; l < planes_.size(); ++l) {
    // A plane that nearly no cell answers for keeps its parameters; whether it lives is decided by its region.
    if (!planes_[l].alive() || cells[l] < 3.0f) continue;
    planes_[l] = fit_plane(moments_[l], cells[l], settings_.prior);
  }
}

}  // namespace curbline
