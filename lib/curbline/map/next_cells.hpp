// How far it is from each valid cell to the next valid ones on its row and column, kept as cells become valid and leave
// the window. Two bytes a cell.
#pragma once

#include <cstddef>
#include <cstdint>

#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/window.hpp"
#include "curbline/per_cell.hpp"

namespace curbline {

template <Limits limits>
class NextCells {
 public:
  void init() { distances_.fill(0); }

  /// Distance in cells from a valid cell to the next valid one in a direction; 0 if there is none within `reach` cells,
  /// at most max_link_reach. O(1).
  int distance(int slot, int direction, int reach) const {
    const int g = distances_[slot] >> (4 * direction) & 15;
    return g <= reach ? g : 0;
  }
  /// Call when a cell has just become valid; valid(slot) tells which others are.
  template <typename Valid>
  void enter(const Window<limits>& window, int i, int j, Valid&& valid);
  /// Call when a cell leaves the window. All cells between it and the window's end leave in the same move, so that a
  /// neighbour that stays has no valid cell on that side any more.
  void leave(const Window<limits>& window, int slot);

 private:
  void set(int slot, int direction, int distance) {
    auto& distances = distances_[slot];
    distances = static_cast<std::uint16_t>((distances & ~(15 << (4 * direction))) | distance << (4 * direction));
  }

  PerCell<std::uint16_t, limits> distances_{};  ///< four bits a direction
};

template <Limits limits>
template <typename Valid>
void NextCells<limits>::enter(const Window<limits>& window, int i, int j, Valid&& valid) {
  const int s = window.slot(i, j);
  for (int d = 0; d < directions; ++d) {
    const auto n = static_cast<std::size_t>(d);
    int a = i, b = j;
    for (int g = 1; g <= max_link_reach; ++g) {
      a += step_i[n];
      b += step_j[n];
      if (!window.contains(a, b)) break;
      const int other = window.slot(a, b);
      if (!valid(other)) continue;
      set(s, d, g);
      set(other, d ^ 1, g);
      break;
    }
  }
}

template <Limits limits>
void NextCells<limits>::leave(const Window<limits>& window, int slot) {
  for (int d = 0; d < directions; ++d) {
    const int g = distance(slot, d, max_link_reach);
    if (g > 0) set(window.slot_beside(slot, d, g), d ^ 1, 0);
  }
  distances_[slot] = 0;
}

}  // namespace curbline
