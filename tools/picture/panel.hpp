// One panel of the picture: the grid to scale, its cells, axes, scale bar and the robot.
#pragma once

#include <functional>
#include <string>

#include "map/map.hpp"
#include "picture/drawing.hpp"
#include "picture/picture.hpp"

namespace curbline::tools::picture {

/// The position of the grid on the page: x ahead points up, y left points left.
struct View {
  double x0_m = 0, x1_m = 1, y0_m = 0, y1_m = 1;              ///< the window
  Box box{};                                                  ///< the same on the page
  double scale() const { return box.width / (y1_m - y0_m); }  ///< pixels a metre
  Pixel at(double x_m, double y_m) const {
    return {box.x + (y1_m - y_m) / (y1_m - y0_m) * box.width, box.y + (x1_m - x_m) / (x1_m - x0_m) * box.height};
  }
};

/// Space that the axis takes, pixels.
inline constexpr double title_room = 24, bottom_room = 66;
/// Space to the left and right of the grid, for the widest number.
double left_room(cairo_t* cr, const View& view);
double right_room(cairo_t* cr, const View& view);

/// Draws each cell that has points in its colour: as one image of the panel's pixels in both kinds of file, because
/// half a million cells are too many elements for an SVG.
void draw_cells(cairo_t* cr, const View& view, const Map& map, const std::function<Colour(const MapCell&)>& colour);
/// Frame, numbers, names, title and a scale bar of 1 m (another power of ten if 1 m is too long or too short to see).
void draw_axes(cairo_t* cr, const View& view, const std::string& title);

/// An arrow from the robot's position in the direction of its heading.
void draw_arrow(cairo_t* cr, Pixel at, double heading_rad);
/// Whether the marker lies in the window or on its edge; otherwise it is not drawn.
bool shows(const View& view, const RobotMarker& robot);

}  // namespace curbline::tools::picture
