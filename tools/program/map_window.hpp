// The window that the options ask for, and what of a map lies in it.
#pragma once

#include "curbline/settings.hpp"
#include "map/map.hpp"
#include "program/map_options.hpp"

namespace curbline::tools {

/// Puts the window of the options in place of the robot's: rows and columns are rounded up to whole blocks. Throws
/// CLI::ValidationError if it makes no sense.
void apply_window(const MapOptions& options, WindowSettings& window);

/// The grid that was asked for: the window of the options exactly, without the rounding.
Grid asked_grid(const MapOptions& options, const WindowSettings& window);

/// The part of a map that lies in the grid asked for, which is within the map's, and what planes its cells bear.
Map crop(const Map& map, const Grid& asked);

}  // namespace curbline::tools
