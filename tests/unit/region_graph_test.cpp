// Merging by evidence, on graphs small enough to check by hand or by trying everything.
#include "curbline/regions/region_graph.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <numeric>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "support/moments.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

constexpr Limits limits{.regions = 64, .links = 256};
using Graph = RegionGraph<limits>;

/// A square of ground of 0.4 m with 16 points, like a leaf.
PlaneMoments leaf(double x0, double y0, double height_m, test::Noise& noise, double slope = 0.0) {
  return test::of_points(test::sample({x0, x0 + 0.4, y0, y0 + 0.4}, 0.1, 0.005, noise,
                                      [&](double x, double) { return height_m + slope * x; }));
}

Graph::Index add(Graph& graph, const PlaneMoments& moments) {
  const auto node = graph.add_node();
  REQUIRE(node != Graph::none);
  graph.moments(node) = moments;
  return node;
}

TEST_CASE("region graph: two halves of a plane merge, two sides of a step do not") {
  const auto graph = std::make_unique<Graph>();
  test::Noise noise;
  graph->clear(0.1f, 0.1f);
  const auto a = add(*graph, leaf(0.0, 0.0, 0.0, noise)), b = add(*graph, leaf(0.4, 0.0, 0.0, noise));
  const auto c = add(*graph, leaf(0.8, 0.0, 0.12, noise)), d = add(*graph, leaf(1.2, 0.0, 0.12, noise));
  for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, d}}) REQUIRE(graph->link(from, to) != Graph::none);
  graph->merge(PlaneEvidence{});
  CHECK(graph->root(a) == graph->root(b));
  CHECK(graph->root(c) == graph->root(d));
  CHECK(graph->root(a) != graph->root(c));
}

TEST_CASE("region graph: nodes without a link never merge, alike as they are") {
  const auto graph = std::make_unique<Graph>();
  test::Noise noise;
  const auto a = add(*graph, leaf(0.0, 0.0, 0.0, noise)), b = add(*graph, leaf(0.4, 0.0, 0.0, noise));
  CHECK(graph->merge(PlaneEvidence{}) == 2);  // the evidence of each node, nothing else
  CHECK(graph->root(a) != graph->root(b));
}

TEST_CASE("region graph: a merged node has the moments of both") {
  const auto graph = std::make_unique<Graph>();
  test::Noise noise;
  const PlaneMoments left = leaf(0.0, 0.0, 0.0, noise), right = leaf(0.4, 0.0, 0.0, noise);
  const auto a = add(*graph, left), b = add(*graph, right);
  graph->link(a, b);
  graph->merge(PlaneEvidence{});
  PlaneMoments both = left;
  both.add(right);
  const PlaneMoments& merged = graph->moments(graph->root(a));
  CHECK(merged.points == 32.0f);
  CHECK(merged.x == Approx(both.x));
  CHECK(merged.zz == Approx(both.zz));
}

TEST_CASE("region graph: a second link between two nodes takes no place, whichever end comes first") {
  constexpr Limits two{.regions = 8, .links = 2};
  const auto graph = std::make_unique<RegionGraph<two>>();
  const auto a = graph->add_node(), b = graph->add_node(), c = graph->add_node(), d = graph->add_node();
  const auto from_a = graph->link(a, b), from_b = graph->link(b, c);
  REQUIRE(from_a != graph->none);
  REQUIRE(from_b != graph->none);
  CHECK(graph->link(a, b) == from_a);
  CHECK(graph->link(b, a) == (from_a ^ 1));  // the other end
  CHECK(graph->link(c, b) == (from_b ^ 1));
  CHECK(graph->link(c, d) == graph->none);  // the store is full
  CHECK(graph->link(a, b) == from_a);       // but known links are still found
}

