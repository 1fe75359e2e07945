#include "picture/drawing.hpp"

#include <cstddef>

#include "map/polygon.hpp"

namespace curbline::tools::picture {
namespace {

using Byte = unsigned char;

bool follows(char c) {
  return (static_cast<Byte>(c) & 0xC0) == 0x80;
}

/// Bytes of the UTF-8 character that begins at words[at]; 0: none does.
std::size_t character_at(const std::string& words, std::size_t at) {
  const auto first = static_cast<Byte>(words[at]);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  if (at + length > words.size()) return 0;
  for (std::size_t n = 1; n < length; ++n) {
    if (!follows(words[at + n])) return 0;
  }
  if (length < 3) return length;
  const auto second = static_cast<Byte>(words[at + 1]);
  const bool too_long = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool no_character = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  return too_long || no_character ? 0 : length;
}

bool is_utf8(const std::string& words) {
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t length = character_at(words, at);
    if (length == 0) return false;
    at += length;
  }
  return true;
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
