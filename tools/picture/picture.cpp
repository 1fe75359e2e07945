#include "picture/picture.hpp"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <ostream>

#include "formats/atomic_file.hpp"
#include "formats/bad_input.hpp"
#include "picture/colours.hpp"
#include "picture/panel.hpp"

namespace curbline::tools {
namespace {

constexpr double width = 1600, legend_room = 190, margin = 14, title_room = 34;

struct Range {
  double low = 0, high = 1;
  double share(double z) const { return (z - low) / (high - low); }
};

/// From the 2nd to the 98th percentile: a few cells of a wall do not take the colours from the ground.
Range height_range(const Map& map) {
  std::vector<double> heights;
  for (const MapCell& cell : map.cells) {
    if (cell.points > 0) heights.push_back(cell.height_m);
  }
  if (heights.empty()) return {};
  std::sort(heights.begin(), heights.end());
  const auto at = [&](double q) { return heights[static_cast<std::size_t>(q * static_cast<double>(heights.size() - 1))]; };
  Range range{at(0.02), at(0.98)};
  if (range.high - range.low < 0.02) range = {0.5 * (range.low + range.high) - 0.01, 0.5 * (range.low + range.high) + 0.01};
  return range;
}

void colour_bar(cairo_t* cr, const Range& range, const Box& box) {
  for (int k = 0; k < 100; ++k) {
    set_colour(cr, height_colour(k / 99.0));
    cairo_rectangle(cr, box.x, box.y + box.height * (1 - (k + 1) / 100.0), box.width, box.height / 100 + 0.7);
    cairo_fill(cr);
  }
  set_colour(cr, {0.1, 0.1, 0.1});
  set_font(cr, 12);
  for (int k = 0; k <= 4; ++k) {
    char words[32];
    const double z = range.low + k / 4.0 * (range.high - range.low);
    std::snprintf(words, sizeof words, "%.2f m", std::abs(z) < 0.005 ? 0.0 : z);
    text(cr, words, box.x + box.width + 6, box.y + box.height * (1 - k / 4.0) + 4);
  }
}

double curb_key(cairo_t* cr, const Map& map, double x, double y) {
  static constexpr std::pair<const char*, const char*> kinds[] = {{"step_up", "step up"}, {"step_down", "step down"}, {"crease", "crease"}};
  for (const auto& [kind, words] : kinds) {
    const auto of_kind = [&](const MapCurb& curb) { return curb.kind == kind; };
    if (std::none_of(map.curbs.begin(), map.curbs.end(), of_kind)) continue;
    set_curb_style(cr, kind);
    cairo_move_to(cr, x, y - 4);
    cairo_line_to(cr, x + 30, y - 4);
    cairo_stroke(cr);
    set_colour(cr, {0.1, 0.1, 0.1});
    text(cr, words, x + 40, y);
    y += 20;
  }
  return y;
}

void plane_key(cairo_t* cr, const Map& map, double x, double y, double bottom) {
  std::map<int, int> cells;
  for (const MapCell& cell : map.cells) {
    if (cell.points > 0 && cell.label >= 0) ++cells[cell.label];
  }
  std::vector<std::pair<int, int>> by_size(cells.begin(), cells.end());
  std::stable_sort(by_size.begin(), by_size.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  for (std::size_t n = 0; n < by_size.size(); ++n, y += 18) {
    if (y + 18 > bottom && n + 1 < by_size.size()) {
      text(cr, "and " + std::to_string(by_size.size() - n) + " more", x, y);
      return;
    }
    set_colour(cr, label_colour(by_size[n].first));
    cairo_rectangle(cr, x, y - 11, 18, 12);
    cairo_fill(cr);
    set_colour(cr, {0.1, 0.1, 0.1});
    text(cr, "plane " + std::to_string(by_size[n].first) + ": " + std::to_string(by_size[n].second) + " cells", x + 26, y);
  }
}

void draw(cairo_t* cr, const Map& map, const PictureExtras& extras, double height) {
  set_colour(cr, {1, 1, 1});
  cairo_paint(cr);
  set_colour(cr, {0.1, 0.1, 0.1});
  set_font(cr, 17, true);
  text(cr, extras.title, margin, margin + 14);

  const double panel_width = (width - legend_room - 110 - 3 * margin) / 2, panel_height = height - title_room - margin;
  const Range range = height_range(map);
  Panel heights(cr, map.grid, {margin, title_room, panel_width, panel_height});
  Panel labels(cr, map.grid, {margin + panel_width + 110, title_room, panel_width, panel_height});
  const auto cell = [&](int i, int j) -> const MapCell& { return map.cells[map.grid.at(i, j)]; };
  heights.cells([&](int i, int j) -> std::optional<Colour> {
    if (cell(i, j).points == 0) return std::nullopt;
    return height_colour(range.share(cell(i, j).height_m));
  });
  labels.cells([&](int i, int j) -> std::optional<Colour> {
    if (cell(i, j).points == 0 || cell(i, j).label < 0) return std::nullopt;
    return label_colour(cell(i, j).label);
  });
  for (Panel* panel : {&heights, &labels}) {
    panel->truth(extras.truth);
    panel->curbs(map.curbs);
    panel->axes(panel == &heights ? "height" : "planes and curbs");
    panel->heights(map.curbs);
  }
  colour_bar(cr, range, {heights.drawn().x + heights.drawn().width + 14, labels.drawn().y, 18, heights.drawn().height});

  const double x = width - legend_room, top = title_room + 40;
  set_font(cr, 13, true);
  text(cr, "Curbs, far less near", x, top);
  set_font(cr, 12);
  double y = curb_key(cr, map, x, top + 24);
  set_font(cr, 13, true);
  text(cr, "Planes", x, y + 14);
  set_font(cr, 12);
  plane_key(cr, map, x, y + 36, height - margin);
}

cairo_status_t write_to(void* stream, const unsigned char* data, unsigned int length) {
  auto* out = static_cast<std::ostream*>(stream);
  out->write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(length));
  return *out ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

struct Destroy {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* cr) const { cairo_destroy(cr); }
};

bool ends_with(const std::string& path, const std::string& ending) { return path.size() > ending.size() && path.ends_with(ending); }

}  // namespace

void draw_picture(const Map& map, const std::string& path, const PictureExtras& extras) {
  const bool png = ends_with(path, ".png");
  if (!png && !ends_with(path, ".svg")) throw BadInput(path + ": cannot tell the kind of picture; expected a name that ends in .png or .svg");
  // As high as the grid wants at this width, within reason.
  const double aspect = map.grid.rows * map.grid.dx_m / std::max(map.grid.cols * map.grid.dy_m, 1e-3);
  const double height = std::clamp(title_room + 90 + aspect * (width - legend_room - 240) / 2, 420.0, 1100.0);

  AtomicFile file(path);
  std::ostream* out = &file.stream();
  const std::unique_ptr<cairo_surface_t, Destroy> surface(
      png ? cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width), static_cast<int>(height))
          : cairo_svg_surface_create_for_stream(write_to, out, width, height));
  {
    const std::unique_ptr<cairo_t, Destroy> cr(cairo_create(surface.get()));
    draw(cr.get(), map, extras, height);
  }
  if (png) cairo_surface_write_to_png_stream(surface.get(), write_to, out);
  cairo_surface_finish(surface.get());
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) throw BadInput(path + ": the picture could not be written; expected room for it");
  file.commit();
}

}  // namespace curbline::tools