//   road  | pavement, whose plane is 3 mm above the road's at the road's middle and 7 cm at its own end: the planes do
//  _______|----------  not show the curb, but the cells along the border do. Half of it is seen on either half of the
//                      pavement.
TEST_CASE(
    "region graph: what pairs of cells show of a border is kept when regions merge, whichever way it was linked") {
  test::Noise noise;
  const auto patch = [&](double x0, double x1, double y0, double y1) {
    const auto height_m = [](double x, double) { return x < 2.0 ? 0.0 : 0.025 + 0.022 * (x - 2.0); };
    return test::of_points(test::sample({x0, x1, y0, y1}, 0.1, 0.007, noise, height_m));
  };
  const PlaneMoments road = patch(0, 2, 0, 4), right = patch(2, 4, 0, 2), left = patch(2, 4, 2, 4);
  const auto merges = [&](bool road_first, int pairs, float rise_m) {
    const auto graph = std::make_unique<Graph>();
    graph->clear(0.1f, 0.1f);
    const auto p = add(*graph, right), r = add(*graph, road), q = add(*graph, left);
    REQUIRE(graph->link(p, q) != Graph::none);
    const auto to_p = graph->link(r, p), to_q = road_first ? graph->link(r, q) : graph->link(q, r);
    for (int k = 0; k < pairs; ++k) {
      graph->add_pair(to_p, 0, rise_m);
      graph->add_pair(road_first ? to_q : static_cast<Graph::Index>(to_q ^ 1u), 0, rise_m);
    }
    graph->merge(PlaneEvidence{});
    CHECK(graph->root(p) == graph->root(q));
    return graph->root(r) == graph->root(p);
  };
  for (const bool road_first : {true, false}) {
    CHECK(merges(road_first, 0, 0.0f));     // nothing is known of the border
    CHECK(merges(road_first, 20, 0.001f));  // the ground does not jump there
    CHECK(merges(road_first, 20, -0.02f));  // it jumps, but not as the planes do
    CHECK_FALSE(merges(road_first, 20, 0.02f));
    CHECK_FALSE(merges(road_first, 2, 0.02f));  // four pairs together show what two do not
    CHECK(merges(road_first, 1, 0.02f));        // two together do not show it either
  }
}

TEST_CASE(
    "region graph: on a hill, too, pairs of cells show a curb by what they rise beyond the hill, along either axis") {
  const int axis = GENERATE(0, 1);
  const double hill = GENERATE(0.1, -0.1);
  test::Noise noise;
  const auto patch = [&](double from, double to, double first, double last) {
    const auto height_m = [=](double x, double y) {
      const double across = axis == 0 ? x : y;
      return hill * across + (across < 2.0 ? 0.0 : 0.025 + 0.022 * (across - 2.0));
    };
    const test::Patch along_x{from, to, first, last}, along_y{first, last, from, to};
    return test::of_points(test::sample(axis == 0 ? along_x : along_y, 0.1, 0.007, noise, height_m));
  };
  const PlaneMoments road = patch(0, 2, 0, 4), right = patch(2, 4, 0, 2), left = patch(2, 4, 2, 4);
  const auto merges = [&](double jump_m) {
    const auto graph = std::make_unique<Graph>();
    graph->clear(0.1f, 0.1f);
    const auto p = add(*graph, right), r = add(*graph, road), q = add(*graph, left);
    REQUIRE(graph->link(p, q) != Graph::none);
    const auto to_p = graph->link(r, p), to_q = graph->link(r, q);
    for (int k = 0; k < 20; ++k) {
      for (const auto end : {to_p, to_q}) graph->add_pair(end, axis, static_cast<float>(0.1 * hill + jump_m));
    }
    graph->merge(PlaneEvidence{});
    CHECK(graph->root(p) == graph->root(q));
    return graph->root(r) == graph->root(p);
  };
  CHECK(merges(0.001));
  CHECK(merges(-0.02));
  CHECK_FALSE(merges(0.02));
}

TEST_CASE("region graph: a full store refuses nodes") {
  constexpr Limits three{.regions = 3, .links = 8};
  const auto graph = std::make_unique<RegionGraph<three>>();
  for (int k = 0; k < 3; ++k) CHECK(graph->add_node() == k);
  CHECK(graph->add_node() == RegionGraph<three>::none);
  CHECK(graph->nodes() == 3);
  graph->clear(0.1f, 0.1f);
  CHECK(graph->nodes() == 0);
  CHECK(graph->add_node() == 0);
}

