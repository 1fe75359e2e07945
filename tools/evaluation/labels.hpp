// Agreement of labels and planes with the truth.
#pragma once

#include <span>
#include <vector>

#include "map/map.hpp"
#include "map/polygon.hpp"

namespace curbline::tools {

/// V-measure (Rosenberg and Hirschberg 2007): harmonic mean of homogeneity and completeness of two labellings of the
/// same items, in [0, 1]. Labels are arbitrary numbers. 0 for no items.
double v_measure(std::span<const int> truth, std::span<const int> label);

/// Region of the centre of each cell of a grid: the first that contains it, or -1.
std::vector<int> regions_of_cells(const Grid& grid, std::span<const Polygon> regions);

/// V-measure over the valid cells that lie in a region; all cells without a label count as one label.
double v_measure(const Map& map, std::span<const int> region_of_cell);

/// The paper's RMSE of prediction: cell heights of another map, at the centroids of its points, predicted by the planes
/// of this map's labels, over the cells that are valid in both and have a label with a plane. NaN if there are none.
/// Both maps are on the same grid.
double prediction_rmse(const Map& trained, const Map& other);

/// Root mean square of the difference of the cells' heights, over the cells that are valid in both. 0 if there are
/// none.
double height_rms(const Map& a, const Map& b);

}  // namespace curbline::tools
