// A map as a picture: heights on the left, planes on the right, curbs with their heights on both. x ahead points up, y left points
// left, as the robot sees it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

struct PictureExtras {
  std::string title{};
  std::vector<MapCurb> truth{};  ///< drawn dashed beneath
};

/// PNG or SVG by the ending of `path`, about 1600 pixels wide. Written whole or not at all. Throws BadInput for another
/// ending or if it cannot be written.
void draw_picture(const Map& map, const std::string& path, const PictureExtras& extras = {});

}  // namespace curbline::tools
