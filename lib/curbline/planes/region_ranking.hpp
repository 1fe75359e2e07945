// Which regions become planes, and with which labels: the largest ones, each with the label that it overlaps most, so
// that a plane keeps its label while its region grows, is cut and merged. Working memory of PlaneMixture::update().
// Cost: K^3 for the matching.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/counters.hpp"
#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/plane.hpp"
#include "curbline/regions/region_graph.hpp"
#include "curbline/regions/segmentation.hpp"

namespace curbline {

template <Limits limits>
class RegionRanking {
 public:
  using Regions = typename Segmentation<limits>::Work;

  /// Ranks the largest regions of at least min_cells. `regions` must outlive it.
  RegionRanking(const Regions& regions, float min_cells, Counters& counters);

  /// Number of regions that become planes.
  std::size_t size() const { return size_; }
  const PlaneMoments& moments(std::size_t rank) const { return regions_.graph.moments(node_[rank]); }
  /// Rank of a cell's region; no_label if that becomes no plane.
  Label rank_of_cell(int slot) const {
    const Node node = regions_.node_of_cell[slot];
    return node == RegionGraph<limits>::none ? no_label : rank_of_node_[regions_.graph.root(node)];
  }

  /// Counts a cell of a region that has had a label.
  void count(Label rank, Label label) { ++overlap_[rank][label]; }
  /// Call when all are counted. Greatest overlap first; regions without any take free labels.
  void match();

  // After match().
  Label label(std::size_t rank) const { return label_[rank]; }
  Label label_of_cell(int slot) const {
    const Label rank = rank_of_cell(slot);
    return rank == no_label ? no_label : label_[rank];
  }
  /// Has a region taken the label?
  bool taken(std::size_t label) const { return taken_[label]; }
  /// Has a region taken the label that none of its cells had?
  bool born(std::size_t label) const { return born_[label]; }

 private:
  using Node = typename RegionGraph<limits>::Index;
  static constexpr std::size_t planes = limits.planes;

  const Regions& regions_;
  std::size_t size_ = 0;
  std::array<Label, limits.regions> rank_of_node_;
  std::array<Node, planes> node_;                                   ///< by rank
  std::array<std::array<Slot<limits>, planes>, planes> overlap_{};  ///< [rank][label], cells
  std::array<Label, planes> label_;                                 ///< by rank
  std::array<bool, planes> taken_{}, born_{};                       ///< by label
};

template <Limits limits>
RegionRanking<limits>::RegionRanking(const Regions& regions, float min_cells, Counters& counters) : regions_(regions) {
  Segmentation<limits>::for_each_region(regions, [&](Node node) {
    const float cells = regions.graph.moments(node).cells;
    if (cells < min_cells) return;
    if (size_ == planes) {
      ++counters.planes_full;
      if (moments(size_ - 1).cells >= cells) return;
    } else {
      ++size_;
    }
    std::size_t place = size_ - 1;
    for (; place > 0 && moments(place - 1).cells < cells; --place) node_[place] = node_[place - 1];
    node_[place] = node;
  });
  rank_of_node_.fill(no_label);
  for (std::size_t r = 0; r < size_; ++r) rank_of_node_[node_[r]] = static_cast<Label>(r);
}

template <Limits limits>
void RegionRanking<limits>::match() {
  label_.fill(no_label);
  for (std::size_t round = 0; round < size_; ++round) {
    std::size_t best_rank = 0, best_label = 0;
    std::uint32_t best = 0;
    for (std::size_t r = 0; r < size_; ++r) {
      if (label_[r] != no_label) continue;
      for (std::size_t l = 0; l < planes; ++l) {
        if (taken_[l] || overlap_[r][l] <= best) continue;
        best = overlap_[r][l];
        best_rank = r;
        best_label = l;
      }
    }
    if (best == 0) break;
    label_[best_rank] = static_cast<Label>(best_label);
    taken_[best_label] = true;
  }
  std::size_t free = 0;
  for (std::size_t r = 0; r < size_; ++r) {
    if (label_[r] != no_label) continue;
    while (taken_[free]) ++free;
    label_[r] = static_cast<Label>(free);
    taken_[free] = born_[free] = true;
  }
}

}  // namespace curbline
