#include "program/map_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <memory>
#include <set>

#include "curbline/dem.hpp"
#include "formats/atomic_file.hpp"
#include "formats/csv.hpp"
#include "formats/decimals.hpp"
#include "picture/picture.hpp"
#include "program/checks.hpp"
#include "program/host_pipeline.hpp"

namespace curbline::tools {
namespace {

constexpr double count_slack = 1e-6;  ///< of a cell

int cells_along(double length_m, double cell_m) {
  return static_cast<int>(std::ceil(length_m / cell_m - count_slack));
}
/// Sides of a cell along x and y as asked for: the settings' floats, of which 0.1 is not 0.1, are too coarse to count
/// by.
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

/// An option that is one of a few words.
template <typename Choice>
CLI::Option* add_choice(CLI::App& command, const std::string& option, Choice& choice,
                        const CLI::TransformPairs<Choice>& choices, const std::string& help) {
  const auto choose = [&choice, option, choices](const std::string& word) {
    std::string words;
    for (const auto& [name, value] : choices) {
      if (name == word) choice = value;
      words += (words.empty() ? "" : ", ") + name;
    }
    if (std::none_of(choices.begin(), choices.end(), [&](const auto& each) { return each.first == word; }))
      throw CLI::ValidationError(option, word + "; expected one of " + words);
  };
  return command.add_option_function<std::string>(option, choose, help);
}

/// For an option of one value or two, which would take the values of two such options for its own; CLI11 puts an empty
/// one between them where it is told to inject a separator.
CLI::Validator once() {
  return CLI::Validator(
      [](const std::string& text) { return text.empty() ? std::string("given twice, or empty; expected once") : ""; },
      "");
}

}  // namespace

void add_method_option(CLI::App& command, MapMethod& method) {
  add_choice<MapMethod>(
      command, "--method", method,
      {{"curbline", MapMethod::curbline},
       {"crf-em", MapMethod::crf_em},
       {"em", MapMethod::em},
       {"segment", MapMethod::segment},
       {"canny", MapMethod::canny},
       {"gradient", MapMethod::gradient}},
      "curbline (default); the paper's steps: crf-em, em, segment; its peers, curbs alone: canny, gradient");
}

void add_map_options(CLI::App& command, MapOptions& options) {
  const CLI::Validator place = within(-1e9, 1e9, "metres in [-1e9, 1e9]");
  // Extra arguments, which a list of numbers has unless told not to, would be what follows: the cloud.
  auto* origin =
      command
          .add_option(
              "--origin", options.origin,
              "lowest corner X Y of a fixed window, metres; without it replay has the robot's window, map 40 x 40 "
              "cells from 0 -2")
          ->expected(2)
          ->allow_extra_args(false)
          ->check(place);
  auto* size = command.add_option("--size", options.size, "length of the window along x and along y, metres")
                   ->expected(2)
                   ->allow_extra_args(false);
  origin->needs(size);
  size->needs(origin);
  command.add_option("--cell", options.cell, "side of a cell, or both sides, metres; default: 0.1, or the robot's")
      ->expected(1, 2)
      ->allow_extra_args(false)
      ->check(once())
      ->check(within(0.001, 10, "metres in [0.001, 10]; a cloud comes before --cell, or last"))
      ->inject_separator();
  command
      .add_option("--max-height", options.max_height_m,
                  "points above are ignored, metres; default: none, or the robot's")
      ->check(place);
  add_method_option(command, options.method);
  auto* edge = add_choice<reference::EdgePotential>(
      command, "--edge", options.edge,
      {{"potts", reference::EdgePotential::potts}, {"eq10", reference::EdgePotential::eq10}},
      "edge potential of crf-em: potts (default, factor 10) or eq10");
  auto* scale =
      command
          .add_option("--segment-scale", options.segment_scale, "s of the graph segmentation in crf-em, em and segment")
          ->check(
              within(std::numeric_limits<double>::min(), std::numeric_limits<double>::max(), "a finite number above 0"))
          ->capture_default_str();
  command.add_option("--labels", options.labels, "file to write: CSV, the window's valid cells")->check(file_name());
  command
      .add_option("--curbs", options.curbs,
                  "file to write: CSV, the curbs; -: JSON lines on stdout, from replay as they are found")
      ->check(file_name());
  command.add_option("--picture", options.picture, "file to write: PNG or SVG, by its ending")->check(file_name());
  command.add_flag("--json", options.json, "summary on stdout, a JSON object");
  // What the method would not heed must not look as if it did.
  command.parse_complete_callback([&options, edge, scale] {
    using enum MapMethod;
    const MapMethod method = options.method;
    if (edge->count() > 0 && method != crf_em)
      throw CLI::ValidationError("--edge", "of another method; expected --method crf-em");
    if (scale->count() > 0 && method != crf_em && method != em && method != segment)
      throw CLI::ValidationError("--segment-scale", "of another method; expected --method crf-em, em or segment");
  });
}

std::vector<NamedFile> outputs_of(const MapOptions& options) {
  std::vector<NamedFile> files{{"--labels", options.labels}, {"--picture", options.picture}};
  if (options.curbs != "-") files.push_back({"--curbs", options.curbs});
  return files;
}

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
    throw CLI::ValidationError("--size",
                               "more than 512 cells along one side; expected larger cells or a smaller window");
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
  const auto first_i = std::lround((asked.x0_m - map.grid.x0_m) / asked.dx_m);
  const auto first_j = std::lround((asked.y0_m - map.grid.y0_m) / asked.dy_m);
  Map out;
  out.grid = asked;
  out.cells.resize(asked.cells());
  std::set<int> borne;
  for (int i = 0; i < asked.rows; ++i) {
    for (int j = 0; j < asked.cols; ++j) {
      const MapCell& cell = map.cells[map.grid.at(static_cast<int>(first_i) + i, static_cast<int>(first_j) + j)];
      out.cells[asked.at(i, j)] = cell;
      borne.insert(cell.label);
    }
  }
  std::copy_if(map.planes.begin(), map.planes.end(), std::back_inserter(out.planes),
               [&](const MapPlane& plane) { return borne.contains(plane.label); });
  for (const MapCurb& curb : map.curbs) {
    const Share share = share_in(asked.bounds(), {curb.x0_m, curb.y0_m}, {curb.x1_m, curb.y1_m});
    if (share.any()) out.curbs.push_back(part_of(curb, share));
  }
  return out;
}

void give_out(const MapOptions& options, const Map& map, const PictureExtras& picture, nlohmann::json summary) {
  // Everything is written beside its target first and takes its place only when all of it could be written.
  std::unique_ptr<AtomicFile> labels, curbs;
  if (!options.labels.empty()) {
    labels = std::make_unique<AtomicFile>(options.labels);
    write_labels(labels->stream(), map);
  }
  if (!options.curbs.empty() && options.curbs != "-") {
    curbs = std::make_unique<AtomicFile>(options.curbs);
    write_curbs(curbs->stream(), map.curbs);
  }
  if (labels) labels->flush();
  if (curbs) curbs->flush();
  if (!options.picture.empty()) draw_picture(map, options.picture, picture);
  if (labels) labels->commit();
  if (curbs) curbs->commit();
  if (options.curbs == "-") {
    for (const MapCurb& curb : map.curbs) write_curb_json(std::cout, curb);
  }
  if (options.json) {
    summary["cells"] =
        std::count_if(map.cells.begin(), map.cells.end(), [](const MapCell& cell) { return cell.points > 0; });
    summary["planes"] = map.planes.size();
    summary["curbs"] = map.curbs.size();
    std::cout << summary.dump() << '\n';
  }
}

}  // namespace curbline::tools
