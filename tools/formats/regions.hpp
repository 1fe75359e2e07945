// Hand-drawn or simulated regions of the ground (`.gt`): polygons, one corner a line, x y in millimetres, apart by a
// blank line.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "map/polygon.hpp"

namespace curbline::tools {

/// Throws BadInput for anything but two numbers a line, for a polygon of less than three corners, and for none.
std::vector<Polygon> read_regions(const std::string& path);

/// To 0.1 mm.
void write_regions(std::ostream& out, const std::vector<Polygon>& regions);

}  // namespace curbline::tools
