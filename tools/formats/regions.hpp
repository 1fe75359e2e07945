// Hand-drawn or simulated regions of the ground (`.gt`): polygons, one corner a line, x y in millimetres, apart by a
// blank line.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace curbline::tools {

struct Corner {
  double x_m = 0, y_m = 0;
};
using Region = std::vector<Corner>;  ///< closed: the last corner is joined to the first

/// Throws BadInput for anything but two numbers a line, for a polygon of less than three corners, and for none.
std::vector<Region> read_regions(const std::string& path);

/// To 0.1 mm.
void write_regions(std::ostream& out, const std::vector<Region>& regions);

}  // namespace curbline::tools
