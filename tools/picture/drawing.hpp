// Drawing primitives for all parts of the picture: positions on the page, lines and texts. Pixels, x to the right and y
// down.
#pragma once

#include <cairo.h>

#include <initializer_list>
#include <memory>
#include <string>

#include "picture/colours.hpp"

namespace curbline::tools::picture {

struct Pixel {
  double x = 0, y = 0;
};

struct Box {
  double x = 0, y = 0, width = 0, height = 0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

bool overlap(const Box& a, const Box& b);
bool inside(const Box& inner, const Box& outer);
/// Whether the straight line from a to b meets the box; false if one of them is NaN.
bool crosses(const Box& box, Pixel a, Pixel b);

struct Destroy {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* cr) const { cairo_destroy(cr); }
};
using Surface = std::unique_ptr<cairo_surface_t, Destroy>;
using Context = std::unique_ptr<cairo_t, Destroy>;

inline constexpr Colour black{0.1, 0.1, 0.1}, white{1, 1, 1};
inline constexpr double text_height = 12;  ///< of all texts except titles

void set_colour(cairo_t* cr, const Colour& colour);
void set_line(cairo_t* cr, const Colour& colour, double width, std::initializer_list<double> dashes = {});
void stroke(cairo_t* cr, Pixel from, Pixel to);
void fill(cairo_t* cr, const Box& box);

/// For the texts that follow.
void set_font(cairo_t* cr, double height, bool bold = false);
double text_width(cairo_t* cr, const std::string& words);
/// Starts at `base`, on the base line; with share 0.5 it is centred there, with 1 it ends there.
void text(cairo_t* cr, const std::string& words, Pixel base, double share = 0);
/// Black with a white rim, readable on any colour; centred in the box.
void text_with_rim(cairo_t* cr, const std::string& words, const Box& box);

/// Text that a font can draw and XML can contain: blanks instead of control characters, and "?" for everything that is
/// not ASCII if the whole is not UTF-8.
std::string printable(std::string words);
/// As much of the text as fits, with "..." if it was shortened.
std::string shortened(cairo_t* cr, const std::string& words, double width);

}  // namespace curbline::tools::picture
