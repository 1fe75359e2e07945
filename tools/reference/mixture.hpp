// Mixture of planes (paper, III-D): h_i ~ sum_k pi_k N(w_k' phi_i, v_k), fitted by EM. The caller does the E-step.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "reference/dem.hpp"

namespace curbline::tools::reference {

struct MixturePlane {
  Eigen::Vector3d w = Eigen::Vector3d::Zero();  ///< z = w . [1 x y], from the grid's corner
  double variance_m2 = 0;
  double weight = 0;  ///< pi_k
};

/// Rows: valid cells; columns: planes.
using Responsibilities = Eigen::MatrixXd;

/// Least squares for each component of three cells or more, which come first; smaller ones get no plane, but their
/// cells stay in the mixture. Cells are not weighted, as in the code (the paper's text weights them by variance).
std::vector<MixturePlane> planes_of_components(const Dem& dem, const std::vector<int>& component);

/// ln(pi_k N(h_i | w_k' phi_i, v_k)).
Eigen::MatrixXd log_likelihoods(const Dem& dem, const std::vector<MixturePlane>& planes);

/// E-step for independent cells; returns the total log likelihood.
double independent_responsibilities(const Eigen::MatrixXd& log_likelihood, Responsibilities& out);

/// M-step: least squares weighted by responsibility. A plane that has almost no responsibility keeps its parameters.
void maximise(const Dem& dem, const Responsibilities& responsibility, std::vector<MixturePlane>& planes);

}  // namespace curbline::tools::reference
