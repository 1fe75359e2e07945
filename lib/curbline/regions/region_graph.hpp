// Merging by evidence: a graph whose nodes are leaves or standing regions and whose links join neighbours. Greedy, best
// gain first, until no merge raises the posterior of the partition under a Dirichlet process (alpha = 1) of planes.
// Lazy: a merge leaves the gains of its neighbours stale, to be computed again when they come up or when nothing else
// gains, which takes a quarter of the evidences. Working memory of one call.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>

#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"
#include "curbline/regions/gain_heap.hpp"
#include "curbline/regions/plane_evidence.hpp"

namespace curbline {

template <Limits limits>
class RegionGraph {
 public:
  /// Node and link numbers, 16 bits where they suffice.
  using Index = std::conditional_t<(limits.regions < 65535 && limits.links < 32767), std::uint16_t, std::uint32_t>;
  static constexpr Index none = static_cast<Index>(-1);

  RegionGraph() {}

  /// Empties it. The arguments are a cell's sides.
  void clear(float cell_x_m, float cell_y_m) {
    nodes_ = links_ = 0;
    cell_x_m_ = cell_x_m;
    cell_y_m_ = cell_y_m;
  }
  int nodes() const { return nodes_; }

  /// Adds a node without points; `none` if the store is full.
  Index add_node();
  PlaneMoments& moments(Index node) { return node_[node].moments; }
  const PlaneMoments& moments(Index node) const { return node_[node].moments; }

  /// Links two nodes, unless they are linked. Returns the end of their link at `a`; `none` if the store is full. Cost:
  /// the number of `b`'s links.
  Index link(Index a, Index b);

  /// Adds a pair of adjacent cells: one of the node at this end, the other next to it along +x (axis 0) or +y (1),
  /// higher by rise_m, which is limited to 6 cm; after 127 pairs more are ignored.
  void add_pair(Index end, int axis, float rise_m);

  /// Merges until no gain is >= 0. Returns the number of evidences computed: nodes + links, plus at most the degrees of
  /// merged nodes, as a rule a few each. Each costs a PlaneEvidence and a heap move.
  int merge(const PlaneEvidence& evidence);

  /// The node that a node has become part of in merge().
  Index root(Index node) const { return node_[node].parent; }

 private:
  struct Node {
    PlaneMoments moments;
    float score;  ///< PlaneEvidence::score
    Index parent;
    Index first;  ///< an end of a link, `none` if there is none
  };
  /// Ends 2 l and 2 l + 1 belong to link l; an end is in the ring of the node that it leaves from.
  struct End {
    Index target;  ///< node the other end leaves from
    Index next, previous;
  };
  struct Link {
    // Sums over its pairs of cells, from the node of its odd end to that of its even one.
    std::int16_t rise;             ///< in 1 / rise_scale m
    std::int8_t along_x, along_y;  ///< cells
    std::uint8_t pairs;
    bool stale;  ///< the gain is: a node has grown since

    /// Adds pairs, as long as they fit: sign 1, or -1 if they lead the other way.
    void add_pairs(int sign, int more, int more_rise, int more_x, int more_y) {
      if (pairs + more > most_pairs) return;
      pairs = static_cast<std::uint8_t>(pairs + more);
      rise = static_cast<std::int16_t>(rise + sign * more_rise);
      along_x = static_cast<std::int8_t>(along_x + sign * more_x);
      along_y = static_cast<std::int8_t>(along_y + sign * more_y);
    }
  };
  static constexpr int most_pairs = 127;
  static constexpr float rise_scale = 2000.0f;

  // Not inlined, as GainHeap::sift_down().
  [[gnu::noinline]] float gain(Index link, const PlaneEvidence& evidence) const {
    const Node& a = node_[end_[2 * link].target];
    const Node& b = node_[end_[2 * link + 1].target];
    PlaneMoments both = a.moments;
    both.add(b.moments);
    return evidence.gain(a.moments, a.score, b.moments, b.score, both, [&] { return border(link_[link]); });
  }
  BorderRise border(const Link& link) const {
    if (link.pairs == 0) return {};
    const auto pairs = static_cast<float>(link.pairs);
    const float share = 1.0f / pairs;
    return {pairs, static_cast<float>(link.along_x) * share * cell_x_m_,
            static_cast<float>(link.along_y) * share * cell_y_m_,
            static_cast<float>(link.rise) * share * (1.0f / rise_scale)};
  }
  /// Calls visit(end) for each end that leaves from a node; it may move the end to another.
  template <typename Visit>
  void for_each_end(Index node, Visit&& visit) {
    const Index first = node_[node].first;
    if (first == none) return;
    Index next = first;
    do {
      const Index end = next;
      next = end_[end].next;
      visit(end);
    } while (next != first);
  }
  int refresh_all(const PlaneEvidence& evidence);
  void merge_ends(Index link);
  void insert(Index node, Index end);
  void remove(Index node, Index end);
  void absorb(Index a, Index b);
  void move_end(Index end, Index a);

