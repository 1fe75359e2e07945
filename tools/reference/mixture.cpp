#include "reference/mixture.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace curbline::tools::reference {
namespace {

// The paper's code has no lower bound and fails on a plane through three cells; 0.1 mm changes nothing else.
constexpr double least_variance_m2 = 1e-8;

Eigen::Vector3d phi_of(const Dem& dem, std::size_t v) {
  const auto phi = dem.phi(v);
  return {phi[0], phi[1], phi[2]};
}

Eigen::Index index(std::size_t n) {
  return static_cast<Eigen::Index>(n);
}

/// Least squares over some cells, each with its weight. A plane that has almost no weight keeps its parameters.
template <typename Weight>
void fit(const Dem& dem, const std::vector<std::size_t>& cells, Weight weight, MixturePlane& plane) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const std::size_t v : cells) {
    const Eigen::Vector3d phi = phi_of(dem, v);
    A += weight(v) * phi * phi.transpose();
    b += weight(v) * dem.cell(v).height_m * phi;
  }
  const double count = A(0, 0);
  plane.weight = count / static_cast<double>(dem.valid.size());
  const Eigen::LDLT<Eigen::Matrix3d> solver(A);
  const Eigen::Vector3d pivots = solver.vectorD();
  if (count < 1e-3) return;
  if (pivots.minCoeff() > 1e-9 * pivots.maxCoeff()) {
    plane.w = solver.solve(b);
  } else {  // cells on one line determine no plane: use a level one at their mean height
    plane.w = {b[0] / count, 0, 0};
  }
  double squares = 0;
  for (const std::size_t v : cells) {
    const double residual = dem.cell(v).height_m - plane.w.dot(phi_of(dem, v));
    squares += weight(v) * residual * residual;
  }
  plane.variance_m2 = std::max(squares / count, least_variance_m2);
}

}  // namespace

std::vector<MixturePlane> planes_of_components(const Dem& dem, const std::vector<int>& component) {
  std::vector<std::vector<std::size_t>> cells;
  for (std::size_t v = 0; v < component.size(); ++v) {
    const auto c = static_cast<std::size_t>(component[v]);
    if (c >= cells.size()) cells.resize(c + 1);
    cells[c].push_back(v);
  }
  std::vector<MixturePlane> planes;
  for (std::size_t c = 0; c < cells.size() && cells[c].size() >= 3; ++c)
    fit(
        dem, cells[c], [](std::size_t) { return 1.0; }, planes.emplace_back());
  return planes;
}

Eigen::MatrixXd log_likelihoods(const Dem& dem, const std::vector<MixturePlane>& planes) {
  Eigen::MatrixXd out(index(dem.valid.size()), index(planes.size()));
  for (std::size_t v = 0; v < dem.valid.size(); ++v) {
    for (std::size_t k = 0; k < planes.size(); ++k) {
      const MixturePlane& plane = planes[k];
      const double residual = dem.cell(v).height_m - plane.w.dot(phi_of(dem, v));
      out(index(v), index(k)) = std::log(std::max(plane.weight, 1e-300)) -
                                0.5 * std::log(2 * std::numbers::pi * plane.variance_m2) -
                                0.5 * residual * residual / plane.variance_m2;
    }
  }
  return out;
}

double independent_responsibilities(const Eigen::MatrixXd& log_likelihood, Responsibilities& out) {
  const Eigen::VectorXd top = log_likelihood.rowwise().maxCoeff();
  out = (log_likelihood.colwise() - top).array().exp();
  const Eigen::VectorXd sum = out.rowwise().sum();
  out.array().colwise() /= sum.array();
  return (top.array() + sum.array().log()).sum();
}

void maximise(const Dem& dem, const Responsibilities& responsibility, std::vector<MixturePlane>& planes) {
  std::vector<std::size_t> all(dem.valid.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const Eigen::VectorXd r = responsibility.col(index(k));
    fit(
        dem, all, [&](std::size_t v) { return r[index(v)]; }, planes[k]);
  }
}

}  // namespace curbline::tools::reference
