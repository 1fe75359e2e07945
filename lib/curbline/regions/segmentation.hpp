// Which cells belong together, in two steps. Leaves: the graph segmentation of the paper (Felzenszwalb and Huttenlocher
// 2004) inside each block of 4 x 4 cells, on heights above the slope of the ground. Regions: leaves merged by evidence
// (region_graph.hpp). A scan line re-cuts the blocks that it touched, dissolves the regions that it touched and their
// neighbours into leaves, and merges again: that is how a region splits. What no line touched stays. Obstacles on the
// ground do not divide regions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/counters.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/per_cell.hpp"
#include "curbline/plane.hpp"
#include "curbline/regions/link.hpp"
#include "curbline/regions/plane_evidence.hpp"
#include "curbline/regions/region_graph.hpp"
#include "curbline/settings.hpp"

namespace curbline {

inline constexpr int block_cells = block_side * block_side;

/// Leaf of each cell of a block, by the number (4 i + j) of the leaf's first cell; 255 for invalid cells.
using BlockLeaves = std::array<std::uint8_t, block_cells>;

/// Felzenszwalb-Huttenlocher on one block: the edge weight is the symmetric Kullback-Leibler divergence of the cells'
/// normal distributions; links reach across invalid cells. About 24 edges.
struct BlockCell {
  float height_m;
  float variance_m2;
  bool valid;
};
BlockLeaves cut_block(const std::array<BlockCell, block_cells>& cells, float scale);

template <Limits limits>
class Segmentation {
 public:
  using Region = Slot<limits>;  ///< a region is named by the slot of one of its cells
  static constexpr Region none = static_cast<Region>(-1);

  void init(const SegmentationSettings& settings, const PlanePrior& prior) {
    settings_ = settings;
    evidence_ = PlaneEvidence(prior);
    region_.fill(none);
    dissolved_.clear();
  }

  /// A cell is about to leave the window: its region will be cut again.
  void forget(int slot) {
    if (region_[slot] != none) dissolved_.insert(region_[slot]);
    region_[slot] = none;
  }

  /// Working memory of one update(), for the mixture to read right after it.
  struct Work {
    RegionGraph<limits> graph;
    PerCell<typename RegionGraph<limits>::Index, limits> node_of_cell;
    std::array<Region, limits.regions> region_of_node;
  };

  /// Follows the touched cells, in working memory of the caller. `ground` is the plane of the ground, a level one if
  /// none is known. Cells that are obstructed(slot) do not divide regions: those on both sides are neighbours too.
  /// Cost: five passes over the window, 16 cells a touched block, and the merging; nothing if no cell was touched.
  template <typename Obstructed>
  void update(const Dem<limits>& dem, Work& work, const Plane& ground, Obstructed&& obstructed, Counters& counters);

  /// Region of a valid cell; `none` if the store of regions had no room for its leaf.
  Region region(int slot) const { return region_[slot]; }

  /// Calls visit(node) for the node of each region; right after an update() that had work.
  template <typename Visit>
  static void for_each_region(const Work& work, Visit&& visit) {
    for (int n = 0; n < work.graph.nodes(); ++n) {
      const auto node = static_cast<Node>(n);
      if (work.graph.root(node) == node) visit(node);
    }
  }

 private:
  using Node = typename RegionGraph<limits>::Index;
  static constexpr Node no_node = RegionGraph<limits>::none;

  void cut_touched_blocks(const Dem<limits>& dem, const Plane& ground);
  void cut(const Dem<limits>& dem, int row, int col, const Plane& lean);
  void dissolve_neighbours(const Dem<limits>& dem);
  template <typename Obstructed>
  void build_graph(const Dem<limits>& dem, Work& work, Obstructed&& obstructed, Counters& counters) const;
  void name_regions(const Dem<limits>& dem, Work& work);
  /// A cell's node in the graph is that of its leaf if its region is dissolved, else of its region.
  Region representative(int slot) const {
    return region_[slot] == none || dissolved_.contains(region_[slot]) ? leaf_[slot] : region_[slot];
  }

