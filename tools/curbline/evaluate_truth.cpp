#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>

#include "curbline/evaluate.hpp"
#include "curbline/map_options.hpp"
#include "curbline/replay.hpp"
#include "evaluation/curbs.hpp"
#include "evaluation/labels.hpp"
#include "formats/csv.hpp"
#include "robot/robot.hpp"
#include "simulator/truth.hpp"

namespace curbline::tools {
namespace {

constexpr double tolerance_m = 0.1;  ///< one cell of the usual grid: a match
constexpr double found_share = 0.5;  ///< of a curb's visible length, for it to count as found

struct Result {
  std::vector<LabelledCell> cells;
  std::vector<MapCurb> curbs;
};

/// What replay left in the directory, or a replay of its logs.
Result load_or_replay(const std::string& dir) {
  if (std::filesystem::exists(dir + "/labels.csv") && std::filesystem::exists(dir + "/curbs.csv")) {
    return {read_labels(dir + "/labels.csv"), read_curbs(dir + "/curbs.csv")};
  }
  Robot robot = read_robot(dir + "/robot.toml");
  if (std::filesystem::exists(dir + "/poses.tum")) robot.pose.still = false;  // it drove, whatever its description says
  const ReplayLogs logs{dir + "/scans.carmen", robot.tilt.fixed ? "" : dir + "/can.log", robot.pose.still ? "" : dir + "/poses.tum"};
  Replay replay(robot, logs);
  while (replay.step()) {
  }
  replay.check_complete();
  Result result;
  const Map map = replay.pipeline().map();
  for (int i = 0; i < map.grid.rows; ++i) {
    for (int j = 0; j < map.grid.cols; ++j) {
      const MapCell& cell = map.cells[map.grid.at(i, j)];
      if (cell.points > 0) result.cells.push_back({map.grid.x_m(i), map.grid.y_m(j), cell});
    }
  }
  result.curbs = replay.all_curbs();
  return result;
}

/// Of a point, on a grid of the usual cells.
std::pair<int, int> cell_at(double x_m, double y_m) {
  return {static_cast<int>(std::floor(x_m / 0.1)), static_cast<int>(std::floor(y_m / 0.1))};
}

/// Where the robot saw the ground: within a cell of a valid one.
class Seen {
 public:
  explicit Seen(const std::vector<LabelledCell>& cells) {
    for (const LabelledCell& cell : cells) {
      for (int di = -1; di <= 1; ++di) {
        for (int dj = -1; dj <= 1; ++dj) cells_.insert(cell_at(cell.x_m + 0.1 * di, cell.y_m + 0.1 * dj));
      }
    }
  }
  bool operator()(double x_m, double y_m) const { return cells_.contains(cell_at(x_m, y_m)); }

 private:
  std::set<std::pair<int, int>> cells_;
};

/// V-measure of the labels against the connected parts of the true planes, as regions drawn by hand are: two pavements of one height
/// on either side of a road are two.
double v_of(const std::vector<LabelledCell>& cells, const Truth& truth) {
  struct Part {
    int plane, label, number;
  };
  std::map<std::pair<int, int>, Part> parts;
  for (const LabelledCell& cell : cells) {
    const int plane = truth.plane_at(cell.x_m, cell.y_m);
    if (plane >= 0 && !truth.obstacle_at(cell.x_m, cell.y_m)) parts[cell_at(cell.x_m, cell.y_m)] = {plane, cell.cell.label, -1};
  }
  int numbers = 0;
  for (auto& [start, part] : parts) {
    if (part.number >= 0) continue;
    part.number = numbers++;
    std::vector<std::pair<int, int>> open{start};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      for (const auto& next : {std::pair{i + 1, j}, std::pair{i - 1, j}, std::pair{i, j + 1}, std::pair{i, j - 1}}) {
        const auto found = parts.find(next);
        if (found == parts.end() || found->second.number >= 0 || found->second.plane != part.plane) continue;
        found->second.number = part.number;
        open.push_back(next);
      }
    }
  }
  std::vector<int> of_truth, label;
  for (const auto& [at, part] : parts) {
    of_truth.push_back(part.number);
    label.push_back(part.label);
  }
  return v_measure(of_truth, label);
}

/// Root mean square of cell heights about the true ground.
double height_rmse_m(const std::vector<LabelledCell>& cells, const Truth& truth) {
  double squares = 0;
  int n = 0;
  for (const LabelledCell& cell : cells) {
    const double z = truth.terrain_height(cell.x_m, cell.y_m);
    if (std::isnan(z) || truth.obstacle_at(cell.x_m, cell.y_m)) continue;
    squares += (cell.cell.height_m - z) * (cell.cell.height_m - z);
    ++n;
  }
  return n > 0 ? std::sqrt(squares / n) : std::nan("");
}

}  // namespace

