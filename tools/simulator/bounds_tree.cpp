#include "simulator/bounds_tree.hpp"

#include <algorithm>
#include <numeric>

namespace curbline::tools {
namespace {

constexpr std::size_t most_in_leaf = 4;

}  // namespace

BoundsTree::BoundsTree(std::vector<Bounds> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!boxes_.empty()) build(0, boxes_.size());
}

/// Splits at the median along the longer side. Returns the node's number.
std::size_t BoundsTree::build(std::size_t first, std::size_t end) {
  Bounds about = boxes_[order_[first]];
  for (std::size_t i = first; i < end; ++i) about = united(about, boxes_[order_[i]]);
  const std::size_t node = nodes_.size();
  nodes_.push_back({about, first, end});
  if (end - first <= most_in_leaf) return node;
  const bool along_x = about.x1 - about.x0 > about.y1 - about.y0;
  const auto twice_middle = [&](std::size_t box) {
    const Bounds& b = boxes_[box];
    return along_x ? b.x0 + b.x1 : b.y0 + b.y1;
  };
  const std::size_t half = first + (end - first) / 2;
  const auto at = [&](std::size_t place) { return order_.begin() + static_cast<std::ptrdiff_t>(place); };
  std::nth_element(at(first), at(half), at(end), [&](auto a, auto b) { return twice_middle(a) < twice_middle(b); });
  build(first, half);
  const std::size_t right = build(half, end);
  nodes_[node].right = right;
  return node;
}

std::vector<std::size_t> BoundsTree::overlapping(const Bounds& box) const {
  std::vector<std::size_t> found;
  if (!nodes_.empty()) collect(0, box, found);
  std::sort(found.begin(), found.end());
  return found;
}

void BoundsTree::collect(std::size_t node, const Bounds& box, std::vector<std::size_t>& found) const {
  const Node& here = nodes_[node];
  if (!overlap(here.about, box)) return;
  if (here.right != 0) {
    collect(node + 1, box, found);
    collect(here.right, box, found);
    return;
  }
  for (std::size_t i = here.first; i < here.end; ++i) {
    if (overlap(boxes_[order_[i]], box)) found.push_back(order_[i]);
  }
}

}  // namespace curbline::tools
