// Mixture of planes (paper, III-D): h_i ~ sum_k pi_k N(w_k' phi_i, v_k), fitted by EM. The E-step is the caller's.
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

/// Least squares for each component of three cells or more, which are the first; smaller ones get no plane, but their
/// cells stay in the mixture. No cell is weighed, as in the code (the text weighs by variance).
std::vector<MixturePlane> planes_of_components(const Dem& dem, const std::vector<int>& component);

/// ln(pi_k N(h_i | w_k' phi_i, v_k)).
Eigen::MatrixXd log_likelihoods(const Dem& dem, const std::vector<MixturePlane>& planes);

/// E-step for independent cells; returns the log likelihood of all.
double independent_responsibilities(const Eigen::MatrixXd& log_likelihood, Responsibilities& out);

/// M-step: least squares weighed by responsibility. A plane that nearly no cell answers for keeps its parameters.
void maximise(const Dem& dem, const Responsibilities& responsibility, std::vector<MixturePlane>& planes);

}  // namespace curbline::tools::reference
