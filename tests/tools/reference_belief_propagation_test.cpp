// The reference's belief propagation against enumeration of all labellings.
#include "reference/belief_propagation.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "reference_support.hpp"

namespace curbline::tools::reference::testing {
namespace {

Dem cells_at(const std::vector<std::pair<int, int>>& places) {
  std::vector<Point3> cloud;
  for (const auto& [i, j] : places) cloud.push_back({i + 0.5, j + 0.5, 0.1 * i});
  return make_dem(cloud, {0, 0, 1, 1, 3, 3}, 1e9);
}

/// A branch and a bend, no loop.
Dem tree() {
  return cells_at({{0, 0}, {1, 0}, {2, 0}, {1, 1}, {1, 2}});
}
Dem square() {
  return cells_at({{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, 2}, {2, 0}, {2, 1}, {2, 2}});
}

Eigen::MatrixXd random_nodes(const Dem& dem, int labels, double spread) {
  std::mt19937 random(5);
  Eigen::MatrixXd out(static_cast<Eigen::Index>(dem.valid.size()), labels);
  for (Eigen::Index v = 0; v < out.rows(); ++v) {
    for (Eigen::Index k = 0; k < labels; ++k) out(v, k) = spread * normal(random);
  }
  return out;
}

std::vector<EdgeFactor> uneven_factors(const Dem& dem) {
  std::vector<EdgeFactor> factors;
  for (std::size_t e = 0; e < dem.edges.size(); ++e) factors.push_back({2.0 + 0.3 * static_cast<double>(e), 0.7});
  return factors;
}

struct Enumeration {
  Eigen::MatrixXd marginal;
  std::vector<int> best;
};

/// All labellings, each with its weight.
Enumeration enumerate(const Dem& dem, const Eigen::MatrixXd& log_node, const std::vector<EdgeFactor>& factors) {
  Enumeration out{Eigen::MatrixXd::Zero(log_node.rows(), log_node.cols()), {}};
  const int labels = static_cast<int>(log_node.cols());
  std::vector<int> state(dem.valid.size(), 0);
  double best = -1;
  for (bool more = true; more;) {
    double weight = 1;
    for (std::size_t v = 0; v < state.size(); ++v) weight *= std::exp(log_node(static_cast<Eigen::Index>(v), state[v]));
    for (std::size_t e = 0; e < factors.size(); ++e) {
      weight *= state[dem.edges[e].a] == state[dem.edges[e].b] ? factors[e].equal : factors[e].unequal;
    }
    for (std::size_t v = 0; v < state.size(); ++v) out.marginal(static_cast<Eigen::Index>(v), state[v]) += weight;
    if (weight > best) {
      best = weight;
      out.best = state;
    }
    std::size_t v = 0;
    while (v < state.size() && ++state[v] == labels) state[v++] = 0;
    more = v < state.size();
  }
  out.marginal /= out.marginal.row(0).sum();
  return out;
}

std::vector<int> labels_of(const Eigen::MatrixXd& belief) {
  std::vector<int> out;
  for (Eigen::Index v = 0; v < belief.rows(); ++v) {
    Eigen::Index best = 0;
    belief.row(v).maxCoeff(&best);
    out.push_back(static_cast<int>(best));
  }
  return out;
}

TEST_CASE("reference beliefs: on a tree, sum-product gives the exact marginals") {
  const Dem dem = tree();
  const Eigen::MatrixXd nodes = random_nodes(dem, 3, 1.0);
  const auto factors = uneven_factors(dem);
  const Enumeration exact = enumerate(dem, nodes, factors);
  for (const Messages messages : {Messages::general, Messages::two_valued}) {
    Eigen::MatrixXd belief;
    const BeliefSummary summary = propagate(dem, nodes, factors, Product::sum, messages, belief);
    CHECK(summary.converged);
    CHECK((belief - exact.marginal).cwiseAbs().maxCoeff() < 1e-9);
  }
}

TEST_CASE("reference beliefs: on a tree, max-product gives the best labelling") {
  const Dem dem = tree();
  const Eigen::MatrixXd nodes = random_nodes(dem, 3, 1.0);
  const auto factors = uneven_factors(dem);
  const Enumeration exact = enumerate(dem, nodes, factors);
  REQUIRE(exact.best != labels_of(nodes));  // the neighbours matter
  for (const Messages messages : {Messages::general, Messages::two_valued}) {
    Eigen::MatrixXd belief;
    propagate(dem, nodes, factors, Product::max, messages, belief);
    CHECK(labels_of(belief) == exact.best);
  }
}

TEST_CASE("reference beliefs: on a grid with loops, marginals are near the exact ones and the labels are") {
  const Dem dem = square();
  const Eigen::MatrixXd nodes = random_nodes(dem, 3, 1.0);
  const std::vector<EdgeFactor> factors(dem.edges.size(), EdgeFactor{1, std::exp(-0.5)});
  const Enumeration exact = enumerate(dem, nodes, factors);
  Eigen::MatrixXd belief;
  CHECK(propagate(dem, nodes, factors, Product::sum, Messages::two_valued, belief).converged);
  CHECK((belief - exact.marginal).cwiseAbs().maxCoeff() < 0.02);
  propagate(dem, nodes, factors, Product::max, Messages::two_valued, belief);
  CHECK(labels_of(belief) == exact.best);
}

TEST_CASE("reference beliefs: a message from the total is the message from the K x K matrix") {
  const Dem dem = square();
  const Eigen::MatrixXd nodes = random_nodes(dem, 7, 3.0);
  auto factors = uneven_factors(dem);
  factors[2] = {0.4, 0.6};  // eq. (10) may favour unequal labels
  for (const Product product : {Product::sum, Product::max}) {
    Eigen::MatrixXd general, two_valued;
    const auto a = propagate(dem, nodes, factors, product, Messages::general, general);
    const auto b = propagate(dem, nodes, factors, product, Messages::two_valued, two_valued);
    CHECK((general - two_valued).cwiseAbs().maxCoeff() < 1e-12);
    CHECK(a.sweeps == b.sweeps);
  }
}

TEST_CASE("reference beliefs: equal factors for equal and unequal labels leave cells to themselves") {
  const Dem dem = square();
  const Eigen::MatrixXd nodes = random_nodes(dem, 4, 1.0);
  Eigen::MatrixXd belief;
  propagate(dem, nodes, std::vector<EdgeFactor>(dem.edges.size(), EdgeFactor{0.5, 0.5}), Product::sum,
            Messages::two_valued, belief);
  const Eigen::MatrixXd likelihood = nodes.array().exp();
  for (Eigen::Index v = 0; v < nodes.rows(); ++v) {
    CHECK((belief.row(v) - likelihood.row(v) / likelihood.row(v).sum()).cwiseAbs().maxCoeff() < 1e-12);
  }
}

TEST_CASE("reference beliefs: a cell that disagrees is outvoted by its neighbours") {
  const Dem dem = square();
  Eigen::MatrixXd nodes = Eigen::MatrixXd::Zero(9, 2);
  nodes.col(0).setConstant(3);
  nodes.row(4) << 0, 15;
  Eigen::MatrixXd belief;
  propagate(dem, nodes, edge_factors(dem, {}), Product::max, Messages::two_valued, belief);
  CHECK(labels_of(belief) == std::vector<int>(9, 0));
}

TEST_CASE("reference beliefs: potentials below what double holds leave beliefs finite and right") {
  const Dem dem = square();
  Eigen::MatrixXd nodes = Eigen::MatrixXd::Constant(9, 2, -5000);
  nodes.topLeftCorner(6, 1).setConstant(0);
  nodes.bottomRightCorner(3, 1).setConstant(-900);
  Eigen::MatrixXd belief;
  propagate(dem, nodes, edge_factors(dem, {}), Product::sum, Messages::two_valued, belief);
  REQUIRE(belief.allFinite());
  CHECK(labels_of(belief) == std::vector<int>{0, 0, 0, 0, 0, 0, 1, 1, 1});
}

TEST_CASE("reference beliefs: the count of sweeps and messages is what was done, within its bound") {
  const Dem dem = square();
  Eigen::MatrixXd belief;
  const auto summary =
      propagate(dem, random_nodes(dem, 3, 1.0), uneven_factors(dem), Product::sum, Messages::two_valued, belief);
  CHECK(summary.converged);
  CHECK(summary.sweeps > 2);
  CHECK(summary.sweeps <= most_sweeps);
  CHECK(summary.messages == summary.sweeps * 24L);
}

TEST_CASE("reference beliefs: the Potts factor is exp(10) for equal labels against 1") {
  for (const EdgeFactor& factor : edge_factors(tree(), {}))
    CHECK(factor.equal / factor.unequal == Approx(std::exp(10.0)));
}

TEST_CASE("reference beliefs: the factor of eq. (10) is that of the formula") {
  const Dem dem = row_of({0.0, 0.15});
  Options options;
  options.edge = EdgePotential::eq10;
  const double q = 1 / (1 + std::exp(2 * 3e-4 / 4 - 0.15));
  const auto factors = edge_factors(dem, options);
  REQUIRE(factors.size() == 1);
  CHECK(factors[0].equal == Approx(1 - q));
  CHECK(factors[0].unequal == Approx(q));
}

}  // namespace
}  // namespace curbline::tools::reference::testing
