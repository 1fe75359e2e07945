// Where two regions of the ground meet, seen from above: the vertical faces that the laser hits, and the true curbs.
#pragma once

#include "simulator/ground_plan.hpp"

#include <vector>

namespace curbline::tools {

/// Sorts the places at which a piece of this length is cut, shares of it; of places that touch the first stays.
void sort_cuts(std::vector<double>& cuts, double length_m);

/// A straight piece between two regions. Left and right are as seen when going from `from` to `to`; -1 is the void.
struct Boundary {
  Point2 from, to;
  int left = -1, right = -1;
};

/// Every visible piece once, as long as its edge and its neighbours allow. About O(edges log edges), unless many lie
/// above each other. Strips narrower than 20 um are missed.
std::vector<Boundary> visible_boundaries(const std::vector<GroundRegion>& regions);

}  // namespace curbline::tools
