#include "picture/panel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace curbline::tools {
namespace {

constexpr double axis_room = 46;  ///< pixels left of and below the grid
constexpr double title_room = 26;

/// 1, 2 or 5 times a power of ten, so that there are at most ten ticks.
double tick_step(double length_m) {
  for (double step = 0.1;; step *= 10) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (length_m / (step * factor) <= 10) return step * factor;
    }
  }
}

std::string number(double value, int decimals) {
  char words[32];
  std::snprintf(words, sizeof words, "%.*f", decimals, std::abs(value) < 1e-9 ? 0.0 : value);
  return words;
}

std::string centimetres(double height_m) {
  char words[32];
  std::snprintf(words, sizeof words, "%+.1f cm", 100 * height_m);
  return words;
}

bool overlap(const Box& a, const Box& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

double length_m(const MapCurb& c) { return std::hypot(c.x1_m - c.x0_m, c.y1_m - c.y0_m); }

}  // namespace

void set_colour(cairo_t* cr, const Colour& colour) { cairo_set_source_rgb(cr, colour.r, colour.g, colour.b); }

void set_font(cairo_t* cr, double size, bool bold) {
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, size);
}

void text(cairo_t* cr, const std::string& words, double x, double y, double align) {
  cairo_text_extents_t extents;
  cairo_text_extents(cr, words.c_str(), &extents);
  cairo_move_to(cr, x - align * extents.x_advance, y);
  cairo_show_text(cr, words.c_str());
}

void set_curb_style(cairo_t* cr, const std::string& kind) {
  const double dash = 5;
  cairo_set_line_width(cr, kind == "crease" ? 1.5 : 3.5);
  cairo_set_dash(cr, &dash, kind == "crease" ? 1 : 0, 0);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
  if (kind == "step_up") {
    cairo_set_source_rgb(cr, 0.85, 0.0, 0.1);
  } else if (kind == "step_down") {
    cairo_set_source_rgb(cr, 0.35, 0.0, 0.75);
  } else {
    cairo_set_source_rgb(cr, 0, 0, 0);
  }
}

Panel::Panel(cairo_t* cr, const Grid& grid, const Box& box) : cr_(cr), grid_(grid) {
  const double wide_m = std::max(grid.cols * grid.dy_m, 1e-3), high_m = std::max(grid.rows * grid.dx_m, 1e-3);
  scale_ = std::min((box.width - axis_room) / wide_m, (box.height - axis_room - title_room) / high_m);
  drawn_ = {box.x + axis_room + 0.5 * (box.width - axis_room - wide_m * scale_), box.y + title_room, wide_m * scale_, high_m * scale_};
}

void Panel::cells(const std::function<std::optional<Colour>(int, int)>& colour) {
  set_colour(cr_, {0.93, 0.93, 0.93});
  cairo_rectangle(cr_, drawn_.x, drawn_.y, drawn_.width, drawn_.height);
  cairo_fill(cr_);
  cairo_set_antialias(cr_, CAIRO_ANTIALIAS_NONE);  // no seams between cells
  for (int i = 0; i < grid_.rows; ++i) {
    for (int j = 0; j < grid_.cols; ++j) {
      const auto c = colour(i, j);
      if (!c) continue;
      set_colour(cr_, *c);
      const double left = px(grid_.y_m(j) + 0.5 * grid_.dy_m), top = py(grid_.x_m(i) + 0.5 * grid_.dx_m);
      cairo_rectangle(cr_, left, top, grid_.dy_m * scale_ + 0.5, grid_.dx_m * scale_ + 0.5);
      cairo_fill(cr_);
    }
  }
  cairo_set_antialias(cr_, CAIRO_ANTIALIAS_DEFAULT);
}

