// Finds border points: where, along a row or column of the window, the ground changes from one plane to another. Cells
// that lie on no plane of the ground, and those that hold something of both sides, are looked through; they tell where
// between the cells of the one and of the other the edge lies. Planes that lie farther apart than the reach of links
// are asked whether a step down hides what is between them. Edges beyond which no ground is seen: ground_end.hpp. Cost:
// a pass over the window, a look at each cell of a gap, and at those before a gap without points.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/beside.hpp"
#include "curbline/borders.hpp"
#include "curbline/cell_line.hpp"
#include "curbline/counters.hpp"
#include "curbline/curb_stages.hpp"
#include "curbline/dem.hpp"
#include "curbline/ground_end.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"
#include "curbline/plane_mixture.hpp"
#include "curbline/point.hpp"

namespace curbline {

/// What a cell shows of a step that crosses it, along the way from the near side to the far one.
struct CrossedCell {
  float far_share;  ///< of the step: 0 if the cell's mean height is that of the near plane, 1 if of the far one
  float centroid;   ///< of its points, in cells from its near side
};

/// How much of a cell lies before the middle of what parts the planes, in cells. With as many points a metre on both
/// planes, each sum over the cells of a gap is exact for
///   - a vertical face that shows any number of points: 1/2 - far_share + centroid is where it stands;
///   - a sloped face as densely seen as the planes;
///   - a gap without points, of which the cells on both sides hold a part: their centroids tell how much, and half of
///     it is counted.
/// A centroid is not bounded: what a few points lie off by lot averages out.
float before_middle(const CrossedCell& cell);

template <Limits limits>
class BorderFinder {
 public:
  BorderFinder(const CurbStages<limits>& stages, int link_reach)
      : stages_(stages), ends_(stages, link_reach), link_reach_(link_reach) {}

  /// Fills `borders`, which are empty.
  void find(Borders<limits>& borders, Counters& counters) const;

 private:
  using Border = typename Borders<limits>::Border;
  using Line = CellLine<limits>;

  static constexpr int widest_blur = 2;  ///< cells that mix both sides, at an edge and at the end of its shadow

  /// From a cell of one plane to one of another.
  struct Gap {
    Line line;
    LabelledCell first, second;
  };
  /// The cells beside a gap, as the laser sees them.
  struct Sides {
    const LabelledCell &near, &far;
  };
  Sides sides(const Gap& gap) const {
    return gap.line.away(stages_.view, gap.first.along) > 0 ? Sides{gap.first, gap.second}
                                                            : Sides{gap.second, gap.first};
  }
  // This and hidden() are called: inlined twice they would not fit the flash's budget.
  template <typename Add>
  [[gnu::noinline]] void cross(const Gap& gap, Add&& add) const;
  bool wide(const Gap& gap) const { return gap.second.along - gap.first.along > link_reach_; }
  [[gnu::noinline]] bool hidden(const Gap& gap) const;
  Border border_of(const Gap& gap) const;
  Beside beside(const Line& line, float border_m, int toward, Label label) const;
  /// Of what parts the planes.
  struct Middle {
    float along_m;
    bool open;  ///< Borders::Border::open
  };
  Middle middle(const Gap& gap) const;
  bool behind_obstacle(const Gap& gap, int along) const;
  float same_plane(const Gap& gap) const;
  auto belief(const Line& line, int along) const {
    return stages_.field.belief(stages_.dem, line.row(along), line.col(along));
  }

  const CurbStages<limits>& stages_;
  const GroundEnds<limits> ends_;
  const int link_reach_;
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
    if (before.label != no_label && before.label != here.label) cross({line, before, here}, add);
    before = here;
  };
  std::array<LabelledCell, limits.cols> before_in_col{};
  LabelledCell before_in_row;
  int row = -1;
  dem.for_each_valid([&](int i, int j, int s) {
    const Label label = stages_.field.label(s);
    if (!stages_.bears_ground(s) || !stages_.lies_on(i, j, dem.cell(s), stages_.mixture.plane(label))) {
      end_before({dem, 0, j}, i), end_before({dem, 1, i}, j);
      return;
    }
    if (i != row) before_in_row = {};
    row = i;
    pass(before_in_col[static_cast<std::size_t>(j)], {label, static_cast<std::int16_t>(i)}, {dem, 0, j});
    pass(before_in_row, {label, static_cast<std::int16_t>(j)}, {dem, 1, i});
  });
}

