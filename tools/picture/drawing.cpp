#include "picture/drawing.hpp"

#include <nlohmann/json.hpp>

#include "map/polygon.hpp"

namespace curbline::tools::picture {
namespace {

using Byte = unsigned char;

bool follows(char c) {
  return (static_cast<Byte>(c) & 0xC0) == 0x80;
}

/// JSON is UTF-8: its writer refuses other text.
bool is_utf8(const std::string& words) {
  try {
    return !nlohmann::json(words).dump().empty();
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

}  // namespace

bool overlap(const Box& a, const Box& b) {
  return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

bool inside(const Box& inner, const Box& outer) {
  return inner.x >= outer.x && inner.y >= outer.y && inner.right() <= outer.right() && inner.bottom() <= outer.bottom();
}

bool crosses(const Box& box, Pixel a, Pixel b) {
  return tools::crosses({box.x, box.y, box.right(), box.bottom()}, {a.x, a.y}, {b.x, b.y});
}

void set_colour(cairo_t* cr, const Colour& colour) {
  cairo_set_source_rgb(cr, colour.r, colour.g, colour.b);
}

void set_line(cairo_t* cr, const Colour& colour, double width, std::initializer_list<double> dashes) {
  set_colour(cr, colour);
  cairo_set_line_width(cr, width);
  cairo_set_dash(cr, dashes.begin(), static_cast<int>(dashes.size()), 0);
}

void stroke(cairo_t* cr, Pixel from, Pixel to) {
  cairo_move_to(cr, from.x, from.y);
  cairo_line_to(cr, to.x, to.y);
  cairo_stroke(cr);
}

void fill(cairo_t* cr, const Box& box) {
  cairo_rectangle(cr, box.x, box.y, box.width, box.height);
  cairo_fill(cr);
}

void set_font(cairo_t* cr, double height, bool bold) {
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, height);
}

double text_width(cairo_t* cr, const std::string& words) {
  cairo_text_extents_t extents;
  cairo_text_extents(cr, words.c_str(), &extents);
  return extents.x_advance;
}

void text(cairo_t* cr, const std::string& words, Pixel base, double share) {
  set_colour(cr, black);
  cairo_move_to(cr, base.x - share * text_width(cr, words), base.y);
  cairo_show_text(cr, words.c_str());
}

void text_with_rim(cairo_t* cr, const std::string& words, const Box& box) {
  const Pixel base{box.x + 0.5 * (box.width - text_width(cr, words)), box.y + 0.5 * box.height + 0.36 * text_height};
  cairo_move_to(cr, base.x, base.y);
  cairo_text_path(cr, words.c_str());
  set_line(cr, white, 3.5);
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke(cr);
  text(cr, words, base);
}

std::string printable(std::string words) {
  const bool ascii_only = !is_utf8(words);
  for (char& c : words) {
    const auto byte = static_cast<Byte>(c);
    if (byte < 0x20 || byte == 0x7F) c = ' ';
    if (byte >= 0x80 && ascii_only) c = '?';
  }
  return words;
}

std::string shortened(cairo_t* cr, const std::string& words, double width) {
  if (text_width(cr, words) <= width) return words;
  std::string start = words;
  while (!start.empty() && text_width(cr, start + "...") > width) {
    while (follows(start.back())) start.pop_back();
    start.pop_back();
  }
  return start + "...";
}

}  // namespace curbline::tools::picture
