// Hand-drawn or simulated regions of the ground (`.gt`): polygons with one corner a line, x y in millimetres, separated
// by blank lines.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "map/polygon.hpp"

namespace curbline::tools {

/// Throws BadInput for lines that do not have two numbers, for polygons with fewer than three corners, and if there are
/// no polygons.
std::vector<Polygon> read_regions(const std::string& path);

/// Rounded to 0.1 mm.
void write_regions(std::ostream& out, const std::vector<Polygon>& regions);

}  // namespace curbline::tools
