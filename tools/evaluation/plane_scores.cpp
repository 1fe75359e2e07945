#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "evaluation/labels.hpp"
#include "evaluation/scores.hpp"
#include "formats/bad_input.hpp"
#include "map/median.hpp"

namespace curbline::tools {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t least_cells = 8;   ///< minimum for a plane whose slope is compared
constexpr int places_along = 3;          ///< in a cell, each way: ground a third as wide parts what is beside it
constexpr double most_places = 1 << 24;  ///< seen or not: as many as 7 of the largest windows have

using Cells = std::vector<const LabelledCell*>;

/// The positions of cells along one axis: the file of labels does not state their spacing.
struct Axis {
  double low_m = 0, pitch_m = 1;
  double count = 1;
};

Axis axis_of(const std::vector<LabelledCell>& cells, double LabelledCell::*axis) {
  std::vector<double> at;
  for (const LabelledCell& cell : cells) at.push_back(cell.*axis);
  std::sort(at.begin(), at.end());
  double closest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (at[i] - at[i - 1] > 1e-4) closest_m = std::min(closest_m, at[i] - at[i - 1]);
  }
  const double whole_m = at.back() - at.front(), steps = std::round(whole_m / closest_m);
  return {at.front(), steps > 0 ? whole_m / steps : 1, steps + 1};
}

/// The line of labels.csv, below its header, that is farthest from the median of the rows.
long line_far_off(const std::vector<LabelledCell>& cells, double LabelledCell::*axis) {
  std::vector<double> at;
  for (const LabelledCell& cell : cells) at.push_back(cell.*axis);
  const double middle = median(std::move(at));
  const auto nearer = [&](const LabelledCell& a, const LabelledCell& b) {
    return std::abs(a.*axis - middle) < std::abs(b.*axis - middle);
  };
  return std::max_element(cells.begin(), cells.end(), nearer) - cells.begin() + 2;
}

/// The places from the lowest to the highest cell; the middle of each cell is that of a place.
Grid places_of(const std::vector<LabelledCell>& cells, const std::string& file) {
  const Axis x = axis_of(cells, &LabelledCell::x_m), y = axis_of(cells, &LabelledCell::y_m);
  if (x.count * y.count * (places_along * places_along) > most_places) {
    const bool along_x = x.count > y.count;
    throw BadInput(file, line_far_off(cells, along_x ? &LabelledCell::x_m : &LabelledCell::y_m),
                   std::string(along_x ? "x_m" : "y_m") +
                       " lies too far from that of the other rows; expected rows of one window");
  }
  return {x.low_m - x.pitch_m / 2,
          y.low_m - y.pitch_m / 2,
          x.pitch_m / places_along,
          y.pitch_m / places_along,
          static_cast<int>(x.count) * places_along,
          static_cast<int>(y.count) * places_along};
}

std::size_t place_of(const LabelledCell& cell, const Grid& grid) {
  return grid.at(static_cast<int>((cell.x_m - grid.x0_m) / grid.dx_m),
                 static_cast<int>((cell.y_m - grid.y0_m) / grid.dy_m));
}

/// Numbers all places that are connected with place (i, j) and belong to its plane.
void flood(const Grid& grid, const std::vector<int>& planes, int i, int j, int number, std::vector<int>& parts) {
  std::vector<std::pair<int, int>> open{{i, j}};
  const int plane = planes[grid.at(i, j)];
  while (!open.empty()) {
    const auto [row, col] = open.back();
    open.pop_back();
    if (row < 0 || row >= grid.rows || col < 0 || col >= grid.cols) continue;
    const std::size_t at = grid.at(row, col);
    if (planes[at] != plane || parts[at] >= 0) continue;
    parts[at] = number;
    open.insert(open.end(), {{row + 1, col}, {row - 1, col}, {row, col + 1}, {row, col - 1}});
  }
}

/// The connected parts of the true planes, numbered from 0; -1 in the void.
std::vector<int> parts_of(const Grid& grid, const Truth& truth) {
  std::vector<int> planes, parts(grid.cells(), -1);
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) planes.push_back(truth.plane_at(grid.x_m(i), grid.y_m(j)));
  }
  int numbers = 0;
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) {
      if (planes[grid.at(i, j)] >= 0 && parts[grid.at(i, j)] < 0) flood(grid, planes, i, j, numbers++, parts);
    }
  }
  return parts;
}

/// NaN if there is nothing to measure.
struct VMeasures {
  double ground = nan, readings = nan;
};

