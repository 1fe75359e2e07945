// Graph segmentation (Felzenszwalb and Huttenlocher 2004) of the elevation map (paper, III-C): the initialisation of
// EM.
#pragma once

#include <vector>

#include "reference/dem.hpp"

namespace curbline::tools::reference {

/// Symmetric Kullback-Leibler divergence of two cells' normal distributions: the sum of both directions.
double divergence(const DemCell& a, const DemCell& b);

/// Component of each valid cell, numbered by size, the largest first.
std::vector<int> segment(const Dem& dem, double scale);

}  // namespace curbline::tools::reference
