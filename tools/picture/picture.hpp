// Draws a map: heights on the left, planes on the right, curbs with their heights on both. x ahead points up, y left
// points left, as the robot sees it. This is the last step for a map; a window of 512 x 512 cells takes well under a
// second. page.hpp shows the layout.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

class AtomicFile;

struct PictureExtras {
  std::string title{};           ///< UTF-8
  std::vector<MapCurb> truth{};  ///< drawn dashed below the curbs
  std::optional<RobotMarker> robot{};
};

/// PNG or SVG by the ending of `path`, in lower or upper case, as large as the window requires and at most 1600 x 1000
/// pixels. The SVG's <desc> contains the texts of the curbs, so that they can be searched for. The same map gives the
/// same bytes on one machine; other machines may have other fonts. Written completely or not at all. Throws BadInput
/// for another ending, or if it cannot be written.
void draw_picture(const Map& map, const std::string& path, const PictureExtras& extras = {});

/// The same into a file that is open, which the caller commits.
void draw_picture(const Map& map, AtomicFile& file, const PictureExtras& extras);

/// Throws BadInput for another ending.
void check_picture_name(const std::string& path);

}  // namespace curbline::tools
