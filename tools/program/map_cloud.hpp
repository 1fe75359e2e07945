// A whole cloud to a map, by any method.
#pragma once

#include <span>
#include <vector>

#include "curbline/point.hpp"
#include "map/map.hpp"
#include "program/map_options.hpp"

namespace curbline::tools {

/// Window, cell size, height and method as the options have them; the robot stands at the origin. By curbline itself
/// margin_cells around the window are mapped too, and not given out. Shadows and veils are those of a laser at the
/// origin, or 1 m above it where the ground is as high as the origin (the frame of a robot's base); of a cloud that is
/// in neither frame nothing is known of them. O(points log points).
Map map_cloud(std::span<const Point3> cloud, const MapOptions& options);

/// The same by the paper's methods or its peers' (options.method is one of them) on a given grid.
Map map_batch(std::span<const Point3> cloud, const Grid& grid, double max_height_m, const MapOptions& options);

/// Without their variances.
std::vector<Point3> cloud_of(std::span<const Point> points);

}  // namespace curbline::tools
