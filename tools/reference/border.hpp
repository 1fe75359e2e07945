// The paper's curbs: neighbouring cells with different labels.
#pragma once

#include <vector>

#include "map/map.hpp"

namespace curbline::tools::reference {

/// The edges between cells of different label, those that continue each other along a row or column joined. Heights by
/// the planes in the middle, far less near as seen from the origin, sd of the cells about both planes; 0 with an sd of
/// 1 m where a label has no plane. A crease is a border where the planes meet between the cells' centres, or whose
/// height is within two sd.
std::vector<MapCurb> borders(const Map& map);

}  // namespace curbline::tools::reference
