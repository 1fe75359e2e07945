#include "picture/curb_lines.hpp"

namespace curbline::tools::picture {

void draw_curb(cairo_t* cr, const std::string& kind, Pixel from, Pixel to) {
  const bool edge = kind == "ramp_edge", crease = edge || kind == "crease";
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
  set_line(cr, white, crease ? 3.5 : 5.5);
  stroke(cr, from, to);
  if (edge) {
    set_line(cr, {0, 0, 0}, 2, {12, 3, 2, 3});
  } else if (crease) {
    set_line(cr, {0, 0, 0}, 2, {2, 3});
  } else if (kind == "step_down") {
    set_line(cr, {0, 0, 0}, 3.5, {9, 4});
  } else {
    set_line(cr, {0, 0, 0}, 3.5);
  }
  stroke(cr, from, to);
}

void draw_truth(cairo_t* cr, Pixel from, Pixel to) {
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
  set_line(cr, white, 3);
  stroke(cr, from, to);
  set_line(cr, {0.85, 0.0, 0.45}, 1.5, {6, 3});
  stroke(cr, from, to);
}

void draw_curbs(cairo_t* cr, const View& view, std::span<const MapCurb> curbs, std::span<const MapCurb> truth) {
  cairo_save(cr);
  cairo_rectangle(cr, view.box.x, view.box.y, view.box.width, view.box.height);
  cairo_clip(cr);
  for (const MapCurb& curb : truth) draw_truth(cr, view.at(curb.x0_m, curb.y0_m), view.at(curb.x1_m, curb.y1_m));
  for (const MapCurb& curb : curbs) {
    draw_curb(cr, curb.kind, view.at(curb.x0_m, curb.y0_m), view.at(curb.x1_m, curb.y1_m));
  }
  cairo_restore(cr);
}

}  // namespace curbline::tools::picture