/// Calls add(border) for that in a gap, unless it is too wide, and for those where a face on one of its sides ends.
template <Limits limits>
template <typename Add>
void BorderFinder<limits>::cross(const Gap& gap, Add&& add) const {
  if (wide(gap) && !hidden(gap)) return;
  add(border_of(gap));
  if (const auto end = ends_.of_face(gap.line, gap.first, -1)) add(*end);
  if (const auto end = ends_.of_face(gap.line, gap.second, 1)) add(*end);
}

/// Does a step down hide what a wide gap lacks? Then nothing stands in it, and the ray to its far cell has passed over
/// the plane that ends at its near one: where it met that plane, or a blur before, lie cells that bear it.
template <Limits limits>
bool BorderFinder<limits>::hidden(const Gap& gap) const {
  const Dem<limits>& dem = stages_.dem;
  const auto [near, far] = sides(gap);
  const int i = gap.line.row(far.along), j = gap.line.col(far.along), far_slot = dem.slot(i, j);
  const Viewpoint from = dem.seen_from(far_slot, stages_.view);
  const Plane& plane = stages_.mixture.plane(near.label);
  const Cell& cell = dem.cell(far_slot);
  const float above_m = from.z_m - plane.height_m(from.x_m, from.y_m), below_m = -dem.above_m(i, j, cell, plane);
  if (!(above_m > 0.0f) || !(below_m > 0.0f)) return false;
  for (int along = gap.first.along + 1; along < gap.second.along; ++along) {
    if (stages_.mixture.obstructed(dem, gap.line.slot(along))) return false;
  }
  const float dx_m = dem.centroid_x_m(i, cell) - from.x_m, dy_m = dem.centroid_y_m(j, cell) - from.y_m;
  const float share = above_m / (above_m + below_m);  // of the ray, up to the plane
  const float cells = square_root(square(dx_m / dem.cell_x_m()) + square(dy_m / dem.cell_y_m()));
  for (int back = 0; back <= widest_blur; ++back) {
    const float at = share - static_cast<float>(back) / cells;
    const int s = dem.slot_within(from.x_m + at * dx_m, from.y_m + at * dy_m);
    if (s >= 0 && dem.cell(s).valid() && stages_.bears_ground(s) && stages_.field.label(s) == near.label) return true;
  }
  return false;
}

/// Probability that the cells on both sides lie on one plane.
template <Limits limits>
float BorderFinder<limits>::same_plane(const Gap& gap) const {
  const auto p = belief(gap.line, gap.first.along), q = belief(gap.line, gap.second.along);
  float same = 0.0f;
  for (std::size_t m = 0; m < p.label.size(); ++m) {
    for (std::size_t n = 0; n < q.label.size(); ++n) {
      if (p.label[m] == q.label[n] && p.label[m] != no_label) same += p.probability[m] * q.probability[n];
    }
  }
  return same;
}

template <Limits limits>
auto BorderFinder<limits>::border_of(const Gap& gap) const -> Border {
  const bool rising = gap.first.label < gap.second.label;
  const LabelledCell& low = rising ? gap.first : gap.second;
  const LabelledCell& high = rising ? gap.second : gap.first;
  const auto [along_m, open] = middle(gap);
  Border border = Borders<limits>::on(gap.line, along_m);
  border.probability = 1.0f - same_plane(gap);
  border.half_gap_m = 0.5f * static_cast<float>(gap.second.along - gap.first.along) * gap.line.pitch_m();
  border.low = low.label;
  border.high = high.label;
  border.sign = static_cast<std::int8_t>(rising ? 1 : -1);
  border.open = open;
  border.beside_low = beside(gap.line, along_m, -border.sign, low.label);
  border.beside_high = beside(gap.line, along_m, border.sign, high.label);
  return border;
}

/// Of two cells after the one that a border lies in, along the axis (toward 1) or against it (-1). One that holds more
/// than the side's plane may lie before them.
template <Limits limits>
Beside BorderFinder<limits>::beside(const Line& line, float border_m, int toward, Label label) const {
  const Plane& plane = stages_.mixture.plane(label);
  const float slope_m2 = line.dem.slope_m2(plane);
  const auto lies_alone = [&](int along) {
    return along >= 0 && along < line.cells() && stages_.holds_alone(line.slot(along), label, slope_m2);
  };
  const float border = border_m / line.pitch_m();
  int nearer = static_cast<int>(border) + toward;
  if (!lies_alone(nearer)) nearer += toward;
  const int farther = nearer + toward;
  if (!lies_alone(nearer) || !lies_alone(farther)) return {};
  const float away = static_cast<float>(toward) * (static_cast<float>(nearer) + 0.5f - border);
  return Beside::of(line.above_m(nearer, plane), line.above_m(farther, plane), away);
}