void Panel::axes(const char* title) {
  set_colour(cr_, {0.1, 0.1, 0.1});
  cairo_set_line_width(cr_, 1);
  cairo_set_dash(cr_, nullptr, 0, 0);
  cairo_rectangle(cr_, drawn_.x, drawn_.y, drawn_.width, drawn_.height);
  cairo_stroke(cr_);
  set_font(cr_, 15, true);
  text(cr_, title, drawn_.x + 0.5 * drawn_.width, drawn_.y - 9, 0.5);
  set_font(cr_, 12);
  const double bottom = drawn_.y + drawn_.height;
  const double y_end = grid_.y0_m + grid_.cols * grid_.dy_m, x_end = grid_.x0_m + grid_.rows * grid_.dx_m;
  const double step = tick_step(std::max(y_end - grid_.y0_m, x_end - grid_.x0_m));
  const int decimals = step < 0.95 ? 1 : 0;
  for (double y = std::ceil(grid_.y0_m / step - 1e-6) * step; y <= y_end + 1e-6; y += step) {
    cairo_move_to(cr_, px(y), bottom);
    cairo_line_to(cr_, px(y), bottom + 5);
    cairo_stroke(cr_);
    text(cr_, number(y, decimals), px(y), bottom + 18, 0.5);
  }
  for (double x = std::ceil(grid_.x0_m / step - 1e-6) * step; x <= x_end + 1e-6; x += step) {
    cairo_move_to(cr_, drawn_.x, py(x));
    cairo_line_to(cr_, drawn_.x - 5, py(x));
    cairo_stroke(cr_);
    text(cr_, number(x, decimals), drawn_.x - 8, py(x) + 4, 1);
  }
  text(cr_, "y (m), left", drawn_.x + 0.5 * drawn_.width, bottom + 36, 0.5);
  cairo_save(cr_);
  cairo_translate(cr_, drawn_.x - 34, drawn_.y + 0.5 * drawn_.height);
  cairo_rotate(cr_, -1.5707963);
  text(cr_, "x (m), ahead", 0, 0, 0.5);
  cairo_restore(cr_);
}

void Panel::line(const MapCurb& curb) {
  cairo_move_to(cr_, px(curb.y0_m), py(curb.x0_m));
  cairo_line_to(cr_, px(curb.y1_m), py(curb.x1_m));
  cairo_stroke(cr_);
}

void Panel::curbs(std::span<const MapCurb> curbs) {
  cairo_save(cr_);
  cairo_rectangle(cr_, drawn_.x, drawn_.y, drawn_.width, drawn_.height);
  cairo_clip(cr_);
  for (const MapCurb& curb : curbs) {
    set_curb_style(cr_, curb.kind);
    line(curb);
  }
  cairo_restore(cr_);
}

void Panel::truth(std::span<const MapCurb> curbs) {
  cairo_save(cr_);
  cairo_rectangle(cr_, drawn_.x, drawn_.y, drawn_.width, drawn_.height);
  cairo_clip(cr_);
  const double dashes[] = {8, 6};
  cairo_set_dash(cr_, dashes, 2, 0);
  cairo_set_line_width(cr_, 7);
  cairo_set_source_rgba(cr_, 1, 1, 1, 0.9);
  for (const MapCurb& curb : curbs) line(curb);
  cairo_restore(cr_);
}

void Panel::heights(std::span<const MapCurb> curbs) {
  std::vector<const MapCurb*> order;
  for (const MapCurb& curb : curbs) {
    if (curb.kind != "crease") order.push_back(&curb);
  }
  std::stable_sort(order.begin(), order.end(), [](const MapCurb* a, const MapCurb* b) { return length_m(*a) > length_m(*b); });
  std::vector<Box> taken;
  set_font(cr_, 12, true);
  for (const MapCurb* curb : order) {
    const std::string words = centimetres(curb->height_m);
    cairo_text_extents_t extents;
    cairo_text_extents(cr_, words.c_str(), &extents);
    const double x = px(0.5 * (curb->y0_m + curb->y1_m)) + 7, y = py(0.5 * (curb->x0_m + curb->x1_m)) - 7;
    Box box{x - 3, y - extents.height - 3, extents.x_advance + 6, extents.height + 6};
    box.x = std::clamp(box.x, drawn_.x, std::max(drawn_.x, drawn_.x + drawn_.width - box.width));
    box.y = std::clamp(box.y, drawn_.y, std::max(drawn_.y, drawn_.y + drawn_.height - box.height));
    if (std::any_of(taken.begin(), taken.end(), [&](const Box& other) { return overlap(box, other); })) continue;
    taken.push_back(box);
    cairo_set_source_rgba(cr_, 1, 1, 1, 0.85);
    cairo_rectangle(cr_, box.x, box.y, box.width, box.height);
    cairo_fill(cr_);
    set_colour(cr_, {0, 0, 0});
    text(cr_, words, box.x + 3, box.y + box.height - 3);
  }
}

}  // namespace curbline::tools
