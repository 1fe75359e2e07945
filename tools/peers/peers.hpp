// Curbs by the methods that the paper compares itself with, to show the benefit of planes and probabilities. Both work
// on the cell means of an elevation map, return only curbs (cells have no labels), and have no uncertainties.
//
//   gradient  A border between neighbouring cells that differ by 3 to 30 cm is a curb.
//   canny     Canny's edges of the height map, through which RANSAC fits cubic polynomials; after F. Oniga, S.
//             Nedevschi and M. Meinecke, "Curb detection based on a multi-frame persistence map for urban driving
//             scenarios" (ITSC 2008) and "Polynomial curb detection based on dense stereovision for driving assistance"
//             (ITSC 2010). Theirs is a stereo camera's map, filtered over frames; here it is the laser's, from one
//             sweep.
#pragma once

#include <span>
#include <vector>

#include "map/map.hpp"
#include "reference/dem.hpp"

namespace curbline::tools::peers {

inline constexpr double least_step_m = 0.03;  ///< of a curb; half the height that wheels notice
inline constexpr double most_step_m = 0.3;    ///< higher is a wall or a car

enum class Method { canny, gradient };

/// Cells with heights, and curbs; points above the greatest height are ignored. Steps are as seen from the origin.
Map map_cloud(std::span<const Point3> cloud, const Grid& grid, double max_height_m, Method method);

std::vector<MapCurb> gradient_curbs(const reference::Dem& dem);
std::vector<MapCurb> canny_curbs(const reference::Dem& dem);

}  // namespace curbline::tools::peers