/// A chequered street: an 8 x 8 grid of leaves on three planes with noise. link_order determines the order in which
/// neighbours are linked.
std::vector<int> partition_of_street(std::uint32_t link_order) {
  static const auto graph = std::make_unique<Graph>();
  graph->clear(0.1f, 0.1f);
  test::Noise noise(5);
  std::vector<Graph::Index> nodes;
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      const double x = 0.4 * i, y = 0.4 * j;
      nodes.push_back(add(*graph, j < 3   ? leaf(x, y, 0.0, noise)
                                  : j < 6 ? leaf(x, y, 0.06, noise)
                                          : leaf(x, y, 0.0, noise, 0.15)));
    }
  }
  std::vector<std::pair<int, int>> links;
  for (int k = 0; k < 64; ++k) {
    if (k % 8 < 7) links.emplace_back(k, k + 1);
    if (k < 56) links.emplace_back(k, k + 8);
  }
  std::mt19937 engine(link_order);
  for (std::size_t k = links.size(); link_order > 0 && k > 1; --k) {
    std::swap(links[k - 1], links[engine() % k]);
    if (engine() % 2 == 0) std::swap(links[k - 1].first, links[k - 1].second);
  }
  for (const auto& [a, b] : links)
    REQUIRE(graph->link(nodes[static_cast<std::size_t>(a)], nodes[static_cast<std::size_t>(b)]) != Graph::none);
  graph->merge(PlaneEvidence{});
  std::vector<int> first_of_root(64, -1), partition;
  for (int k = 0; k < 64; ++k) {
    int& first = first_of_root[graph->root(nodes[static_cast<std::size_t>(k)])];
    if (first < 0) first = k;
    partition.push_back(first);
  }
  return partition;
}

TEST_CASE("region graph: three planes are found whole") {
  const auto partition = partition_of_street(0);
  for (std::size_t k = 0; k < 64; ++k) CHECK(partition[k] == (k % 8 < 3 ? 0 : k % 8 < 6 ? 3 : 6));
}

TEST_CASE("region graph: the order in which links were added does not matter") {
  const auto partition = partition_of_street(0);
  for (std::uint32_t order = 1; order <= 20; ++order) CHECK(partition_of_street(order) == partition);
}

/// The sum of scores, which merging increases.
double score(const std::vector<PlaneMoments>& leaves, const std::vector<int>& block_of) {
  double total = 0.0;
  for (int block = 0; block < static_cast<int>(leaves.size()); ++block) {
    PlaneMoments m;
    for (std::size_t k = 0; k < leaves.size(); ++k) {
      if (block_of[k] == block) m.add(leaves[k]);
    }
    if (m.points > 0.0f) total += static_cast<double>(PlaneEvidence{}.score(m));
  }
  return total;
}

TEST_CASE("region graph: on a short chain greedy merging finds the best partition of all") {
  test::Noise noise(11);
  std::vector<PlaneMoments> leaves;
  for (const double height : {0.0, 0.0, 0.1, 0.1, 0.1, 0.0, 0.0, 0.2})
    leaves.push_back(leaf(0.4 * static_cast<double>(leaves.size()), 0.0, height, noise));
  // A partition of a chain into runs: bit k is set if a run ends after leaf k.
  double best = -1e30;
  unsigned best_cuts = 0;
  for (unsigned cuts = 0; cuts < 128; ++cuts) {
    std::vector<int> block_of(8, 0);
    for (std::size_t k = 1; k < 8; ++k) block_of[k] = block_of[k - 1] + static_cast<int>(cuts >> (k - 1) & 1u);
    const double s = score(leaves, block_of);
    if (s > best) {
      best = s;
      best_cuts = cuts;
    }
  }
  const auto graph = std::make_unique<Graph>();
  std::vector<Graph::Index> nodes;
  for (const PlaneMoments& m : leaves) nodes.push_back(add(*graph, m));
  for (std::size_t k = 1; k < nodes.size(); ++k) graph->link(nodes[k - 1], nodes[k]);
  graph->merge(PlaneEvidence{});
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    const bool cut = (best_cuts >> (k - 1) & 1u) != 0;
    CHECK((graph->root(nodes[k - 1]) != graph->root(nodes[k])) == cut);
  }
}