/// Compared with the connected parts of the true planes, like regions drawn by hand: two pavements of one height on
/// either side of a road are two parts. What hides the ground, a shadow or an object on it, does not separate parts.
VMeasures v_of(const std::vector<LabelledCell>& cells, const Truth& truth, const std::string& file) {
  if (cells.empty()) return {};
  const Grid grid = places_of(cells, file);
  const std::vector<int> parts = parts_of(grid, truth);
  std::vector<int> of_truth, ground, readings;
  std::map<int, std::size_t> cells_of;
  for (const LabelledCell& cell : cells) {
    const int part = parts[place_of(cell, grid)];
    if (part < 0 || truth.obstacle_at(cell.x_m, cell.y_m)) continue;
    of_truth.push_back(part);
    ground.push_back(ground_of(cell.cell));
    readings.push_back(cell.cell.label);
    ++cells_of[part];
  }
  const auto large = [&](const auto& part) {
    return static_cast<double>(part.second) >= 0.05 * static_cast<double>(of_truth.size());
  };
  const bool labelled = std::any_of(readings.begin(), readings.end(), [](int l) { return l >= 0; });
  const bool parted = std::count_if(cells_of.begin(), cells_of.end(), large) >= 2;
  if (!labelled || !parted) return {};
  return {v_measure(of_truth, ground), v_measure(of_truth, readings)};
}

bool on_ground(const LabelledCell& cell, const Truth& truth) {
  return truth.plane_at(cell.x_m, cell.y_m) >= 0 && !truth.obstacle_at(cell.x_m, cell.y_m);
}

int plane_of_most(const Cells& cells, const Truth& truth) {
  std::map<int, int> count;
  for (const LabelledCell* cell : cells) ++count[truth.plane_at(cell->x_m, cell->y_m)];
  return std::max_element(count.begin(), count.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
}

/// A plane, parametrised about the centroid of its cells.
struct Fit {
  double x_m = 0, y_m = 0, z_m = 0, sx = 0, sy = 0;
  double height_m(Point2 p) const { return z_m + sx * (p.x - x_m) + sy * (p.y - y_m); }
  double off_m(const LabelledCell& c) const { return std::abs(c.cell.height_m - height_m({c.x_m, c.y_m})); }
};

Fit least_squares(const Cells& cells) {
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

/// Fits the cells within three standard deviations, estimated by the median, of the plane: a cell crossed by a step has
/// the label of one side but contains both. At least half of the cells remain. Ends when the number of cells no longer
/// changes, or after ten passes.
Fit fit(const Cells& cells) {
  Fit out = least_squares(cells);
  Cells near = cells;
  std::size_t before = 0;
  for (int pass = 0; pass < 10 && near.size() != before; ++pass) {
    std::vector<double> off_m;
    for (const LabelledCell* c : cells) off_m.push_back(out.off_m(*c));
    const double most_m = 3 * 1.4826 * errors_of(off_m).median;
    before = near.size();
    near.clear();
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(near),
                 [&](const LabelledCell* c) { return out.off_m(*c) <= most_m; });
    out = least_squares(near);
  }
  return out;
}

/// At the centroid of the fit.
double angle_rad(const Fit& a, const SurfacePlane& b) {
  const Point2 slope = b.slope({a.x_m, a.y_m});
  const Eigen::Vector3d n(-a.sx, -a.sy, 1), m(-slope.x, -slope.y, 1);
  return std::atan2(n.cross(m).norm(), n.dot(m));
}

double mean(const std::vector<double>& values) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return values.empty() ? nan : sum / static_cast<double>(values.size());
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
  std::vector<double> of_ground, of_readings, height, slope;
  for (const std::vector<LabelledCell>& window : found.windows) {
    if (const VMeasures v = v_of(window, truth, found.labels_file); !std::isnan(v.ground)) {
      of_ground.push_back(v.ground);
      of_readings.push_back(v.readings);
    }
    std::map<int, Cells> of_label;
    for (const LabelledCell& cell : window) {
      if (!on_ground(cell, truth)) continue;
      of_cells.add(cell.cell.height_m - truth.terrain_height(cell.x_m, cell.y_m));
      if (cell.cell.label >= 0) of_label[plane_label_of(cell.cell)].push_back(&cell);
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
  out.v = mean(of_ground);
  out.v_readings = mean(of_readings);
  out.cell_rmse_m = of_cells.root();
  out.plane_rmse_m = of_planes.root();
  out.height_m = errors_of(height);
  out.slope_rad = errors_of(slope);
  return out;
}

nlohmann::json to_json(const PlaneScores& s) {
  return {{"v", s.v},
          {"v_readings", s.v_readings},
          {"height_rmse_m", s.cell_rmse_m},
          {"plane_rmse_m", s.plane_rmse_m},
          {"plane_height_error_median_m", s.height_m.median},
          {"plane_height_error_95_m", s.height_m.most},
          {"plane_slope_error_median_rad", s.slope_rad.median},
          {"plane_slope_error_95_rad", s.slope_rad.most}};
}

}  // namespace curbline::tools
