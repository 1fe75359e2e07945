// Loopy belief propagation on the grid (paper, III-D): sum-product for responsibilities, max-product for the final
// labels.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "reference/dem.hpp"
#include "reference/reference.hpp"

namespace curbline::tools::reference {

/// Factor of an edge: one value if both cells have the same label, another if not.
struct EdgeFactor {
  double equal = 1, unequal = 1;
};

/// The factors of all edges, by Options::edge. eq. (10): with d = |h_i - h_j| and q = 1 / (1 + exp(s2_i + s2_j - d)), 1
/// - q for equal labels, q otherwise.
std::vector<EdgeFactor> edge_factors(const Dem& dem, const Options& options);

/// The limits in the paper's code: 200 sweeps, or until no message changes by more than 1e-9.
inline constexpr int most_sweeps = 200;
inline constexpr double message_tolerance = 1e-9;

struct BeliefSummary {
  int sweeps = 0;
  bool converged = false;
  long messages = 0;
};

enum class Product { sum, max };

/// Beliefs (rows: cells, normalised) from log node potentials. Messages start uniform and are updated one after the
/// other, alternately forward and backward (the paper's code: in random order; measurements show no difference).
BeliefSummary propagate(const Dem& dem, const Eigen::MatrixXd& log_node, const std::vector<EdgeFactor>& factors,
                        Product product, Messages messages, Eigen::MatrixXd& belief);

}  // namespace curbline::tools::reference
