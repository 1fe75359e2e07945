// One panel of the picture: the grid to scale with its axes, and what is drawn on it.
#pragma once

#include <cairo.h>

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "map/map.hpp"
#include "picture/colours.hpp"

namespace curbline::tools {

struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};

class Panel {
 public:
  /// Puts the grid into the box, as large as it fits, with room for the axes.
  Panel(cairo_t* cr, const Grid& grid, const Box& box);

  /// Fills each cell for which there is a colour; the ground beneath is light grey.
  void cells(const std::function<std::optional<Colour>(int i, int j)>& colour);
  void axes(const char* title);
  void curbs(std::span<const MapCurb> curbs);
  void truth(std::span<const MapCurb> curbs);
  /// Heights in cm beside the curbs, the longest first; what would cover another text is left out.
  void heights(std::span<const MapCurb> curbs);

  const Box& drawn() const { return drawn_; }

 private:
  double px(double y_m) const { return drawn_.x + (grid_.y0_m + grid_.cols * grid_.dy_m - y_m) * scale_; }
  double py(double x_m) const { return drawn_.y + (grid_.x0_m + grid_.rows * grid_.dx_m - x_m) * scale_; }
  void line(const MapCurb& curb);

  cairo_t* cr_;
  const Grid& grid_;
  Box drawn_;
  double scale_ = 1;  ///< pixels a metre
};

/// Line width and dash of a kind of curb; the legend uses it too.
void set_curb_style(cairo_t* cr, const std::string& kind);

void set_colour(cairo_t* cr, const Colour& colour);
/// align: 0 left, 0.5 centred, 1 right of x; y is the base line.
void text(cairo_t* cr, const std::string& words, double x, double y, double align = 0);
void set_font(cairo_t* cr, double size, bool bold = false);

}  // namespace curbline::tools
