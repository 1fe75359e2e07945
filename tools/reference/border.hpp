// The paper's curbs: neighbouring cells with different labels.
#pragma once

#include <vector>

#include "map/map.hpp"

namespace curbline::tools::reference {

/// Where a run of edges lies that continue each other: those behind line `line` of cells along x (axis 0) or y (axis
/// 1), of the cells [first, end) in that line. All else of the curb is as it is by default.
MapCurb border_run(const Grid& grid, int axis, int line, int first, int end);

/// The edges between cells of different label, those that continue each other along a row or column joined. Heights by
/// the planes in the middle, far less near as seen from the origin, sd of the cells about both planes; 0 with an sd of
/// 1 m where a label has no plane. A crease is a border where the planes meet between the cells' centres, or whose
/// height is within two sd.
std::vector<MapCurb> borders(const Map& map);

}  // namespace curbline::tools::reference
