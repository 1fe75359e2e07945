#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "picture/legend.hpp"
#include "picture/ticks.hpp"

namespace curbline::tools::picture {
namespace {

constexpr double gap = 8;

/// False for example for cells of a wall, which have the label of the ground around it.
bool on_its_plane(const Map& map, const MapCell& cell) {
  const MapPlane* const plane = plane_of(map, plane_label_of(cell));
  return plane != nullptr && std::abs(cell.height_m - plane->height_m(cell.x_m, cell.y_m)) <= 3 * plane->sd_m;
}

std::vector<Tick> bar_ticks(const HeightRange& range, double height) {
  return ticks(range.low_m, range.high_m, height / (range.high_m - range.low_m),
               [](const std::string&) { return 2.0 * text_height; });
}

}  // namespace

HeightRange height_range(const Map& map) {
  std::vector<double> of_all, of_planes;
  for (const MapCell& cell : map.cells) {
    if (cell.points == 0 || !std::isfinite(cell.height_m)) continue;
    of_all.push_back(cell.height_m);
    if (on_its_plane(map, cell)) of_planes.push_back(cell.height_m);
  }
  std::vector<double>& heights_m = of_planes.empty() ? of_all : of_planes;
  if (heights_m.empty()) return {};
  std::sort(heights_m.begin(), heights_m.end());
  const auto last = static_cast<double>(heights_m.size() - 1);
  const double low = heights_m[static_cast<std::size_t>(std::round(0.02 * last))];
  const double high = heights_m[static_cast<std::size_t>(std::round(0.98 * last))];
  const double widen = std::max(0.0, 0.02 - (high - low)) / 2;
  return {low - widen, high + widen};
}

double colour_bar_room(cairo_t* cr, const HeightRange& range) {
  double widest = 0;
  if (range.low_m < range.high_m) {
    for (const Tick& tick : bar_ticks(range, 400)) widest = std::max(widest, text_width(cr, tick.words));
  }
  return widest + 2 * gap;
}

void draw_colour_bar(cairo_t* cr, const HeightRange& range, const Box& box) {
  constexpr int steps = 128;
  cairo_set_antialias(cr, CAIRO_ANTIALIAS_NONE);
  for (int k = 0; k < steps; ++k) {
    set_colour(cr, height_colour((k + 0.5) / steps));
    const double top = std::round(box.bottom() - box.height * (k + 1) / steps);
    fill(cr, {box.x, top, box.width, std::round(box.bottom() - box.height * k / steps) - top + 0.4});
  }
  cairo_set_antialias(cr, CAIRO_ANTIALIAS_DEFAULT);
  set_line(cr, black, 1);
  cairo_rectangle(cr, box.x, box.y, box.width, box.height);
  cairo_stroke(cr);
  for (const Tick& tick : bar_ticks(range, box.height)) {
    const double y = box.bottom() - range.share(tick.value) * box.height;
    set_line(cr, black, 1);
    stroke(cr, {box.right(), y}, {box.right() + 4, y});
    text(cr, tick.words, {box.right() + gap, y + 0.36 * text_height});
  }
}

}  // namespace curbline::tools::picture