/// Along the line, where the middle of what parts the planes lies: of a face, or of what a step down hides. Halfway
/// between the cells, unless the planes are three standard deviations or more apart: then where the cells tell. What
/// stands on the ground, and what it hides, tells nothing. What cells tell is off by anything within each, on its own;
/// in what stands there the edge lies anywhere: if that is the larger, or a cell is hidden, the border is open.
template <Limits limits>
auto BorderFinder<limits>::middle(const Gap& gap) const -> Middle {
  const Line& line = gap.line;
  const float cell_m = line.pitch_m();
  const auto cells = static_cast<float>(gap.second.along - gap.first.along + 1);
  const float halfway_m = (static_cast<float>(gap.first.along) + 0.5f * cells) * cell_m;
  const Plane& first = stages_.mixture.plane(gap.first.label);
  const Plane& second = stages_.mixture.plane(gap.second.label);
  const float x_m = line.x_m(halfway_m), y_m = line.y_m(halfway_m);
  const float step_m = second.height_m(x_m, y_m) - first.height_m(x_m, y_m);
  float before = 0.0f;  // in cells, from the first one's near side
  float covered = 0.0f;
  int empty = -1;  // one of them
  for (int along = gap.first.along; along <= gap.second.along; ++along) {
    const int s = line.slot(along);
    const Cell& cell = line.dem.cell(s);
    if (!cell.valid()) {
      empty = along;
      before += 0.5f;
    } else if (stages_.mixture.covered(s)) {
      covered += 1.0f;
      before += 0.5f;
    } else {
      before += before_middle({line.above_m(along, first) / step_m, 0.5f + line.offset(cell)});
    }
  }
  const bool open = covered * covered > cells - covered || (empty >= 0 && behind_obstacle(gap, empty));
  if (2.0f * step_m * step_m <= gate * (first.variance_m2 + second.variance_m2)) return {halfway_m, open};
  before = std::clamp(before, 0.0f, cells);
  return {(static_cast<float>(gap.first.along) + before) * cell_m, open};
}

/// Does something that stands on the ground hide a cell of a gap, from where the gap's far side was seen? On the way
/// there a cell that bears no ground lies above the planes of both sides: the face of a step up lies between them.
template <Limits limits>
bool BorderFinder<limits>::behind_obstacle(const Gap& gap, int along) const {
  const Dem<limits>& dem = stages_.dem;
  const Sides cells_beside = sides(gap);
  const Plane& near = stages_.mixture.plane(cells_beside.near.label);
  const Plane& far = stages_.mixture.plane(cells_beside.far.label);
  const auto above = [&](int i, int j, const Cell& cell, const Plane& plane) {
    return dem.above_m(i, j, cell, plane) > 0.0f && !stages_.lies_on(i, j, cell, plane);
  };
  const Viewpoint from = dem.seen_from(gap.line.slot(cells_beside.far.along), stages_.view);
  const float middle_m = (static_cast<float>(along) + 0.5f) * gap.line.pitch_m();
  const float x_m = gap.line.x_m(middle_m), y_m = gap.line.y_m(middle_m);
  const float dx = (from.x_m - x_m) / dem.cell_x_m(), dy = (from.y_m - y_m) / dem.cell_y_m();
  const float cells = square_root(dx * dx + dy * dy);
  float x = x_m / dem.cell_x_m(), y = y_m / dem.cell_y_m();
  for (float passed = 1.0f; passed < cells; passed += 1.0f) {
    x += dx / cells;
    y += dy / cells;
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    if (!(x >= 0.0f) || !(y >= 0.0f) || i >= dem.rows() || j >= dem.cols()) return false;
    const int s = dem.slot(i, j);
    const Cell& cell = dem.cell(s);
    if (!cell.valid() || stages_.bears_ground(s)) continue;
    if (above(i, j, cell, near) && above(i, j, cell, far)) return true;
  }
  return false;
}

}  // namespace curbline
