#include "reference/reference.hpp"

#include <cmath>
#include <string>

#include "formats/bad_input.hpp"
#include "reference/belief_propagation.hpp"
#include "reference/border.hpp"
#include "reference/dem.hpp"
#include "reference/mixture.hpp"
#include "reference/segmentation.hpp"

namespace curbline::tools::reference {
namespace {

constexpr int most_em_steps = 100;
constexpr double em_tolerance = 1e-6;  ///< relative change of the log likelihood

struct Labelling {
  std::vector<int> label;
  std::vector<double> probability;
};

Labelling best_of(const Eigen::MatrixXd& belief) {
  Labelling out;
  for (Eigen::Index v = 0; v < belief.rows(); ++v) {
    Eigen::Index best = 0;
    out.probability.push_back(belief.row(v).maxCoeff(&best));
    out.label.push_back(static_cast<int>(best));
  }
  return out;
}

/// EM until the likelihood converges; each cell gets the label of its last E-step, or of max-product on the grid.
Labelling expectation_maximisation(const Dem& dem, const Options& options, std::vector<MixturePlane>& planes) {
  const std::vector<EdgeFactor> factors = edge_factors(dem, options);
  const bool on_grid = options.method == Method::crf_em;
  Responsibilities responsibility;
  Eigen::MatrixXd log_likelihood;
  double before = 0;
  for (int step = 0; step < most_em_steps; ++step) {
    log_likelihood = log_likelihoods(dem, planes);
    const double likelihood = independent_responsibilities(log_likelihood, responsibility);
    if (on_grid) propagate(dem, log_likelihood, factors, Product::sum, options.messages, responsibility);
    if (step > 0 && std::abs(likelihood - before) <= em_tolerance * std::abs(likelihood)) break;
    before = likelihood;
    maximise(dem, responsibility, planes);
  }
  if (!on_grid) return best_of(responsibility);
  Eigen::MatrixXd best;
  propagate(dem, log_likelihood, factors, Product::max, options.messages, best);
  Labelling out = best_of(best);
  for (std::size_t v = 0; v < out.label.size(); ++v)
    out.probability[v] = responsibility(static_cast<Eigen::Index>(v), out.label[v]);
  return out;
}

void check_room(std::size_t cells, std::size_t planes, Method method) {
  if (cells * planes <= most_cells_times_planes) return;
  throw BadInput(std::string("--method ") + (method == Method::em ? "em" : "crf-em") + ": " + std::to_string(cells) +
                 " cells and " + std::to_string(planes) + " planes; expected a product of at most " +
                 std::to_string(most_cells_times_planes) +
                 ": a smaller window, larger cells or a larger --segment-scale");
}

Map to_map(const Dem& dem, const Labelling& labelling, const std::vector<MixturePlane>& planes) {
  Map map;
  map.grid = dem.grid;
  map.cells.resize(dem.grid.cells());
  for (std::size_t v = 0; v < dem.valid.size(); ++v) {
    const DemCell& cell = dem.cell(v);
    const auto phi = dem.phi(v);
    map.cells[dem.valid[v]] = {
        dem.grid.x0_m + phi[1], dem.grid.y0_m + phi[2],  cell.height_m, cell.variance_m2(), cell.points,
        labelling.label[v],     labelling.probability[v]};
  }
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const Eigen::Vector3d& w = planes[k].w;
    map.planes.push_back({w[0] - w[1] * dem.grid.x0_m - w[2] * dem.grid.y0_m, w[1], w[2],
                          std::sqrt(planes[k].variance_m2), static_cast<int>(k)});
  }
  map.curbs = borders(map);
  return map;
}

}  // namespace

Map map_cloud(std::span<const Point3> cloud, const Grid& grid, const Options& options) {
  const Dem dem = make_dem(cloud, grid, options.max_height_m);
  const std::vector<int> component = segment(dem, options.segment_scale);
  std::vector<MixturePlane> planes = planes_of_components(dem, component);
  if (options.method == Method::segment || planes.empty()) {
    return to_map(dem, {component, std::vector<double>(component.size(), 1.0)}, planes);
  }
  check_room(dem.valid.size(), planes.size(), options.method);
  const Labelling labelling = expectation_maximisation(dem, options, planes);
  return to_map(dem, labelling, planes);
}

}  // namespace curbline::tools::reference
