// Finds border points: where, along a row or column of the window, the ground changes from one plane to another. Cells
// on no plane of ground, and cells that mix both sides, are looked through; plane_gap.hpp locates the edge by them, and
// decides whether a step down hides what is between planes farther apart than the reach of links. Edges with no ground
// in view beyond: ground_end.hpp. Cost: a pass over the window, and that of the gaps.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/borders/beside.hpp"
#include "curbline/borders/borders.hpp"
#include "curbline/borders/curb_stages.hpp"
#include "curbline/borders/ground_end.hpp"
#include "curbline/borders/plane_gap.hpp"
#include "curbline/counters.hpp"
#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/cell_line.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/plane.hpp"

namespace curbline {

template <Limits limits>
class BorderFinder {
 public:
  explicit BorderFinder(const CurbStages<limits>& stages) : stages_(stages), ends_(stages) {}

  /// Fills `borders`, which must be empty.
  void find(Borders<limits>& borders, Counters& counters) const;

 private:
  using Line = CellLine<limits>;
  using Gap = PlaneGap<limits>;

  // Not inlined: twice inlined it would not fit the flash budget.
  template <typename Add>
  [[gnu::noinline]] void cross(const Line& line, const LabelledCell& first, const LabelledCell& second,
                               Add&& add) const;
  Border border_of(const Gap& gap) const;
  Beside beside(const Gap& gap, float border_m, int toward, const typename Gap::Side& side) const;

  const CurbStages<limits>& stages_;
  const GroundEnds<limits> ends_;
};

/// A border wherever the plane changes along a row or column, where a face beyond it ends, and at brinks.
template <Limits limits>
void BorderFinder<limits>::find(Borders<limits>& borders, Counters& counters) const {
  const Dem<limits>& dem = stages_.dem;
  const auto add = [&](const Border& border) { counters.borders_full += !borders.add(dem, border); };
  const auto end_before = [&](const Line& line, int veil) {
    if (const auto brink = ends_.brink(line, veil)) add(*brink);
  };
  const auto pass = [&](LabelledCell& before, const LabelledCell& here, const Line& line) {
    if (before.label != no_label && before.label != here.label) cross(line, before, here, add);
    before = here;
  };
  std::array<LabelledCell, limits.cols> before_in_col{};
  LabelledCell before_in_row;
  int row = -1;
  dem.for_each_valid([&](int i, int j, int s) {
    if (!stages_.shows_ground(i, j, s)) {
      end_before({dem, 0, j}, i), end_before({dem, 1, i}, j);
      return;
    }
    if (i != row) before_in_row = {};
    row = i;
    const Label label = stages_.field.label(s);
    pass(before_in_col[static_cast<std::size_t>(j)], {label, static_cast<std::int16_t>(i)}, {dem, 0, j});
    pass(before_in_row, {label, static_cast<std::int16_t>(j)}, {dem, 1, i});
  });
}

/// Calls add(border) for the border in the gap of two cells, unless that is too wide, and for the end of a face on
/// either side of it.
template <Limits limits>
template <typename Add>
void BorderFinder<limits>::cross(const Line& line, const LabelledCell& first, const LabelledCell& second,
                                 Add&& add) const {
  const Gap gap(stages_, line, first, second);
  if (gap.length() > stages_.settings.link_reach && !gap.hidden()) return;
  add(border_of(gap));
  if (const auto end = ends_.of_face(gap, gap.first(), -1)) add(*end);
  if (const auto end = ends_.of_face(gap, gap.second(), 1)) add(*end);
}

template <Limits limits>
auto BorderFinder<limits>::border_of(const Gap& gap) const -> Border {
  const bool rising = gap.first().label < gap.second().label;
  const auto& one = rising ? gap.first() : gap.second();
  const auto& other = rising ? gap.second() : gap.first();
  const auto [along_m, open, parted, empty, sloped] = gap.middle();
  Border border = Borders<limits>::on(gap.line(), along_m);
  border.probability = 1.0f - gap.same_plane();
  border.half_gap_m = 0.5f * static_cast<float>(gap.length()) * gap.line().pitch_m();
  border.one = one.label;
  border.other = other.label;
  border.sign = static_cast<std::int8_t>(rising ? 1 : -1);
  border.sloped_cells = sloped;
  border.open = open;
  border.parted = parted;
  border.empty = static_cast<std::uint8_t>(std::min(empty, 255));
  border.beside_one = beside(gap, along_m, -border.sign, one);
  border.beside_other = beside(gap, along_m, border.sign, other);
  return border;
}

/// By the two cells after the border's own, along the axis (toward 1) or against it (-1); one that holds more than the
/// side's plane may be skipped.
template <Limits limits>
Beside BorderFinder<limits>::beside(const Gap& gap, float border_m, int toward, const typename Gap::Side& side) const {
  const Line& line = gap.line();
  const float slope_m2 = line.dem.slope_m2(side.plane);
  const auto lies_alone = [&](int along) {
    return along >= 0 && along < line.cells() && stages_.holds_alone(line.slot(along), side.label, slope_m2);
  };
  const float border = border_m / line.pitch_m();
  int nearer = static_cast<int>(border) + toward;
  if (!lies_alone(nearer)) nearer += toward;
  const int farther = nearer + toward;
  if (!lies_alone(nearer) || !lies_alone(farther)) return {};
  const float away = static_cast<float>(toward) * (static_cast<float>(nearer) + 0.5f - border);
  const auto shown = [&](int along) { return Beside::Shown{line.above_m(along, side.plane), line.cell(along).points}; };
  return Beside::of(shown(nearer), shown(farther), away);
}

}  // namespace curbline
