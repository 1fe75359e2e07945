// The paper's curbs: neighbouring cells with different labels.
#pragma once

#include <vector>

#include "map/map.hpp"

namespace curbline::tools::reference {

/// The segment of a run of consecutive edges: those after line `line` of cells along x (axis 0) or y (axis 1), of the
/// cells [first, end) in that line. All other members of the curb have their defaults.
MapCurb border_run(const Grid& grid, int axis, int line, int first, int end);

/// The edges between cells of different labels, with consecutive ones along a row or column joined. Height: difference
/// of the planes at the middle, far minus near as seen from the origin, with the sd of the cells about both planes; 0
/// with an sd of 1 m if a label has no plane. A crease is a border where the planes meet between the cells' centres, or
/// whose height is within two sd.
std::vector<MapCurb> borders(const Map& map);

}  // namespace curbline::tools::reference
