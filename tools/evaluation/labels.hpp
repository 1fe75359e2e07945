// How well labels and planes agree with the truth.
#pragma once

#include <span>
#include <vector>

#include "map/map.hpp"
#include "map/polygon.hpp"

namespace curbline::tools {

/// V-measure (Rosenberg and Hirschberg 2007): harmonic mean of homogeneity and completeness of two labellings of the
/// same things, in [0, 1]. Labels are any numbers. 0 for none.
double v_measure(std::span<const int> truth, std::span<const int> label);

/// Region of each cell of a grid by its centre, -1 outside all: the first that holds it.
std::vector<int> regions_of_cells(const Grid& grid, std::span<const Polygon> regions);

/// V-measure over the valid cells that lie in a region; a cell without a label counts as one label of its own.
double v_measure(const Map& map, std::span<const int> region_of_cell);

/// The paper's RMSE of prediction: another map's cell heights, at the centroids of its points, by the planes of this
/// map's labels, over the cells that are valid in both and bear a label with a plane. NaN if there are none. Both maps
/// on one grid.
double prediction_rmse(const Map& trained, const Map& other);

/// Root mean square of the difference of the cells' heights, over the cells that are valid in both. 0 if there are
/// none.
double height_rms(const Map& a, const Map& b);

}  // namespace curbline::tools
