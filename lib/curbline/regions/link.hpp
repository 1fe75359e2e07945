// Links between neighbours: each valid cell and the next valid one on its row and on its column, also across cells that
// scan lines leave empty. A pass over the window.
#pragma once

#include "curbline/limits.hpp"
#include "curbline/map/dem.hpp"

namespace curbline {

/// Two valid cells with no valid cell between them on a row or column.
struct Link {
  int from, to;  ///< slots
  int distance;  ///< in cells
  int axis;      ///< 0: along +x, 1: along +y
};

/// Calls visit(const Link&) for each pair of neighbours along +x and +y that are at most `reach` cells apart.
template <Limits limits, typename Visit>
void for_each_link(const Dem<limits>& dem, int reach, Visit&& visit) {
  dem.for_each_valid([&](int, int, int s) {
    for (int axis = 0; axis < 2; ++axis) {
      const int g = dem.next_valid(s, direction(axis, 1), reach);
      if (g > 0) visit(Link{s, dem.slot_beside(s, direction(axis, 1), g), g, axis});
    }
  });
}

/// The first cell that is not obstructed(slot), from link.to on in the link's direction; -1 if there is none within
/// `reach` cells of link.from.
template <Limits limits, typename Obstructed>
int beyond_obstacle(const Dem<limits>& dem, const Link& link, int reach, Obstructed&& obstructed) {
  const int along = direction(link.axis, 1);
  int slot = link.to;
  for (int distance = link.distance; obstructed(slot);) {
    const int g = dem.next_valid(slot, along, reach - distance);
    if (g == 0) return -1;
    distance += g;
    slot = dem.slot_beside(slot, along, g);
  }
  return slot;
}

}  // namespace curbline
