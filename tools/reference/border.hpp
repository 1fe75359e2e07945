// The paper's curbs: neighbouring cells with different labels.
#pragma once

#include <vector>

#include "map/map.hpp"

namespace curbline::tools::reference {

/// The edges between cells of different label, those that continue each other along a row or column joined. Heights by the
/// planes in the middle, far less near as seen from the origin; 0 with a large sd where a label has no plane.
std::vector<MapCurb> borders(const Map& map);

}  // namespace curbline::tools::reference
