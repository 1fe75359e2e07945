#include "reference/belief_propagation.hpp"

#include <algorithm>
#include <cmath>

namespace curbline::tools::reference {
namespace {

Eigen::Index index(std::size_t n) {
  return static_cast<Eigen::Index>(n);
}

/// Messages 2 e (from a to b) and 2 e + 1 (from b to a) of edge e, each normalised to sum 1.
class Propagation {
 public:
  Propagation(const Dem& dem, const Eigen::MatrixXd& log_node, const std::vector<EdgeFactor>& factors, Product product,
              Messages messages)
      : dem_(dem),
        factors_(factors),
        product_(product),
        general_(messages == Messages::general),
        incoming_(dem.valid.size()) {
    const Eigen::Index labels = log_node.cols();
    node_ = (log_node.colwise() - log_node.rowwise().maxCoeff()).array().exp().transpose();
    message_ = Eigen::MatrixXd::Constant(labels, index(2 * dem.edges.size()), 1.0 / static_cast<double>(labels));
    for (std::size_t e = 0; e < dem.edges.size(); ++e) {
      incoming_[dem.edges[e].b].push_back(2 * e);
      incoming_[dem.edges[e].a].push_back(2 * e + 1);
    }
    cavity_.resize(labels);
    fresh_.resize(labels);
  }

  /// Updates all messages once; returns the largest change.
  double sweep(bool forward) {
    double change = 0;
    const std::size_t count = 2 * dem_.edges.size();
    for (std::size_t n = 0; n < count; ++n) change = std::max(change, update(forward ? n : count - 1 - n));
    return change;
  }

  Eigen::MatrixXd beliefs() const {
    Eigen::MatrixXd out(index(dem_.valid.size()), node_.rows());
    for (std::size_t v = 0; v < dem_.valid.size(); ++v) {
      Eigen::VectorXd belief = node_.col(index(v));
      for (const std::size_t m : incoming_[v]) {
        belief.array() *= message_.col(index(m)).array();
        belief /= belief.maxCoeff();
      }
      out.row(index(v)) = (belief / belief.sum()).transpose();
    }
    return out;
  }

 private:
  double update(std::size_t m) {
    const DemEdge& edge = dem_.edges[m / 2];
    const std::size_t from = m % 2 == 0 ? edge.a : edge.b;
    cavity_ = node_.col(index(from));
    for (const std::size_t in : incoming_[from]) {
      if (in / 2 != m / 2) cavity_.array() *= message_.col(index(in)).array();
    }
    const double top = cavity_.maxCoeff();
    if (!(top > 0)) return 0;  // beyond the range of double: the old message stays
    cavity_ /= top;
    general_ ? pass_general(factors_[m / 2]) : pass_two_valued(factors_[m / 2]);
    fresh_ /= fresh_.sum();
    const double change = (fresh_ - message_.col(index(m))).cwiseAbs().maxCoeff();
    message_.col(index(m)) = fresh_;
    return change;
  }

  /// m(l) = sum or max over l' of psi(l', l) h(l').
  void pass_general(const EdgeFactor& factor) {
    for (Eigen::Index l = 0; l < cavity_.size(); ++l) {
      double value = 0;
      for (Eigen::Index k = 0; k < cavity_.size(); ++k) {
        const double term = (k == l ? factor.equal : factor.unequal) * cavity_[k];
        value = product_ == Product::sum ? value + term : std::max(value, term);
      }
      fresh_[l] = value;
    }
  }

  /// The same from the total: sum - h(l), or the largest of the others.
  void pass_two_valued(const EdgeFactor& factor) {
    if (product_ == Product::sum) {
      fresh_ = factor.unequal * cavity_.sum() + (factor.equal - factor.unequal) * cavity_.array();
      return;
    }
    Eigen::Index best = 0;
    const double first = cavity_.maxCoeff(&best);
    double second = 0;
    for (Eigen::Index k = 0; k < cavity_.size(); ++k) second = k == best ? second : std::max(second, cavity_[k]);
    for (Eigen::Index l = 0; l < cavity_.size(); ++l) {
      fresh_[l] = std::max(factor.equal * cavity_[l], factor.unequal * (l == best ? second : first));
    }
  }

  const Dem& dem_;
  const std::vector<EdgeFactor>& factors_;
  Product product_;
  bool general_;
  Eigen::MatrixXd node_;     ///< one column per cell
  Eigen::MatrixXd message_;  ///< one column per message
  std::vector<std::vector<std::size_t>> incoming_;
  Eigen::VectorXd cavity_, fresh_;
};

}  // namespace

std::vector<EdgeFactor> edge_factors(const Dem& dem, const Options& options) {
  std::vector<EdgeFactor> factors(dem.edges.size());
  for (std::size_t e = 0; e < factors.size(); ++e) {
    if (options.edge == EdgePotential::potts) {
      factors[e] = {1, std::exp(-options.potts)};
      continue;
    }
    const DemCell& a = dem.cell(dem.edges[e].a);
    const DemCell& b = dem.cell(dem.edges[e].b);
    const double q = 1 / (1 + std::exp(a.variance_m2() + b.variance_m2() - std::abs(a.height_m - b.height_m)));
    factors[e] = {1 - q, q};
  }
  return factors;
}

BeliefSummary propagate(const Dem& dem, const Eigen::MatrixXd& log_node, const std::vector<EdgeFactor>& factors,
                        Product product, Messages messages, Eigen::MatrixXd& belief) {
  Propagation propagation(dem, log_node, factors, product, messages);
  BeliefSummary summary;
  while (summary.sweeps < most_sweeps && !summary.converged) {
    summary.converged = propagation.sweep(summary.sweeps % 2 == 0) <= message_tolerance;
    ++summary.sweeps;
    summary.messages += static_cast<long>(2 * dem.edges.size());
  }
  belief = propagation.beliefs();
  return summary;
}

}  // namespace curbline::tools::reference
