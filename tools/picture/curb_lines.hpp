// Line styles of curbs, distinguishable without colours: a step up is solid, a step down dashed, a crease dotted, the
// edge of a ramp dash-dotted.
#pragma once

#include <span>
#include <string>

#include "picture/panel.hpp"

namespace curbline::tools::picture {

/// The kinds of curb and their names in the legend.
struct CurbKind {
  const char* kind;
  const char* words;
};
inline constexpr CurbKind curb_kinds[] = {
    {"step_up", "step up"}, {"step_down", "step down"}, {"crease", "crease"}, {"ramp_edge", "ramp edge"}};

void draw_curb(cairo_t* cr, const std::string& kind, Pixel from, Pixel to);
/// The true position of a curb.
void draw_truth(cairo_t* cr, Pixel from, Pixel to);

/// The truth below, the curbs above, both clipped at the window's edge.
void draw_curbs(cairo_t* cr, const View& view, std::span<const MapCurb> curbs, std::span<const MapCurb> truth);

}  // namespace curbline::tools::picture
