// Where two regions of the ground meet, seen from above: the vertical faces that the laser hits, and the true curbs.
#pragma once

#include "simulator/scene.hpp"

#include <vector>

namespace curbline::tools {

inline constexpr double touch_m = 1e-6;  ///< closer corners are the same

/// Sorts the places at which a piece of this length is cut, shares of it; of places that touch the first stays.
void sort_cuts(std::vector<double>& cuts, double length_m);

/// A straight piece between two regions. Left and right are as seen when going from `from` to `to`; -1 is the void.
struct Boundary {
  Point2 from, to;
  int left = -1, right = -1;
};

/// Every visible piece once, as long as its edge and its neighbours allow. O(edges^2). Strips narrower than 20 um are
/// missed.
std::vector<Boundary> visible_boundaries(const std::vector<GroundRegion>& regions);

}  // namespace curbline::tools