  SegmentationSettings settings_{};
  PlaneEvidence evidence_{};
  PerCell<Region, limits> leaf_{};  ///< slot of the first cell of a cell's leaf
  PerCell<Region, limits> region_{};
  CellSet<limits> dissolved_{};  ///< regions to be cut into leaves and merged again, by name
};

template <Limits limits>
template <typename Obstructed>
void Segmentation<limits>::update(const Dem<limits>& dem, Work& work, const Plane& ground, Obstructed&& obstructed,
                                  Counters& counters) {
  if (!dem.any_touched()) return;
  evidence_.set_common_share(dem.prior().common_share);
  cut_touched_blocks(dem, ground);
  dissolve_neighbours(dem);
  build_graph(dem, work, obstructed, counters);
  counters.evidences += static_cast<std::uint32_t>(work.graph.merge(evidence_));
  name_regions(dem, work);
}

template <Limits limits>
void Segmentation<limits>::cut_touched_blocks(const Dem<limits>& dem, const Plane& ground) {
  const Plane lean = ground.lean();
  for (int row = 0; row < dem.rows(); row += block_side) {
    for (int col = 0; col < dem.cols(); col += block_side) {
      if (dem.block_touched(dem.slot(row, col))) cut(dem, row, col, lean);
    }
  }
}

/// Cuts a block, given by its first cell, into leaves. On a slope, cells of about the same height lie along contours:
/// leaves would be rows of cells, which say nothing about the slope across them and join end to end, through low steps.
/// So the ground's slope beyond 1 in 20 is taken off; not all of it, as leaves of whole blocks tear bent ground
/// (lib/formulas.md).
template <Limits limits>
void Segmentation<limits>::cut(const Dem<limits>& dem, int row, int col, const Plane& lean) {
  const int first = dem.slot(row, col);
  std::array<BlockCell, block_cells> cells;
  for (int k = 0; k < block_cells; ++k) {
    const int s = dem.slot_in_block(first, k);
    const Cell& cell = dem.cell(s);
    cells[static_cast<std::size_t>(k)] = {dem.above_m(row + k / block_side, col + k % block_side, cell, lean),
                                          cell.variance_m2(settings_.cell), cell.valid()};
    if (region_[s] != none) dissolved_.insert(region_[s]);
  }
  const BlockLeaves leaves = cut_block(cells, settings_.leaf_scale);
  for (int k = 0; k < block_cells; ++k) {
    const std::uint8_t leaf = leaves[static_cast<std::size_t>(k)];
    leaf_[dem.slot_in_block(first, k)] = leaf == 255 ? none : static_cast<Region>(dem.slot_in_block(first, leaf));
  }
}

template <Limits limits>
void Segmentation<limits>::dissolve_neighbours(const Dem<limits>& dem) {
  CellSet<limits> neighbours;
  for_each_link(dem, settings_.link_reach, [&](const Link& link) {
    const Region a = region_[link.from], b = region_[link.to];
    // Two ifs, since most links end at the first: saves 25,000 instructions in the worst line of a Cortex-R5F
    // (tools/budget).
    if (a == b) return;
    if (a == none || b == none) return;
    if (dissolved_.contains(a)) neighbours.insert(b);
    if (dissolved_.contains(b)) neighbours.insert(a);
  });
  dissolved_.insert(neighbours);
}

template <Limits limits>
template <typename Obstructed>
void Segmentation<limits>::build_graph(const Dem<limits>& dem, Work& work, Obstructed&& obstructed,
                                       Counters& counters) const {
  RegionGraph<limits>& graph = work.graph;
  graph.clear(dem.cell_x_m(), dem.cell_y_m());
  work.node_of_cell.fill(no_node);
  dem.for_each_valid([&](int i, int j, int s) {
    const Region name = representative(s);  // the slot of one of its cells
    Node& node = work.node_of_cell[name];
    if (node == no_node) node = graph.add_node();
    if (node == no_node) {
      counters.regions_full += static_cast<int>(name) == s;
      return;
    }
    graph.moments(node).add_cell(dem.moments(i, j, dem.cell(s)));
    work.node_of_cell[s] = node;
  });
  const auto join = [&](Node a, Node b) {
    const Node end = graph.link(a, b);
    counters.links_full += end == no_node;
    return end;
  };
  for_each_link(dem, settings_.link_reach, [&](const Link& link) {
    const Node a = work.node_of_cell[link.from], b = work.node_of_cell[link.to];
    if (a == b) return;
    if (a == no_node || b == no_node) return;  // two ifs, as in dissolve_neighbours()
    const Cell& from = dem.cell(link.from);
    const Cell& to = dem.cell(link.to);
    const Node end = join(a, b);
    if (end != no_node && link.distance == 1) graph.add_pair(end, link.axis, to.height_m - from.height_m);
    if (!obstructed(link.to) || obstructed(link.from)) return;
    const int beyond = beyond_obstacle(dem, link, settings_.link_reach, obstructed);
    if (beyond < 0) return;
    const Node c = work.node_of_cell[beyond];
    if (c != a && c != no_node) join(a, c);
  });
}

template <Limits limits>
void Segmentation<limits>::name_regions(const Dem<limits>& dem, Work& work) {
  const RegionGraph<limits>& graph = work.graph;
  work.region_of_node.fill(none);
  dem.for_each_valid([&](int, int, int s) {
    region_[s] = none;
    if (work.node_of_cell[s] == no_node) return;
    Region& region = work.region_of_node[graph.root(work.node_of_cell[s])];
    if (region == none) region = static_cast<Region>(s);
    region_[s] = region;
  });
  dissolved_.clear();
}

}  // namespace curbline
