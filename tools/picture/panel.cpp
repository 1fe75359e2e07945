#include "picture/panel.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "formats/decimals.hpp"
#include "picture/ticks.hpp"

namespace curbline::tools::picture {
namespace {

constexpr double tick_length = 5, number_gap = 4;

std::string short_number(double value) {
  char words[32];
  std::snprintf(words, sizeof words, "%g", value);
  return words;
}

void draw_x_axis(cairo_t* cr, const View& view) {
  const auto room = [](const std::string&) { return 1.6 * text_height; };
  for (const Tick& tick : ticks(view.x0_m, view.x1_m, view.scale(), room)) {
    const Pixel at = view.at(tick.value, view.y1_m);
    set_line(cr, black, 1);
    stroke(cr, at, {at.x - tick_length, at.y});
    text(cr, tick.words, {at.x - tick_length - number_gap, at.y + 0.36 * text_height}, 1);
  }
  cairo_save(cr);
  cairo_translate(cr, view.box.x - left_room(cr, view) + text_height, view.box.y + 0.5 * view.box.height);
  cairo_rotate(cr, -0.5 * std::numbers::pi);
  text(cr, "x (m)", {}, 0.5);
  cairo_restore(cr);
}

void draw_y_axis(cairo_t* cr, const View& view) {
  const auto room = [&](const std::string& words) { return text_width(cr, words) + text_height; };
  for (const Tick& tick : ticks(view.y0_m, view.y1_m, view.scale(), room)) {
    const Pixel at = view.at(view.x0_m, tick.value);
    set_line(cr, black, 1);
    stroke(cr, at, {at.x, at.y + tick_length});
    text(cr, tick.words, {at.x, at.y + tick_length + number_gap + 0.75 * text_height}, 0.5);
  }
  text(cr, "y (m)", {view.box.x + 0.5 * view.box.width, view.box.bottom() + 36}, 0.5);
}

/// Centred below the names of the axes.
void draw_scale_bar(cairo_t* cr, const View& view) {
  double length_m = 1;
  while (length_m * view.scale() > std::max(0.8 * view.box.width, 60.0)) length_m /= 10;
  while (length_m * view.scale() < 6) length_m *= 10;
  const std::string words = short_number(length_m) + " m";
  const double length = length_m * view.scale(), gap = 6, y = view.box.bottom() + 54;
  const double x = view.box.x + 0.5 * (view.box.width - length - gap - text_width(cr, words));
  set_line(cr, black, 3);
  stroke(cr, {x, y}, {x + length, y});
  set_line(cr, black, 1);
  stroke(cr, {x, y - 4}, {x, y + 4});
  stroke(cr, {x + length, y - 4}, {x + length, y + 4});
  text(cr, words, {x + length + gap, y + 0.36 * text_height});
}

/// Width of the numbers at the ends, with the decimals of the finest steps that ticks() may choose: a tenth of the
/// window.
double wider_end(cairo_t* cr, double low, double high) {
  const int places = std::max(0, -static_cast<int>(std::floor(std::log10((high - low) / 10))));
  return std::max(text_width(cr, decimals(low, places)), text_width(cr, decimals(high, places)));
}

/// In the format of cairo's RGB24.
std::uint32_t packed(const Colour& colour) {
  const auto byte = [](double share) { return static_cast<std::uint32_t>(std::lround(255 * share)); };
  return byte(colour.r) << 16 | byte(colour.g) << 8 | byte(colour.b);
}

}  // namespace

double left_room(cairo_t* cr, const View& view) {
  return wider_end(cr, view.x0_m, view.x1_m) + tick_length + 2 * number_gap + 1.3 * text_height;
}

double right_room(cairo_t* cr, const View& view) {
  return 0.5 * wider_end(cr, view.y0_m, view.y1_m) + 10;
}

void draw_cells(cairo_t* cr, const View& view, const Map& map, const std::function<Colour(const MapCell&)>& colour) {
  const Grid& grid = map.grid;
  const int width = static_cast<int>(view.box.width), height = static_cast<int>(view.box.height);
  const Surface image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  unsigned char* const pixels = cairo_image_surface_get_data(image.get());
  const std::ptrdiff_t stride = cairo_image_surface_get_stride(image.get());
  std::vector<std::uint32_t> row(static_cast<std::size_t>(width));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const int i = (2 * (height - v) - 1) * grid.rows / (2 * height),
                j = (2 * (width - u) - 1) * grid.cols / (2 * width);
      const MapCell* cell = map.cells.empty() ? nullptr : &map.cells[grid.at(i, j)];
      row[static_cast<std::size_t>(u)] = packed(cell == nullptr || cell->points == 0 ? no_data : colour(*cell));
    }
    std::memcpy(pixels + v * stride, row.data(), row.size() * sizeof row[0]);
  }
  cairo_surface_mark_dirty(image.get());
  cairo_set_source_surface(cr, image.get(), view.box.x, view.box.y);
  cairo_paint(cr);
}

void draw_axes(cairo_t* cr, const View& view, const std::string& title) {
  set_line(cr, black, 1);
  cairo_rectangle(cr, view.box.x, view.box.y, view.box.width, view.box.height);
  cairo_stroke(cr);
  set_font(cr, text_height + 2, true);
  text(cr, title, {view.box.x + 0.5 * view.box.width, view.box.y - 9}, 0.5);
  set_font(cr, text_height);
  draw_x_axis(cr, view);
  draw_y_axis(cr, view);
  draw_scale_bar(cr, view);
}

void draw_arrow(cairo_t* cr, Pixel at, double heading_rad) {
  cairo_save(cr);
  cairo_translate(cr, at.x, at.y);
  cairo_rotate(cr, -heading_rad);
  cairo_move_to(cr, 0, -20);
  cairo_line_to(cr, 8, 5);
  cairo_line_to(cr, 0, 0);
  cairo_line_to(cr, -8, 5);
  cairo_close_path(cr);
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
  set_line(cr, white, 3);
  cairo_stroke_preserve(cr);
  set_colour(cr, {0.85, 0.0, 0.1});
  cairo_fill(cr);
  cairo_restore(cr);
}

bool shows(const View& view, const RobotMarker& robot) {
  const Pixel at = view.at(robot.x_m, robot.y_m);
  return inside({at.x, at.y, 0, 0}, {view.box.x - 1, view.box.y - 1, view.box.width + 2, view.box.height + 2});
}

}  // namespace curbline::tools::picture
