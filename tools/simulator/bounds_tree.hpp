// Finds the few of many boxes in the ground plan that lie at a place, without looking at all: regions, edges, faces and
// obstacles of a scene. A binary tree of boxes around boxes; building it is O(n log n), a look-up about O(log n + boxes
// found).
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "map/polygon.hpp"

namespace curbline::tools {

class BoundsTree {
 public:
  explicit BoundsTree(std::vector<Bounds> boxes);

  /// The numbers of the boxes that overlap this one, or touch it, ascending.
  std::vector<std::size_t> overlapping(const Bounds& box) const;

 private:
  struct Node {
    Bounds about;            ///< all of its boxes
    std::size_t first, end;  ///< their places in order_
    std::size_t right = 0;   ///< the right child; the left one is the next node; 0: a leaf
  };

  std::size_t build(std::size_t first, std::size_t end);
  void collect(std::size_t node, const Bounds& box, std::vector<std::size_t>& found) const;

  std::vector<Bounds> boxes_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

/// The tree of the boxes around things.
template <typename Thing, typename BoxOf>
BoundsTree tree_of(const std::vector<Thing>& things, BoxOf box_of) {
  std::vector<Bounds> boxes;
  for (const Thing& thing : things) boxes.push_back(box_of(thing));
  return BoundsTree(std::move(boxes));
}

}  // namespace curbline::tools
