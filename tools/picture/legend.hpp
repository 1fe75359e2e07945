// The meaning of the picture's colours and lines: the bar of heights and the legend on the right.
#pragma once

#include <vector>

#include "picture/panel.hpp"

namespace curbline::tools::picture {

/// The heights that the colours cover.
struct HeightRange {
  double low_m = 0, high_m = 0;  ///< equal: no cell is valid
  double share(double height_m) const { return (height_m - low_m) / (high_m - low_m); }
};

/// From the 2nd to the 98th percentile, at least 2 cm, of cells within three standard deviations of their plane, or of
/// all cells if there are none: otherwise walls would use up the colours.
HeightRange height_range(const Map& map);

inline constexpr double colour_bar_width = 16;
/// The box is that of the colours; the numbers are to the right of it.
void draw_colour_bar(cairo_t* cr, const HeightRange& range, const Box& box);
/// Width of the numbers.
double colour_bar_room(cairo_t* cr, const HeightRange& range);

/// A plane with labelled cells.
struct PlaneCells {
  int label = 0, cells = 0;
};
/// The largest first, which is the order of their colours.
std::vector<PlaneCells> planes_by_size(const Map& map);

inline constexpr double legend_width = 190;
/// Height of the whole legend. In a smaller box, its last line summarises what does not fit.
double legend_height(const Map& map, const PictureExtras& extras);
void draw_legend(cairo_t* cr, const Map& map, const PictureExtras& extras, bool robot_shown, const Box& box);

}  // namespace curbline::tools::picture
