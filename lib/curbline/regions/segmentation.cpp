#include "curbline/regions/segmentation.hpp"

#include <span>

namespace curbline {
namespace {

struct Edge {
  float weight;
  std::uint8_t a, b;
};

/// KL(a || b) + KL(b || a) of two normal distributions; the logarithms cancel.
float divergence(const BlockCell& a, const BlockCell& b) {
  const float v = a.variance_m2, w = b.variance_m2;
  const float d = a.height_m - b.height_m, e = v - w;
  return 0.5f * (e * e + d * d * (v + w)) / (v * w);
}

/// Edges to the next valid cell along each axis, ascending by weight; at most two a cell.
std::size_t list_edges(const std::array<BlockCell, block_cells>& cells, std::array<Edge, 2 * block_cells>& edges) {
  constexpr std::size_t side = block_side;
  std::size_t count = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (!cells[k].valid) continue;
    for (const std::size_t step : {side, std::size_t{1}}) {
      const std::size_t end = step == 1 ? (k / side + 1) * side : cells.size();
      std::size_t n = k + step;
      while (n < end && !cells[n].valid) n += step;
      if (n >= end) continue;
      const Edge edge{divergence(cells[k], cells[n]), static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(n)};
      std::size_t place = count++;
      for (; place > 0 && edges[place - 1].weight > edge.weight; --place) edges[place] = edges[place - 1];
      edges[place] = edge;
    }
  }
  return count;
}

}  // namespace

BlockLeaves cut_block(const std::array<BlockCell, block_cells>& cells, float scale) {
  BlockLeaves root;                      // union-find; the root of a component is its first cell
  std::array<float, block_cells> limit;  // Int(C) + s / |C|, at the root of component C
  std::array<float, block_cells> size;
  for (std::size_t k = 0; k < root.size(); ++k) {
    root[k] = cells[k].valid ? static_cast<std::uint8_t>(k) : std::uint8_t{255};
    limit[k] = scale;
    size[k] = 1.0f;
  }
  const auto root_of = [&](std::uint8_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  std::array<Edge, 2 * block_cells> edges;
  const std::size_t count = list_edges(cells, edges);
  for (const Edge& edge : std::span(edges).first(count)) {
    const std::uint8_t a = root_of(edge.a), b = root_of(edge.b);
    if (a == b || edge.weight > limit[a] || edge.weight > limit[b]) continue;
    const std::uint8_t low = a < b ? a : b, high = a < b ? b : a;
    root[high] = low;
    size[low] = size[a] + size[b];
    limit[low] = edge.weight + scale / size[low];
  }
  for (std::uint8_t& r : root) {
    if (r != 255) r = root[r];
  }
  return root;
}

}  // namespace curbline
