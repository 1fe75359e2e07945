#include "picture/legend.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "picture/curb_lines.hpp"

namespace curbline::tools::picture {
namespace {

constexpr double line_height = 20, symbol_width = 34;

struct Line {
  std::string words;
  std::function<void(cairo_t*, const Box&)> symbol{};  ///< empty for a heading or a remark
  bool bold = false;
};

Line swatch(const Colour& colour, const std::string& words) {
  const auto symbol = [colour](cairo_t* cr, const Box& box) {
    set_colour(cr, colour);
    fill(cr, {box.x, box.y + 3, 24, 14});
  };
  return {words, symbol};
}

template <typename Draw>
Line sample(const std::string& words, Draw draw) {
  const auto symbol = [draw](cairo_t* cr, const Box& box) {
    const double y = box.y + 0.5 * box.height;
    draw(cr, Pixel{box.x, y}, Pixel{box.x + 26, y});
  };
  return {words, symbol};
}

void append_curbs(std::vector<Line>& lines, const Map& map, const PictureExtras& extras) {
  const auto is_drawn = [window = map.grid.bounds()](const MapCurb& curb) {
    return crosses(window, {curb.x0_m, curb.y0_m}, {curb.x1_m, curb.y1_m});
  };
  lines.push_back({"Curbs", {}, true});
  for (const CurbKind& kind : curb_kinds) {
    const auto is_kind = [&](const MapCurb& curb) { return curb.kind == kind.kind && is_drawn(curb); };
    if (std::none_of(map.curbs.begin(), map.curbs.end(), is_kind)) continue;
    lines.push_back(
        sample(kind.words, [name = kind.kind](cairo_t* cr, Pixel a, Pixel b) { draw_curb(cr, name, a, b); }));
  }
  const bool any = std::any_of(map.curbs.begin(), map.curbs.end(), is_drawn);
  if (!any) lines.push_back({"none"});
  if (std::any_of(extras.truth.begin(), extras.truth.end(), is_drawn)) lines.push_back(sample("truth", draw_truth));
  if (any) lines.push_back({"+ far side higher, - lower"});
}

void append_robot(std::vector<Line>& lines, bool shown) {
  const auto arrow = [](cairo_t* cr, const Box& box) { draw_arrow(cr, {box.x + 8, box.y + 17}, 0); };
  lines.push_back({});
  if (shown) lines.push_back({"robot", arrow});
  if (!shown) lines.push_back({"robot: outside the window"});
}

std::string count(int cells) {
  return std::to_string(cells) + (cells == 1 ? " cell" : " cells");
}

/// Lists the planes in `room` lines.
void append_planes(std::vector<Line>& lines, const std::vector<PlaneCells>& planes, std::size_t room) {
  const std::size_t listed = planes.size() <= room ? planes.size() : room - 1;
  for (std::size_t n = 0; n < listed; ++n) {
    lines.push_back(swatch(plane_colour(n), std::to_string(planes[n].label) + ": " + count(planes[n].cells)));
  }
  if (listed == planes.size()) return;
  int cells = 0;
  for (std::size_t n = listed; n < planes.size(); ++n) cells += planes[n].cells;
  lines.push_back({std::to_string(planes.size() - listed) + " more: " + count(cells)});
}

/// At most `room` lines; a legend without its planes takes fewer than ten.
std::vector<Line> list(const Map& map, const PictureExtras& extras, bool robot_shown, std::size_t room) {
  const std::vector<PlaneCells> planes = planes_by_size(map);
  const auto count_if = [&](auto is) {
    return static_cast<int>(std::count_if(map.cells.begin(), map.cells.end(), is));
  };
  const int without_data = count_if([](const MapCell& cell) { return cell.points == 0; });
  const int without_label = count_if([](const MapCell& cell) { return cell.points > 0 && cell.label < 0; });
  std::vector<Line> lines, last;
  append_curbs(lines, map, extras);
  if (extras.robot) append_robot(lines, robot_shown);
  lines.push_back({});
  lines.push_back({"Planes", {}, true});
  if (planes.empty()) lines.push_back({"none"});
  if (without_label > 0) last.push_back(swatch(no_label, "no plane: " + count(without_label)));
  if (without_data > 0) last.push_back(swatch(no_data, "no data: " + count(without_data)));
  const std::size_t taken = lines.size() + last.size();
  append_planes(lines, planes, std::max<std::size_t>(room, taken + 1) - taken);
  lines.insert(lines.end(), last.begin(), last.end());
  return lines;
}

}  // namespace

std::vector<PlaneCells> planes_by_size(const Map& map) {
  std::map<int, int> of_label;
  for (const MapCell& cell : map.cells) {
    if (cell.points > 0 && cell.label >= 0) ++of_label[cell.label];
  }
  std::vector<PlaneCells> planes;
  for (const auto& [label, cells] : of_label) planes.push_back({label, cells});
  std::stable_sort(planes.begin(), planes.end(), [](auto& a, auto& b) { return a.cells > b.cells; });
  return planes;
}

double legend_height(const Map& map, const PictureExtras& extras) {
  return line_height * static_cast<double>(list(map, extras, true, map.cells.size() + 100).size());
}

void draw_legend(cairo_t* cr, const Map& map, const PictureExtras& extras, bool robot_shown, const Box& box) {
  double y = box.y;
  for (const Line& line : list(map, extras, robot_shown, static_cast<std::size_t>(box.height / line_height))) {
    const Box place{box.x, y, symbol_width, line_height};
    if (line.symbol) line.symbol(cr, place);
    set_font(cr, line.bold ? text_height + 2 : text_height, line.bold);
    const double indent = line.symbol ? symbol_width : 0;
    text(cr, shortened(cr, line.words, box.width - indent),
         {box.x + indent, y + 0.5 * line_height + 0.36 * text_height});
    y += line_height;
  }
  set_font(cr, text_height);
}

}  // namespace curbline::tools::picture
