// Graph segmentation (Felzenszwalb and Huttenlocher 2004) of the elevation map (paper, III-C): where EM starts.
#pragma once

#include <vector>

#include "reference/dem.hpp"

namespace curbline::tools::reference {

/// Kullback-Leibler divergence of two cells' normals, both ways, added.
double divergence(const DemCell& a, const DemCell& b);

/// Component of each valid cell, numbered by size, the largest first.
std::vector<int> segment(const Dem& dem, double scale);

}  // namespace curbline::tools::reference
