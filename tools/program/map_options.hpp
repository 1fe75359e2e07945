// What map and replay have in common: the window, the method, and what is given out.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "curbline/settings.hpp"
#include "formats/bad_input.hpp"
#include "map/map.hpp"
#include "picture/picture.hpp"
#include "program/outputs.hpp"
#include "reference/reference.hpp"

namespace curbline::tools {

enum class MapMethod { curbline, crf_em, em, segment, canny, gradient };

struct MapOptions {
  std::vector<double> origin;  ///< x y, metres; empty: the window follows the robot
  std::vector<double> size;    ///< along x and y, metres
  std::vector<double> cell;    ///< one side or two, metres; empty: the robot's
  std::optional<double> max_height_m;
  MapMethod method = MapMethod::curbline;
  reference::EdgePotential edge = reference::EdgePotential::potts;
  double segment_scale = 100;
  std::string labels, curbs, picture;  ///< files; empty: none; curbs "-": JSON lines on stdout
  bool json = false;

  bool fixed() const { return !origin.empty(); }
};

/// --method alone; `method` stays as it is without it.
void add_method_option(CLI::App& command, MapMethod& method);

/// Adds the shared flags to a command.
void add_map_options(CLI::App& command, MapOptions& options);

/// What give_out() would write to files.
std::vector<NamedFile> outputs_of(const MapOptions& options);

/// Puts the window of the flags in place of the robot's: rows and columns are rounded up to whole blocks. Throws
/// CLI::ValidationError if it makes no sense.
void apply_window(const MapOptions& options, WindowSettings& window);

/// The grid that was asked for: the window of the flags exactly, without the rounding.
Grid asked_grid(const MapOptions& options, const WindowSettings& window);

/// The part of a map that lies in the grid asked for, which is within the map's, and what planes its cells bear.
Map crop(const Map& map, const Grid& asked);

/// Writes the files that were asked for, all or none, and the summary with --json. `summary` may hold more to say.
void give_out(const MapOptions& options, const Map& map, const PictureExtras& picture, nlohmann::json summary);

}  // namespace curbline::tools
