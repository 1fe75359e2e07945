// One panel of the picture: the grid to scale, its cells, axes, scale bar and the robot.
#pragma once

#include <functional>
#include <string>

#include "map/map.hpp"
#include "picture/drawing.hpp"
#include "picture/picture.hpp"

namespace curbline::tools::picture {

/// Where the grid lies on the page: x ahead up, y left to the left.
struct View {
  double x0_m = 0, x1_m = 1, y0_m = 0, y1_m = 1;              ///< the window
  Box box{};                                                  ///< the same on the page
  double scale() const { return box.width / (y1_m - y0_m); }  ///< pixels a metre
  Pixel at(double x_m, double y_m) const {
    return {box.x + (y1_m - y_m) / (y1_m - y0_m) * box.width, box.y + (x1_m - x_m) / (x1_m - x0_m) * box.height};
  }
};

/// The rooms that an axis takes, pixels.
inline constexpr double title_room = 24, bottom_room = 66;
/// Left and right of the grid: as wide as the longest number asks for.
double left_room(cairo_t* cr, const View& view);
double right_room(cairo_t* cr, const View& view);

/// Each cell that has points in its colour: one picture of the panel's pixels in either kind of file, since half a
/// million cells are too many lines for an SVG.
void draw_cells(cairo_t* cr, const View& view, const Map& map, const std::function<Colour(const MapCell&)>& colour);
/// Frame, numbers, names, title and the bar of 1 m (of a power of ten where 1 m is too long or too short to see).
void draw_axes(cairo_t* cr, const View& view, const std::string& title);

/// An arrow from where the robot is to where it heads.
void draw_arrow(cairo_t* cr, Pixel at, double heading_rad);
/// Whether the marker lies in the window or on its edge: else it is not drawn.
bool shows(const View& view, const RobotMarker& robot);

}  // namespace curbline::tools::picture
