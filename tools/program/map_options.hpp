// The options of map and replay: the window, the method, and the outputs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reference/reference.hpp"

namespace curbline::tools {

enum class MapMethod { curbline, crf_em, em, segment, canny, gradient };

struct MapOptions {
  std::vector<double> origin;  ///< x y, metres; empty: the window follows the robot
  std::vector<double> size;    ///< along x and y, metres
  std::vector<double> cell;    ///< one or two sides, metres; empty: the robot's
  std::optional<double> max_height_m;
  MapMethod method = MapMethod::curbline;
  reference::EdgePotential edge = reference::EdgePotential::potts;
  double segment_scale = 100;
  std::string labels, curbs, picture;  ///< files; empty: none; curbs "-": JSON lines on stdout
  bool json = false;

  bool fixed() const { return !origin.empty(); }
};

}  // namespace curbline::tools
