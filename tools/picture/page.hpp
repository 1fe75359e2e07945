// The whole picture: where its parts lie on the page, and drawing them.
//
//   title
//          Height (m)              Planes and curbs
//   x (m)  +----------+  bar   x (m)  +----------+   legend
//          |          |               |          |
//          +----------+               +----------+
//             y (m)                      y (m)
//
// or, where the window is so wide that the cells are larger that way, with the panels one below the other.
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

/// The panels as large as a page of 1600 x 1000 lets them be, and the page no larger than they and the legend need.
Page lay_out(const Map& map, const PictureExtras& extras);

/// Returns the heights that it wrote beside the curbs.
std::vector<std::string> draw(cairo_t* cr, const Page& page, const Map& map, const PictureExtras& extras);

}  // namespace curbline::tools::picture
