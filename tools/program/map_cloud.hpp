// Maps a whole cloud, by any method.
#pragma once

#include <span>
#include <vector>

#include "curbline/point.hpp"
#include "map/map.hpp"
#include "program/map_options.hpp"

namespace curbline::tools {

/// Window, cell size, height and method are those of the options; the robot stands at the origin. With curbline itself,
/// margin_cells around the window are also mapped, but not returned. Shadows and veils are those of a laser at the
/// origin, or 1 m above it if the ground is at the origin's height (the frame of a robot's base); for a cloud in
/// neither frame they are unknown. O(points log points).
Map map_cloud(std::span<const Point3> cloud, const MapOptions& options);

/// The same with one of the paper's methods or of its peers (options.method) on a given grid.
Map map_batch(std::span<const Point3> cloud, const Grid& grid, double max_height_m, const MapOptions& options);

/// The points without their variances.
std::vector<Point3> cloud_of(std::span<const Point> points);

}  // namespace curbline::tools
