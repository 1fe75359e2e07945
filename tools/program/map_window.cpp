#include "program/map_window.hpp"

#include <CLI/Error.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>

#include "curbline/map/dem.hpp"
#include "formats/decimals.hpp"
#include "streams/host_pipeline.hpp"

namespace curbline::tools {
namespace {

constexpr double count_slack = 1e-6;  ///< in cells

int cells_along(double length_m, double cell_m) {
  return static_cast<int>(std::ceil(length_m / cell_m - count_slack));
}

/// Sides of a cell along x and y as requested: the floats of the settings, in which 0.1 is not exactly 0.1, are too
/// coarse for counting.
struct CellSides {
  double x_m, y_m;
};

CellSides cell_sides(const MapOptions& options, const WindowSettings& window) {
  if (!options.cell.empty()) return {options.cell.front(), options.cell.back()};
  const auto micrometres = [](float side_m) { return std::round(static_cast<double>(side_m) * 1e6) / 1e6; };
  return {micrometres(window.cell_x_m), micrometres(window.cell_y_m)};
}

int whole_blocks(int cells) {
  return (cells + block_side - 1) / block_side * block_side;
}

}  // namespace

void apply_window(const MapOptions& options, WindowSettings& window) {
  if (!options.cell.empty()) {
    window.cell_x_m = static_cast<float>(options.cell.front());
    window.cell_y_m = static_cast<float>(options.cell.back());
  }
  if (options.max_height_m) window.max_height_m = static_cast<float>(*options.max_height_m);
  if (!options.fixed()) return;
  const CellSides side = cell_sides(options, window);
  const std::array sides{side.x_m, side.y_m};
  for (std::size_t axis = 0; axis < sides.size(); ++axis) {
    if (const double length_m = options.size[axis]; !(length_m > count_slack * sides[axis]))
      throw CLI::ValidationError("--size", shortest(length_m) + "; expected metres above 0, a cell or more");
  }
  const double longest = std::max(options.size[0] / side.x_m, options.size[1] / side.y_m);
  if (!(longest <= most_cells + count_slack)) {
    throw CLI::ValidationError("--size", "more than " + std::to_string(most_cells) +
                                             " cells along one side; expected larger cells or a smaller window");
  }
  window.fixed = true;
  window.origin_x_m = static_cast<float>(options.origin[0]);
  window.origin_y_m = static_cast<float>(options.origin[1]);
  window.rows = whole_blocks(cells_along(options.size[0], side.x_m));
  window.cols = whole_blocks(cells_along(options.size[1], side.y_m));
}

Grid asked_grid(const MapOptions& options, const WindowSettings& window) {
  const CellSides side = cell_sides(options, window);
  Grid grid{static_cast<double>(window.origin_x_m),
            static_cast<double>(window.origin_y_m),
            side.x_m,
            side.y_m,
            window.rows,
            window.cols};
  if (!options.fixed()) return grid;
  grid.x0_m = options.origin[0];
  grid.y0_m = options.origin[1];
  grid.rows = cells_along(options.size[0], grid.dx_m);
  grid.cols = cells_along(options.size[1], grid.dy_m);
  return grid;
}

Map crop(const Map& map, const Grid& asked) {
  const auto first_i = static_cast<int>(std::lround((asked.x0_m - map.grid.x0_m) / asked.dx_m));
  const auto first_j = static_cast<int>(std::lround((asked.y0_m - map.grid.y0_m) / asked.dy_m));
  Map out;
  out.grid = asked;
  out.cells.resize(asked.cells());
  std::set<int> labels;
  for (int i = std::max(0, -first_i); i < std::min(asked.rows, map.grid.rows - first_i); ++i) {
    for (int j = std::max(0, -first_j); j < std::min(asked.cols, map.grid.cols - first_j); ++j) {
      const MapCell& cell = map.cells[map.grid.at(first_i + i, first_j + j)];
      out.cells[asked.at(i, j)] = cell;
      labels.insert(cell.label);
      labels.insert(plane_label_of(cell));
    }
  }
  std::copy_if(map.planes.begin(), map.planes.end(), std::back_inserter(out.planes),
               [&](const MapPlane& plane) { return labels.contains(plane.label); });
  for (const MapCurb& curb : map.curbs) {
    const Share share = share_in(asked.bounds(), {curb.x0_m, curb.y0_m}, {curb.x1_m, curb.y1_m});
    if (share.any()) out.curbs.push_back(part_of(curb, share));
  }
  return out;
}

}  // namespace curbline::tools
