// The window that the options request, and the part of a map inside it.
#pragma once

#include "curbline/settings.hpp"
#include "map/map.hpp"
#include "program/map_options.hpp"

namespace curbline::tools {

/// Replaces the robot's window by that of the options; rows and columns are rounded up to whole blocks. Throws
/// CLI::ValidationError if it is invalid.
void apply_window(const MapOptions& options, WindowSettings& window);

/// The requested grid: exactly the window of the options, without the rounding.
Grid asked_grid(const MapOptions& options, const WindowSettings& window);

/// The part of a map inside the requested grid, with the planes that its cells are labelled with. Cells beyond the map
/// are empty: a window's floats, 8 mm apart at 100 km, may be off by some of its cells.
Map crop(const Map& map, const Grid& asked);

}  // namespace curbline::tools
