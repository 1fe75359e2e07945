// How a curb is drawn, told apart without colours: a step up solid, a step down dashed, a crease dotted, the edge of a
// ramp by dashes and dots.
#pragma once

#include <span>
#include <string>

#include "picture/panel.hpp"

namespace curbline::tools::picture {

/// The kinds of curb with their words in the legend.
struct CurbKind {
  const char* kind;
  const char* words;
};
inline constexpr CurbKind curb_kinds[] = {
    {"step_up", "step up"}, {"step_down", "step down"}, {"crease", "crease"}, {"ramp_edge", "ramp edge"}};

void draw_curb(cairo_t* cr, const std::string& kind, Pixel from, Pixel to);
/// A curb as it truly lies.
void draw_truth(cairo_t* cr, Pixel from, Pixel to);

/// The truth beneath, the curbs above, both cut at the window's edge.
void draw_curbs(cairo_t* cr, const View& view, std::span<const MapCurb> curbs, std::span<const MapCurb> truth);

}  // namespace curbline::tools::picture
