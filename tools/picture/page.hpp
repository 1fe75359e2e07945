// The whole picture: the layout of its parts on the page, and their drawing.
//
//   title
//          Height (m)              Planes and curbs
//   x (m)  +----------+  bar   x (m)  +----------+   legend
//          |          |               |          |
//          +----------+               +----------+
//             y (m)                      y (m)
//
// or, if the cells are then larger because the window is wide, with one panel below the other.
#pragma once

#include <string>
#include <vector>

#include "picture/legend.hpp"

namespace curbline::tools::picture {

struct Page {
  double width = 0, height = 0;  ///< whole pixels
  View heights, planes;
  Box bar, legend;
  Pixel title;
  HeightRange range;
};

/// The panels are as large as a page of 1600 x 1000 allows, and the page is no larger than they and the legend need.
Page lay_out(const Map& map, const PictureExtras& extras);

/// Returns the texts of the heights beside the curbs.
std::vector<std::string> draw(cairo_t* cr, const Page& page, const Map& map, const PictureExtras& extras);

}  // namespace curbline::tools::picture