nlohmann::json evaluate_truth(const std::string& dir, bool print) {
  const Truth truth = read_truth(dir);
  const Result result = load_or_replay(dir);
  const Seen seen(result.cells);

  std::vector<TrueCurb> curbs;
  std::vector<Segment> lines;
  for (const TruthCurb& c : truth.curbs) {
    const Segment line{c.from.x, c.from.y, c.to.x, c.to.y};
    lines.push_back(line);
    if (c.kind == "step") curbs.push_back({line, std::abs(c.from_step_m), std::abs(c.to_step_m)});
  }
  const std::vector<CurbMatch> matches = match_curbs(result.curbs, curbs, tolerance_m, std::ref(seen));
  const Rates rates = curb_rates(result.curbs, lines, tolerance_m, std::ref(seen));
  const ErrorSummary errors = curb_errors(result.curbs, curbs, tolerance_m, std::ref(seen));

  nlohmann::json out;
  int visible = 0, found = 0;
  if (print) std::printf("  true curb                              step     found       position error\n");
  for (std::size_t k = 0; k < curbs.size(); ++k) {
    if (matches[k].visible_m < 0.3) continue;  // a few cells of it: nothing to judge
    ++visible;
    const bool is_found = matches[k].covered >= found_share;
    found += is_found;
    const Segment& s = curbs[k].line;
    const double step = 0.5 * (curbs[k].step0_m + curbs[k].step1_m);
    if (print) {
      std::printf("  (%6.2f %6.2f) - (%6.2f %6.2f)  %6.1f cm ", s.x0_m, s.y0_m, s.x1_m, s.y1_m, 100 * step);
      is_found ? std::printf(" %6.1f cm  %6.1f cm   %3.0f %% of %.1f m\n", 100 * matches[k].height_m, 100 * matches[k].position_error_m,
                             100 * matches[k].covered, matches[k].visible_m)
               : std::printf("  missed\n");
    }
    out["curbs"].push_back({{"step_m", step}, {"found", is_found}, {"height_m", matches[k].height_m}, {"position_error_m", matches[k].position_error_m},
                            {"covered", matches[k].covered}});
  }
  const double v = v_of(result.cells, truth), rmse = height_rmse_m(result.cells, truth);
  out["curbs_visible"] = visible;
  out["curbs_found"] = found;
  out["position_error_median_m"] = errors.position_median_m;
  out["position_error_95_m"] = errors.position_95_m;
  out["height_error_median_m"] = errors.height_median_m;
  out["height_error_95_m"] = errors.height_95_m;
  out["precision"] = rates.precision;
  out["recall"] = rates.recall;
  out["f1"] = rates.f1;
  out["v"] = v;
  out["height_rmse_m"] = rmse;
  if (print) {
    std::printf("\ncurbs found           %d of %d\n", found, visible);
    std::printf("position error        median %.1f cm, 95 %% %.1f cm\n", 100 * errors.position_median_m, 100 * errors.position_95_m);
    std::printf("height error          median %.1f cm, 95 %% %.1f cm\n", 100 * errors.height_median_m, 100 * errors.height_95_m);
    std::printf("at %.2f m, creases too  precision %.3f  recall %.3f  F1 %.3f\n", tolerance_m, rates.precision, rates.recall, rates.f1);
    std::printf("V-measure of labels   %.3f\n", v);
    std::printf("cell heights          RMSE %.1f mm\n", 1000 * rmse);
  }
  return out;
}

}  // namespace curbline::tools
