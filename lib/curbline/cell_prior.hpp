// The prior of a cell's heights: a setting, of which the map's cells (map/cell.hpp) make their posterior.
#pragma once

namespace curbline {

/// Prior of a cell's variance: a scaled inverse chi-squared of `degrees` observations of `variance_m2`. The mean's
/// prior is flat (kappa0 = 0), as in the paper's code.
struct CellPrior {
  float degrees = 3.0f;               ///< [1e-3, 1e6]
  float variance_m2 = 0.02f * 0.02f;  ///< [1e-10, 100]
};

}  // namespace curbline