  union {
    std::array<Node, limits.regions> node_;  ///< constructed as they are added
  };
  std::array<End, 2 * limits.links> end_;
  std::array<Link, limits.links> link_;
  GainHeap<Index, limits.links> heap_;      ///< links by the gain of merging their nodes
  std::array<Index, limits.regions> seen_;  ///< for a neighbour of the last absorbing node, the end that leads there
  int nodes_ = 0;
  int links_ = 0;
  float cell_x_m_ = 0.0f, cell_y_m_ = 0.0f;
};

template <Limits limits>
auto RegionGraph<limits>::add_node() -> Index {
  if (nodes_ == limits.regions) return none;
  const auto node = static_cast<Index>(nodes_++);
  ::new (static_cast<void*>(node_.data() + node)) Node{{}, 0.0f, node, none};
  return node;
}

template <Limits limits>
void RegionGraph<limits>::insert(Index node, Index end) {
  Index& first = node_[node].first;
  if (first == none) {
    end_[end].next = end_[end].previous = end;
  } else {
    const Index last = end_[first].previous;
    end_[end].next = first;
    end_[end].previous = last;
    end_[last].next = end;
    end_[first].previous = end;
  }
  first = end;
}

template <Limits limits>
void RegionGraph<limits>::remove(Index node, Index end) {
  const Index next = end_[end].next, previous = end_[end].previous;
  Index& first = node_[node].first;
  if (next == end) {
    first = none;
    return;
  }
  end_[previous].next = next;
  end_[next].previous = previous;
  if (first == end) first = next;
}

template <Limits limits>
auto RegionGraph<limits>::link(Index a, Index b) -> Index {
  if (const Index first = node_[b].first; first != none) {
    Index end = first;
    do {
      if (end_[end].target == a) return static_cast<Index>(end ^ 1u);
      end = end_[end].next;
    } while (end != first);
  }
  if (links_ == limits.links) return none;
  const auto l = static_cast<Index>(links_++);
  const auto from_a = static_cast<Index>(2 * l), from_b = static_cast<Index>(2 * l + 1);
  link_[l] = Link{};
  end_[from_a].target = b;
  end_[from_b].target = a;
  insert(a, from_a);
  insert(b, from_b);
  return from_a;
}

template <Limits limits>
void RegionGraph<limits>::add_pair(Index end, int axis, float rise_m) {
  constexpr float most = 127.0f;  // of one pair: 127 of them fit 16 bits
  const float scaled = rise_m * rise_scale;
  const std::int32_t rise = round_to_int(std::clamp(scaled, -most, most));
  link_[end / 2].add_pairs(end % 2 == 0 ? -1 : 1, 1, rise, axis == 0, axis != 0);
}

template <Limits limits>
int RegionGraph<limits>::merge(const PlaneEvidence& evidence) {
  for (Index n = 0; n < static_cast<Index>(nodes_); ++n) {
    node_[n].score = evidence.score(node_[n].moments);
    seen_[n] = none;
  }
  for (Index l = 0; l < static_cast<Index>(links_); ++l) link_[l].stale = true;
  heap_.fill(static_cast<std::size_t>(links_));
  int evidences = nodes_ + refresh_all(evidence);
  while (heap_.size() > 0) {
    const Index best = heap_.at(0);
    Link& link = link_[best];
    if (link.stale) {
      heap_.set_first(gain(best, evidence));
      link.stale = false;
      ++evidences;
    } else if (heap_.gain(best) >= 0.0f) {
      merge_ends(best);
    } else {
      // No known gain is left; stale ones may be gains.
      const int refreshed = refresh_all(evidence);
      if (refreshed == 0) break;
      evidences += refreshed;
    }
  }
  for (Index n = 0; n < static_cast<Index>(nodes_); ++n) {
    while (node_[node_[n].parent].parent != node_[n].parent) node_[n].parent = node_[node_[n].parent].parent;
  }
  return evidences;
}

/// Computes all stale gains. Returns how many.
template <Limits limits>
int RegionGraph<limits>::refresh_all(const PlaneEvidence& evidence) {
  int refreshed = 0;
  for (std::size_t p = 0; p < heap_.size(); ++p) {
    const Index l = heap_.at(p);
    if (!link_[l].stale) continue;
    heap_.set(l, gain(l, evidence));
    link_[l].stale = false;
    ++refreshed;
  }
  if (refreshed > 0) heap_.order();
  return refreshed;
}

template <Limits limits>
void RegionGraph<limits>::merge_ends(Index link) {
  const Index a = end_[2 * link + 1].target, b = end_[2 * link].target;
  const float score = heap_.gain(link) + node_[a].score + node_[b].score;
  absorb(a, b);
  node_[a].score = score;
}

/// Makes b part of a. Its links move to a; the link between the two goes, and so does a second link to the same
/// neighbour, except for its pairs. All gains of a become stale.
template <Limits limits>
void RegionGraph<limits>::absorb(Index a, Index b) {
  node_[a].moments.add(node_[b].moments);
  node_[b].parent = a;
  for_each_end(a, [&](Index end) {
    link_[end / 2].stale = true;
    seen_[end_[end].target] = end;
  });
  for_each_end(b, [&](Index end) { move_end(end, a); });
}

/// Moves a link's end to `a`, from the node that has become part of it.
template <Limits limits>
void RegionGraph<limits>::move_end(Index end, Index a) {
  const auto other = static_cast<Index>(end ^ 1u);
  const Index target = end_[end].target, twin = seen_[target];
  const bool has_twin = twin != none && end_[twin].target == target && end_[twin ^ 1u].target == a;
  Link& link = link_[end / 2];
  if (target != a && !has_twin) {
    end_[other].target = a;
    insert(a, end);
    link.stale = true;
    return;
  }
  if (has_twin)
    link_[twin / 2].add_pairs((end ^ twin) % 2 == 0 ? 1 : -1, link.pairs, link.rise, link.along_x, link.along_y);
  remove(target, other);
  heap_.remove(static_cast<Index>(end / 2));
}

}  // namespace curbline
