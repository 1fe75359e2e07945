#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "evaluation/labels.hpp"
#include "evaluation/scores.hpp"

namespace curbline::tools {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t least_cells = 8;  ///< of a plane whose slope is worth comparing

using Cells = std::vector<const LabelledCell*>;

/// The distance between neighbours along one axis: the file of labels does not say it.
double pitch_m(const std::vector<LabelledCell>& cells, double LabelledCell::*axis) {
  std::vector<double> at;
  for (const LabelledCell& cell : cells) at.push_back(cell.*axis);
  std::sort(at.begin(), at.end());
  double pitch = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (at[i] - at[i - 1] > 1e-4) pitch = std::min(pitch, at[i] - at[i - 1]);
  }
  return std::isfinite(pitch) ? pitch : 1;
}

struct Part {
  int plane, label, number;
};
using Parts = std::map<std::pair<long, long>, Part>;

void flood(Parts& parts, const Parts::iterator start, int number) {
  std::vector<Parts::iterator> open{start};
  start->second.number = number;
  while (!open.empty()) {
    const auto from = open.back();
    open.pop_back();
    const auto [i, j] = from->first;
    for (const auto& next : {std::pair{i + 1, j}, std::pair{i - 1, j}, std::pair{i, j + 1}, std::pair{i, j - 1}}) {
      const auto found = parts.find(next);
      if (found == parts.end() || found->second.number >= 0 || found->second.plane != from->second.plane) continue;
      found->second.number = number;
      open.push_back(found);
    }
  }
}

/// Against the connected parts of the true planes, as regions drawn by hand are: two pavements of one height on either
/// side of a road are two.
double v_of(const std::vector<LabelledCell>& cells, const Truth& truth) {
  const double dx = pitch_m(cells, &LabelledCell::x_m), dy = pitch_m(cells, &LabelledCell::y_m);
  Parts parts;
  for (const LabelledCell& cell : cells) {
    const int plane = truth.plane_at(cell.x_m, cell.y_m);
    if (plane < 0 || truth.obstacle_at(cell.x_m, cell.y_m)) continue;
    parts[{std::lround(cell.x_m / dx - 0.5), std::lround(cell.y_m / dy - 0.5)}] = {plane, cell.cell.label, -1};
  }
  int numbers = 0;
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    if (part->second.number < 0) flood(parts, part, numbers++);
  }
  std::vector<int> of_truth, label;
  std::vector<std::size_t> cells_of(static_cast<std::size_t>(numbers));
  for (const auto& [at, part] : parts) {
    of_truth.push_back(part.number);
    ++cells_of[static_cast<std::size_t>(part.number)];
    label.push_back(part.label);
  }
  const auto large = [&](std::size_t n) { return static_cast<double>(n) >= 0.05 * static_cast<double>(parts.size()); };
  const bool labelled = std::any_of(label.begin(), label.end(), [](int l) { return l >= 0; });
  const bool parted = std::count_if(cells_of.begin(), cells_of.end(), large) >= 2;
  return labelled && parted ? v_measure(of_truth, label) : nan;
}

bool on_ground(const LabelledCell& cell, const Truth& truth) {
  return truth.plane_at(cell.x_m, cell.y_m) >= 0 && !truth.obstacle_at(cell.x_m, cell.y_m);
}

int plane_of_most(const Cells& cells, const Truth& truth) {
  std::map<int, int> count;
  for (const LabelledCell* cell : cells) ++count[truth.plane_at(cell->x_m, cell->y_m)];
  return std::max_element(count.begin(), count.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
}

/// Least squares, about the middle of the cells.
struct Fit {
  double x_m = 0, y_m = 0, z_m = 0, sx = 0, sy = 0;
  double height_m(Point2 p) const { return z_m + sx * (p.x - x_m) + sy * (p.y - y_m); }
};

Fit fit(const Cells& cells) {
  Fit out;
  const auto n = static_cast<double>(cells.size());
  for (const LabelledCell* c : cells) {
    out.x_m += c->x_m / n;
    out.y_m += c->y_m / n;
    out.z_m += c->cell.height_m / n;
  }
  Eigen::Matrix2d scatter = 1e-9 * Eigen::Matrix2d::Identity();
  Eigen::Vector2d with_height = Eigen::Vector2d::Zero();
  for (const LabelledCell* c : cells) {
    const Eigen::Vector2d p(c->x_m - out.x_m, c->y_m - out.y_m);
    scatter += p * p.transpose();
    with_height += p * (c->cell.height_m - out.z_m);
  }
  const Eigen::Vector2d slope = scatter.ldlt().solve(with_height);
  out.sx = slope.x();
  out.sy = slope.y();
  return out;
}

double angle_rad(const Fit& a, const SurfacePlane& b) {
  const Eigen::Vector3d n(-a.sx, -a.sy, 1), m(-b.sx, -b.sy, 1);
  return std::atan2(n.cross(m).norm(), n.dot(m));
}

struct SquareMean {
  double sum = 0;
  int n = 0;
  void add(double error) { sum += error * error, ++n; }
  double root() const { return n > 0 ? std::sqrt(sum / n) : nan; }
};

}  // namespace

PlaneScores score_planes(const Found& found, const Truth& truth) {
  PlaneScores out;
  SquareMean of_cells, of_planes;
  std::vector<double> of_windows, height, slope;
  for (const std::vector<LabelledCell>& window : found.windows) {
    if (const double v = v_of(window, truth); !std::isnan(v)) of_windows.push_back(v);
    std::map<int, Cells> of_label;
    for (const LabelledCell& cell : window) {
      if (!on_ground(cell, truth)) continue;
      of_cells.add(cell.cell.height_m - truth.terrain_height(cell.x_m, cell.y_m));
      if (cell.cell.label >= 0) of_label[cell.cell.label].push_back(&cell);
    }
    for (const auto& [label, cells] : of_label) {
      if (cells.size() < least_cells) continue;
      const Fit plane = fit(cells);
      for (const LabelledCell* c : cells) {
        of_planes.add(plane.height_m({c->x_m, c->y_m}) - truth.terrain_height(c->x_m, c->y_m));
      }
      const SurfacePlane& of_truth = truth.planes[static_cast<std::size_t>(plane_of_most(cells, truth))].plane;
      height.push_back(std::abs(plane.z_m - of_truth.height_m({plane.x_m, plane.y_m})));
      slope.push_back(angle_rad(plane, of_truth));
    }
  }
  const double v_sum = std::accumulate(of_windows.begin(), of_windows.end(), 0.0);
  out.v = of_windows.empty() ? nan : v_sum / static_cast<double>(of_windows.size());
  out.cell_rmse_m = of_cells.root();
  out.plane_rmse_m = of_planes.root();
  out.height_m = errors_of(height);
  out.slope_rad = errors_of(slope);
  return out;
}

nlohmann::json to_json(const PlaneScores& s) {
  return {{"v", s.v},
          {"height_rmse_m", s.cell_rmse_m},
          {"plane_rmse_m", s.plane_rmse_m},
          {"plane_height_error_median_m", s.height_m.median},
          {"plane_height_error_95_m", s.height_m.most},
          {"plane_slope_error_median_rad", s.slope_rad.median},
          {"plane_slope_error_95_rad", s.slope_rad.most}};
}

}  // namespace curbline::tools