/// Gain of merging two regions, with everything computed afresh.
float gain(const PlaneMoments& a, const PlaneMoments& b) {
  const PlaneEvidence evidence;
  PlaneMoments both = a;
  both.add(b);
  return evidence.gain(a, evidence.score(a), b, evidence.score(b), both, [] { return BorderRise{}; });
}

/// The result that merge() must reach: computes all gains afresh for every merge and takes the best one. Returns the
/// numbers of the blocks.
std::vector<int> merged_naively(std::vector<PlaneMoments> moments, std::vector<std::pair<int, int>> links) {
  std::vector<int> block_of(moments.size());
  std::iota(block_of.begin(), block_of.end(), 0);
  for (;;) {
    float best = 0.0f;
    std::pair<int, int> pair{-1, -1};
    for (const auto& [from, to] : links) {
      const int a = block_of[static_cast<std::size_t>(from)], b = block_of[static_cast<std::size_t>(to)];
      if (a == b) continue;
      const float gained = gain(moments[static_cast<std::size_t>(a)], moments[static_cast<std::size_t>(b)]);
      if (gained >= best) best = gained, pair = {a, b};
    }
    if (pair.first < 0) return block_of;
    moments[static_cast<std::size_t>(pair.first)].add(moments[static_cast<std::size_t>(pair.second)]);
    std::replace(block_of.begin(), block_of.end(), pair.second, pair.first);
  }
}

std::size_t regions(const std::vector<int>& block_of) {
  return std::set<int>(block_of.begin(), block_of.end()).size();
}

/// Merges a field of 6 x 6 leaves with random heights and slopes, and checks that no merge with a gain is left. Returns
/// how many more regions there are than by naive merging.
int more_by_laziness(std::uint32_t seed) {
  test::Noise noise(seed);
  std::vector<PlaneMoments> leaves;
  std::vector<std::pair<int, int>> links;
  for (int k = 0; k < 36; ++k) {
    leaves.push_back(leaf(0.4 * (k / 6), 0.4 * (k % 6), 0.015 * noise.normal(), noise, 0.05 * noise.normal()));
    if (k % 6 > 0) links.emplace_back(k - 1, k);
    if (k >= 6) links.emplace_back(k - 6, k);
  }
  const auto graph = std::make_unique<Graph>();
  std::vector<Graph::Index> nodes;
  for (const PlaneMoments& m : leaves) nodes.push_back(add(*graph, m));
  for (const auto& [a, b] : links) graph->link(nodes[static_cast<std::size_t>(a)], nodes[static_cast<std::size_t>(b)]);
  graph->merge(PlaneEvidence{});
  std::vector<int> block_of;
  for (const auto node : nodes) block_of.push_back(static_cast<int>(graph->root(node)));
  for (const auto& [a, b] : links) {
    const auto low = graph->root(nodes[static_cast<std::size_t>(a)]),
               high = graph->root(nodes[static_cast<std::size_t>(b)]);
    if (low == high) continue;
    CHECK(gain(graph->moments(low), graph->moments(high)) < 1e-3f);
  }
  return static_cast<int>(regions(block_of)) - static_cast<int>(regions(merged_naively(leaves, links)));
}

TEST_CASE(
    "region graph: lazily computed gains end where no merge gains, on average with as many regions as recomputing "
    "all") {
  int more = 0;
  for (std::uint32_t seed = 1; seed <= 30; ++seed) more += more_by_laziness(seed);
  CHECK(std::abs(more) < 15);  // half a region out of seventeen
}

TEST_CASE("region graph: neighbours of both merged nodes are linked once, so that no evidence is computed twice") {
  const auto graph = std::make_unique<Graph>();
  test::Noise noise;
  std::vector<Graph::Index> nodes;
  for (int k = 0; k < 8; ++k) nodes.push_back(add(*graph, leaf(0.4 * (k % 4), 0.4 * (k / 4), 0.0, noise)));
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t b = 0; b < a; ++b) graph->link(nodes[a], nodes[b]);
  }
  const int evidences = graph->merge(PlaneEvidence{});
  for (const auto node : nodes) CHECK(graph->root(node) == graph->root(nodes[0]));
  CHECK(evidences < 8 + 28 + 7);  // nodes, links, under one a merge; 21 if all neighbours were evaluated after each
}

}  // namespace
}  // namespace curbline
