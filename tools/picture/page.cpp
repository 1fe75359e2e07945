#include "picture/page.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "picture/curb_lines.hpp"
#include "picture/texts.hpp"

namespace curbline::tools::picture {
namespace {

constexpr double max_width = 1600, max_height = 1000;
constexpr double margin = 16, page_title_room = 30, bar_gap = 14, column_gap = 26;
constexpr double least_column = 150;  ///< width of a panel with its title
constexpr double least_height = 200;  ///< of the panels and what is below them
constexpr double least_bar = 150, most_bar = 480;
constexpr double most_for_legend = 480;  ///< up to this height, the legend makes a page higher than its panels

/// Not yet placed on the page. A map without cells shows one square metre.
View window_of(const Grid& grid) {
  if (grid.cells() == 0) return {};
  return {grid.x0_m, grid.x0_m + grid.rows * grid.dx_m, grid.y0_m, grid.y0_m + grid.cols * grid.dy_m};
}

/// The size in whole pixels.
Box scaled(const View& window, double scale) {
  const auto pixels = [&](double length_m) { return std::max(1.0, std::floor(length_m * scale + 1e-6)); };
  return {0, 0, pixels(window.y1_m - window.y0_m), pixels(window.x1_m - window.x0_m)};
}

/// Centres the panel in a column that begins at x.
View put(View window, Box box, double x, double column, double y) {
  box.x = std::round(x + 0.5 * (column - box.width));
  box.y = y;
  window.box = box;
  return window;
}

/// Makes texts look the same in both kinds of file, and have the same size during layout and drawing.
void prepare(cairo_t* cr) {
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cr, options);
  cairo_font_options_destroy(options);
  set_font(cr, text_height);
}

void draw_heights(cairo_t* cr, const Page& page, const Map& map) {
  draw_cells(cr, page.heights, map,
             [&](const MapCell& cell) { return height_colour(page.range.share(cell.height_m)); });
  if (page.range.low_m < page.range.high_m) draw_colour_bar(cr, page.range, page.bar);
}

void draw_planes(cairo_t* cr, const Page& page, const Map& map) {
  std::map<int, Colour> colour_of{{-1, no_label}};
  for (const PlaneCells& plane : planes_by_size(map))
    colour_of.emplace(plane.label, plane_colour(colour_of.size() - 1));
  draw_cells(cr, page.planes, map, [&](const MapCell& cell) { return colour_of.at(cell.label); });
}

/// Draws lines, marker and axes, which both panels have. Returns the boxes that the marker takes.
std::vector<Box> draw_common(cairo_t* cr, const View& view, const std::string& title, const Map& map,
                             const PictureExtras& extras) {
  draw_curbs(cr, view, map.curbs, extras.truth);
  draw_axes(cr, view, title);
  if (!extras.robot || !shows(view, *extras.robot)) return {};
  const Pixel at = view.at(extras.robot->x_m, extras.robot->y_m);
  draw_arrow(cr, at, extras.robot->heading_rad);
  return {{at.x - 20, at.y - 20, 40, 40}};
}

void write(cairo_t* cr, const std::vector<PlacedText>& texts) {
  for (const PlacedText& text : texts) text_with_rim(cr, text.words, text.box);
}

}  // namespace

Page lay_out(const Map& map, const PictureExtras& extras) {
  const Surface scratch(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const Context cr(cairo_create(scratch.get()));
  prepare(cr.get());
  Page page;
  page.range = height_range(map);
  const View window = window_of(map.grid);
  const double left = left_room(cr.get(), window), right = std::max(right_room(cr.get(), window), column_gap);
  const double bar = bar_gap + colour_bar_width + colour_bar_room(cr.get(), page.range);
  const double top = extras.title.empty() ? margin : margin + page_title_room, panel_top = top + title_room;
  const double beside = std::ceil(2 * margin + 2 * left + bar + column_gap + right + legend_width);
  const double about_one = std::ceil(2 * margin + left + std::max(bar, right) + column_gap + legend_width);
  const double length = window.x1_m - window.x0_m, breadth = window.y1_m - window.y0_m;
  const double room = max_height - panel_top - bottom_room - margin;
  const double in_row = std::min(0.5 * (max_width - beside) / breadth, room / length);
  const double stacked =
      std::min((max_width - about_one) / breadth, (0.5 * (room - bottom_room - title_room)) / length);
  const bool one_below = stacked > in_row;
  const Box box = scaled(window, std::max(stacked, in_row));
  const double column = std::max(least_column, box.width);
  const double below = std::max(box.height, one_below ? least_bar : 0.0) + bottom_room + title_room;

  page.heights = put(window, box, margin + left, column, panel_top);
  page.planes = one_below ? put(window, box, margin + left, column, panel_top + below)
                          : put(window, box, margin + left + column + bar + column_gap + left, column, panel_top);
  page.bar = {page.heights.box.right() + bar_gap, panel_top, colour_bar_width,
              std::clamp(box.height, least_bar, most_bar)};
  page.width = one_below ? about_one + column : beside + 2 * column;
  const double legend_room = std::min(legend_height(map, extras), most_for_legend);
  const double panels = (one_below ? below : 0) + box.height + bottom_room;
  const double body = std::max(title_room + std::max(panels, least_height), legend_room);
  page.height = std::ceil(top + body + margin);
  page.legend = {page.width - margin - legend_width, top, legend_width, body};
  page.title = {margin, margin + 14};
  return page;
}

std::vector<std::string> draw(cairo_t* cr, const Page& page, const Map& map, const PictureExtras& extras) {
  prepare(cr);
  set_colour(cr, white);
  cairo_paint(cr);
  set_font(cr, 17, true);
  text(cr, shortened(cr, printable(extras.title), page.width - 2 * margin), page.title);
  set_font(cr, text_height);

  draw_heights(cr, page, map);
  draw_planes(cr, page, map);
  std::vector<Box> taken = draw_common(cr, page.heights, "Height (m)", map, extras);
  draw_common(cr, page.planes, "Planes and curbs", map, extras);
  draw_legend(cr, map, extras, !taken.empty(), page.legend);

  const auto width = [&](const std::string& words) { return text_width(cr, words); };
  const auto on_planes = [&](Box box) {
    box.x += page.planes.box.x - page.heights.box.x;
    box.y += page.planes.box.y - page.heights.box.y;
    return box;
  };
  const std::vector<MapCurb> pieces = joined(map.curbs, 1.5 * std::max(map.grid.dx_m, map.grid.dy_m));
  std::vector<PlacedText> texts = place_heights(pieces, map.curbs, page.heights, taken, width);
  write(cr, texts);
  for (PlacedText& text : texts) text.box = on_planes(text.box);
  write(cr, texts);
  for (Box& box : taken) box = on_planes(box);
  for (const PlacedText& text : texts) taken.push_back(text.box);
  write(cr, place_labels(map, page.planes, taken, width));

  std::vector<std::string> written(texts.size());
  std::transform(texts.begin(), texts.end(), written.begin(), [](const PlacedText& text) { return text.words; });
  return written;
}

}  // namespace curbline::tools::picture
