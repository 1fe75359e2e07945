#include "curbline/regions/segmentation.hpp"

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
int list_edges(const std::array<BlockCell, block_cells>& cells, std::array<Edge, 2 * block_cells>& edges) {
  int count = 0;
  for (int k = 0; k < block_cells; ++k) {
    if (!cells[static_cast<std::size_t>(k)].valid) continue;
    for (const int step : {block_side, 1}) {
      const int end = step == 1 ? (k / block_side + 1) * block_side : block_cells;
      int n = k + step;
      while (n < end && !cells[static_cast<std::size_t>(n)].valid) n += step;
      if (n >= end) continue;
      const Edge edge{divergence(cells[static_cast<std::size_t>(k)], cells[static_cast<std::size_t>(n)]),
                      static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(n)};
      int place = count++;
      for (; place > 0 && edges[static_cast<std::size_t>(place - 1)].weight > edge.weight; --place) {
        edges[static_cast<std::size_t>(place)] = edges[static_cast<std::size_t>(place - 1)];
      }
      edges[static_cast<std::size_t>(place)] = edge;
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
  const int count = list_edges(cells, edges);
  for (int e = 0; e < count; ++e) {
    const Edge& edge = edges[static_cast<std::size_t>(e)];
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
