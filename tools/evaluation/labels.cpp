#include "evaluation/labels.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace curbline::tools {
namespace {

template <typename Key>
double entropy(const std::map<Key, double>& count, double total) {
  double h = 0;
  for (const auto& [key, n] : count) h -= n / total * std::log(n / total);
  return h;
}

}  // namespace

double v_measure(std::span<const int> truth, std::span<const int> label) {
  if (truth.empty()) return 0;
  std::map<std::pair<int, int>, double> joint;
  std::map<int, double> of_truth, of_label;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    ++joint[{truth[n], label[n]}];
    ++of_truth[truth[n]];
    ++of_label[label[n]];
  }
  const auto total = static_cast<double>(truth.size());
  const double h_joint = entropy(joint, total), h_truth = entropy(of_truth, total), h_label = entropy(of_label, total);
  const double homogeneity = h_truth > 0 ? 1 - (h_joint - h_label) / h_truth : 1;
  const double completeness = h_label > 0 ? 1 - (h_joint - h_truth) / h_label : 1;
  return homogeneity + completeness > 0 ? 2 * homogeneity * completeness / (homogeneity + completeness) : 0;
}

std::vector<int> regions_of_cells(const Grid& grid, std::span<const Polygon> regions) {
  std::vector<int> out(grid.cells(), -1);
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) {
      for (std::size_t r = 0; r < regions.size() && out[grid.at(i, j)] < 0; ++r) {
        if (contains(regions[r], {grid.x_m(i), grid.y_m(j)})) out[grid.at(i, j)] = static_cast<int>(r);
      }
    }
  }
  return out;
}

double v_measure(const Map& map, std::span<const int> region_of_cell) {
  std::vector<int> truth, label;
  for (std::size_t c = 0; c < map.cells.size(); ++c) {
    if (map.cells[c].points == 0 || region_of_cell[c] < 0) continue;
    truth.push_back(region_of_cell[c]);
    label.push_back(map.cells[c].label);
  }
  return v_measure(truth, label);
}

double prediction_rmse(const Map& trained, const Map& other) {
  double squares = 0;
  int cells = 0;
  const Grid& grid = trained.grid;
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) {
      const MapCell& cell = trained.cells[grid.at(i, j)];
      const MapCell& seen = other.cells[grid.at(i, j)];
      const MapPlane* plane = cell.points > 0 && seen.points > 0 ? plane_of(trained, plane_label_of(cell)) : nullptr;
      if (plane == nullptr) continue;
      const double error = seen.height_m - plane->height_m(seen.x_m, seen.y_m);
      squares += error * error;
      ++cells;
    }
  }
  return cells > 0 ? std::sqrt(squares / cells) : std::numeric_limits<double>::quiet_NaN();
}

double height_rms(const Map& a, const Map& b) {
  double squares = 0;
  int cells = 0;
  for (std::size_t c = 0; c < a.cells.size(); ++c) {
    if (a.cells[c].points == 0 || b.cells[c].points == 0) continue;
    const double difference = a.cells[c].height_m - b.cells[c].height_m;
    squares += difference * difference;
    ++cells;
  }
  return cells > 0 ? std::sqrt(squares / cells) : 0;
}

}  // namespace curbline::tools
