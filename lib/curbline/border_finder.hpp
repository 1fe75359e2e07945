// Finds border points: where, along a row or column of the window, the ground changes from one plane to another. Cells
// that lie on no plane of the ground, and those that hold something of both sides, are looked through; they tell where
// between the cells of the one and of the other the edge lies. Two edges are found although no ground is seen beyond:
//   - the end of a face: a strip that rises away from the laser as no ramp does. Had it gone on, the laser would see it
//     as well as the face; what lies beyond is flatter than the rays.
//   - a brink: where readings that mix an edge and what lies behind it (ground.hpp: veils), or are too few for a plane,
//     follow the ground, away from the laser, and lie below it. They fall as far as is seen of the step.
// Planes that lie farther apart than the reach of links are asked whether a step down hides what is between them.
// Cost: a pass over the window, a look at each cell of a gap, a face and a veil, and at those before a gap without
// points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/borders.hpp"
#include "curbline/counters.hpp"
#include "curbline/dem.hpp"
#include "curbline/label_field.hpp"
#include "curbline/math.hpp"
#include "curbline/plane_mixture.hpp"
#include "curbline/point.hpp"
#include "curbline/settings.hpp"

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
  BorderFinder(const CurbSettings& settings, const Dem<limits>& dem, const PlaneMixture<limits>& mixture,
               const LabelField<limits>& field, const Viewpoint& view)
      : settings_(settings), dem_(dem), mixture_(mixture), field_(field), view_(view) {}

  /// Fills `borders`, which are empty.
  void find(Borders<limits>& borders, Counters& counters);

 private:
  using Border = typename Borders<limits>::Border;

  static constexpr float widest_face_m = 0.3f;  ///< of a kerb stone
  static constexpr int widest_blur = 2;         ///< cells that mix both sides, at an edge and at the end of its shadow

  /// A line of cells: a column, along x (axis 0), or a row, along y (axis 1).
  struct Line {
    int axis, across;
  };
  /// A cell of a line and its plane.
  struct LabelledCell {
    Label label = no_label;
    std::int16_t along = 0;
  };
  /// From a cell of one plane to one of another.
  struct Gap {
    Line line;
    LabelledCell first, second;
  };
  /// The last cell of a plane, of a face or before a veil, beyond which no ground is seen.
  struct End {
    Line line;
    LabelledCell last;  ///< label is no_label if there is no such end
    int toward;         ///< 1 if the plane is left along the axis, -1 if against it
  };
  struct Brink {
    End end;
    int last_of_veil;  ///< place along the line
  };

  /// The cells beside a gap, as the laser sees them.
  struct Sides {
    const LabelledCell &near, &far;
  };
  Sides sides(const Gap& gap) const {
    return away(gap.line, gap.first.along) > 0 ? Sides{gap.first, gap.second} : Sides{gap.second, gap.first};
  }
  bool wide(const Gap& gap) const { return gap.second.along - gap.first.along > settings_.link_reach; }
  [[gnu::noinline]] bool hidden(const Gap& gap) const;  // seldom: inlined twice it would not fit the flash's budget
  Border border_of(const Gap& gap) const;
  End find_face_end(const Gap& gap, int toward) const;
  Border border_of_face(const End& end) const;
  Brink find_brink(const Line& line, int first_of_veil) const;
  Border border_of(const Brink& brink) const;
  Border border_at(const Line& line, float along_m) const;
  Border border_at(const End& end, float along_m) const;
  Beside beside(const Line& line, float border_m, int toward, Label label) const;
  /// Of what parts the planes.
  struct Middle {
    float along_m;
    bool open;  ///< Borders::Border::open
  };
  Middle middle(const Gap& gap) const;
  bool behind_obstacle(const Gap& gap, int along) const;
  float same_plane(const Gap& gap) const;
  [[gnu::noinline]] bool lies_on(int i, int j, const Cell& cell, const Plane& plane) const;  // as slot()
  bool bears_ground(int slot) const;
  bool is_veil(int slot) const;

  static int row(const Line& line, int along) { return line.axis == 0 ? along : line.across; }
  static int col(const Line& line, int along) { return line.axis == 0 ? line.across : along; }
  // Asked where borders are, in many places: inlined there they take 700 bytes of flash.
  [[gnu::noinline]] int slot(const Line& line, int along) const {
    return dem_.slot(row(line, along), col(line, along));
  }
  /// 1 if the cell lies farther along the line than the laser, else -1.
  int away(const Line& line, int along) const {
    return (static_cast<float>(along) + 0.5f) * pitch_m(line) > (line.axis == 0 ? view_.x_m : view_.y_m) ? 1 : -1;
  }
  int cells_of(const Line& line) const { return dem_.cells_along(line.axis); }
  float pitch_m(const Line& line) const { return dem_.cell_m(line.axis); }
  /// Of the middle of the line.
  float across_m(const Line& line) const {
    return (static_cast<float>(line.across) + 0.5f) * dem_.cell_m(1 - line.axis);
  }
  /// Of the cell's centroid from its middle, in cells along the line.
  float offset(const Line& line, const Cell& cell) const {
    return (line.axis == 0 ? cell.dx_m : cell.dy_m) / pitch_m(line);
  }
  [[gnu::noinline]] float above_m(const Line& line, int along, const Plane& plane) const {
    return dem_.above_m(row(line, along), col(line, along), dem_.cell(slot(line, along)), plane);
  }
  auto belief(const Line& line, int along) const { return field_.belief(dem_, row(line, along), col(line, along)); }

  const CurbSettings& settings_;
  const Dem<limits>& dem_;
  const PlaneMixture<limits>& mixture_;
  const LabelField<limits>& field_;
  const Viewpoint& view_;
};

/// Does a cell bear a plane that a curb may have for a side? A label may outlive its plane by a line.
template <Limits limits>
bool BorderFinder<limits>::bears_ground(int slot) const {
  const Label label = field_.label(slot);
  return label != no_label && mixture_.on_ground(slot) && mixture_.plane(label).alive() && !mixture_.may_be_veil(label);
}

/// May a cell that bears no ground, or lies beside what it bears, mix two sides? As it does that is of a veil, or of a
/// region too small for a plane, or of a plane that may be a veil.
template <Limits limits>
bool BorderFinder<limits>::is_veil(int slot) const {
  if (mixture_.region_label(slot) == no_label) return true;
  const Label label = field_.label(slot);
  return mixture_.on_ground(slot) ? label != no_label && mixture_.may_be_veil(label) : !mixture_.covered(slot);
}

/// Within three standard deviations.
template <Limits limits>
bool BorderFinder<limits>::lies_on(int i, int j, const Cell& cell, const Plane& plane) const {
  const float residual = dem_.above_m(i, j, cell, plane);
  return residual * residual <= gate * (plane.variance_m2 + dem_.height_variance_m2(cell));
}

/// A border wherever the plane changes along a row or column, where a face beyond it ends, and at brinks.
template <Limits limits>
void BorderFinder<limits>::find(Borders<limits>& borders, Counters& counters) {
  const auto add = [&](const Border& border) { counters.borders_full += !borders.add(dem_, border); };
  const auto pass = [&](LabelledCell& before, const LabelledCell& here, const Line& line) {
    const Gap gap{line, before, here};
    before = here;
    if (gap.first.label == no_label || gap.first.label == here.label || (wide(gap) && !hidden(gap))) return;
    add(border_of(gap));
    for (const int toward : {-1, 1}) {
      if (const End end = find_face_end(gap, toward); end.last.label != no_label) add(border_of_face(end));
    }
  };
  const auto end_before = [&](const Line& line, int veil) {
    if (const Brink brink = find_brink(line, veil); brink.end.last.label != no_label) add(border_of(brink));
  };
  std::array<LabelledCell, limits.cols> before_in_col{};
  LabelledCell before_in_row;
  int row = -1;
  dem_.for_each_valid([&](int i, int j, int s) {
    const Label label = field_.label(s);
    if (!bears_ground(s) || !lies_on(i, j, dem_.cell(s), mixture_.plane(label))) {
      if (is_veil(s)) end_before({0, j}, i), end_before({1, i}, j);
      return;
    }
    if (i != row) before_in_row = {};
    row = i;
    pass(before_in_col[static_cast<std::size_t>(j)], {label, static_cast<std::int16_t>(i)}, {0, j});
    pass(before_in_row, {label, static_cast<std::int16_t>(j)}, {1, i});
  });
}

/// Does a step down hide what a wide gap lacks? Then nothing stands in it, and the ray to its far cell has passed over
/// the plane that ends at its near one: where it met that plane, or a blur before, lie cells that bear it.
template <Limits limits>
bool BorderFinder<limits>::hidden(const Gap& gap) const {
  const auto [near, far] = sides(gap);
  const int i = row(gap.line, far.along), j = col(gap.line, far.along), far_slot = dem_.slot(i, j);
  const Viewpoint from = dem_.seen_from(far_slot, view_);
  const Plane& plane = mixture_.plane(near.label);
  const Cell& cell = dem_.cell(far_slot);
  const float above_m = from.z_m - plane.height_m(from.x_m, from.y_m), below_m = -dem_.above_m(i, j, cell, plane);
  if (!(above_m > 0.0f) || !(below_m > 0.0f)) return false;
  for (int along = gap.first.along + 1; along < gap.second.along; ++along) {
    if (mixture_.obstructed(dem_, slot(gap.line, along))) return false;
  }
  const float dx_m = dem_.centroid_x_m(i, cell) - from.x_m, dy_m = dem_.centroid_y_m(j, cell) - from.y_m;
  const float share = above_m / (above_m + below_m);  // of the ray, up to the plane
  const float cells = square_root(square(dx_m / dem_.cell_x_m()) + square(dy_m / dem_.cell_y_m()));
  for (int back = 0; back <= widest_blur; ++back) {
    const float at = share - static_cast<float>(back) / cells;
    const int s = dem_.slot_within(from.x_m + at * dx_m, from.y_m + at * dy_m);
    if (s >= 0 && dem_.cell(s).valid() && bears_ground(s) && field_.label(s) == near.label) return true;
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
auto BorderFinder<limits>::border_at(const Line& line, float along_m) const -> Border {
  Border border{};
  border.x_m = line.axis == 0 ? along_m : across_m(line);
  border.y_m = line.axis == 0 ? across_m(line) : along_m;
  border.axis = static_cast<std::int8_t>(line.axis);
  return border;
}

/// `high` is no_label, and on the side of what is not seen.
template <Limits limits>
auto BorderFinder<limits>::border_at(const End& end, float along_m) const -> Border {
  Border border = border_at(end.line, along_m);
  border.probability = belief(end.line, end.last.along).of(end.last.label);
  border.low = end.last.label;
  border.high = no_label;
  border.sign = static_cast<std::int8_t>(end.toward);
  return border;
}

template <Limits limits>
auto BorderFinder<limits>::border_of(const Gap& gap) const -> Border {
  const bool rising = gap.first.label < gap.second.label;
  const LabelledCell& low = rising ? gap.first : gap.second;
  const LabelledCell& high = rising ? gap.second : gap.first;
  const auto [along_m, open] = middle(gap);
  Border border = border_at(gap.line, along_m);
  border.probability = 1.0f - same_plane(gap);
  border.half_gap_m = 0.5f * static_cast<float>(gap.second.along - gap.first.along) * pitch_m(gap.line);
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
  const Plane& plane = mixture_.plane(label);
  const float slope_m2 = dem_.slope_m2(plane);
  const auto lies_alone = [&](int along) {
    if (along < 0 || along >= cells_of(line)) return false;
    const int s = slot(line, along);
    const Cell& cell = dem_.cell(s);
    return cell.valid() && field_.label(s) == label && mixture_.region_label(s) != no_label && mixture_.on_ground(s) &&
           !dem_.mixed(cell, slope_m2);
  };
  const float border = border_m / pitch_m(line);
  int nearer = static_cast<int>(border) + toward;
  if (!lies_alone(nearer)) nearer += toward;
  const int farther = nearer + toward;
  if (!lies_alone(nearer) || !lies_alone(farther)) return {};
  const float away = static_cast<float>(toward) * (static_cast<float>(nearer) + 0.5f - border);
  return Beside::of(above_m(line, nearer, plane), above_m(line, farther, plane), away);
}

/// Of the face on the far side of a gap (toward 1), or on its near side (-1).
template <Limits limits>
auto BorderFinder<limits>::find_face_end(const Gap& gap, int toward) const -> End {
  const Line& line = gap.line;
  const LabelledCell& first = toward > 0 ? gap.second : gap.first;
  const Plane& plane = mixture_.plane(first.label);
  const auto sign = static_cast<float>(toward);
  const float rise = sign * (line.axis == 0 ? plane.slope_x : plane.slope_y);
  if (rise <= steepest_ramp || away(line, first.along) != toward) return {};

  const int widest = static_cast<int>(widest_face_m / pitch_m(line) + 1.5f);  // touched, when it lies across cells
  int last = first.along;
  while (const int g = dem_.next_valid(slot(line, last), direction(line.axis, toward), settings_.link_reach)) {
    last += toward * g;
    if (field_.label(slot(line, last)) != first.label || toward * (last - first.along) >= widest) return {};
  }
  const bool at_end = last == 0 || last == cells_of(line) - 1;
  if (at_end) return {};  // the window's, perhaps not the face's
  return {line, {first.label, static_cast<std::int16_t>(last)}, toward};
}

/// The points of the last cell reach as far beyond their centroid as they lie before it. Where the next one would have
/// been is open to a cell.
template <Limits limits>
auto BorderFinder<limits>::border_of_face(const End& end) const -> Border {
  const auto sign = static_cast<float>(end.toward);
  const float centroid = sign * offset(end.line, dem_.cell(slot(end.line, end.last.along)));
  const float edge = centroid < 0.0f ? 0.5f + 2.0f * centroid : 0.5f;  // from the cell's middle, in cells
  Border border = border_at(end, (static_cast<float>(end.last.along) + 0.5f + sign * edge) * pitch_m(end.line));
  border.half_gap_m = pitch_m(end.line);
  return border;
}

/// Before the first cell of a veil, as the laser sees it.
template <Limits limits>
auto BorderFinder<limits>::find_brink(const Line& line, int first_of_veil) const -> Brink {
  const int toward = away(line, first_of_veil);
  const int before = dem_.next_valid(slot(line, first_of_veil), direction(line.axis, -toward), settings_.link_reach);
  const int edge = first_of_veil - toward * before;
  if (before == 0 || !bears_ground(slot(line, edge))) return {};
  const auto on_plane = [&](int along, Label label) {
    return lies_on(row(line, along), col(line, along), dem_.cell(slot(line, along)), mixture_.plane(label));
  };
  int last = first_of_veil;
  while (const int g = dem_.next_valid(slot(line, last), direction(line.axis, toward), settings_.link_reach)) {
    const int next = last + toward * g;
    const int s = slot(line, next);
    if (bears_ground(s) && (mixture_.region_label(s) != no_label || on_plane(next, field_.label(s)))) return {};
    if (!is_veil(s)) break;
    last = next;
  }
  const Label label = field_.label(slot(line, edge));
  if (!on_plane(edge, label) || on_plane(last, label) || above_m(line, last, mixture_.plane(label)) > 0.0f) return {};
  return {{line, {label, static_cast<std::int16_t>(edge)}, toward}, last};
}

/// The veil falls on to the far side of its last cell.
template <Limits limits>
auto BorderFinder<limits>::border_of(const Brink& brink) const -> Border {
  const End& end = brink.end;
  const int edge = end.last.along + (end.toward > 0 ? 1 : 0);
  const auto cells = static_cast<float>(end.toward * (brink.last_of_veil - end.last.along));
  Border border = border_at(end, static_cast<float>(edge) * pitch_m(end.line));
  border.half_gap_m = 0.5f * pitch_m(end.line);
  border.drop_m = -above_m(end.line, brink.last_of_veil, mixture_.plane(end.last.label)) * cells / (cells - 0.5f);
  return border;
}

/// Along the line, where the middle of what parts the planes lies: of a face, or of what a step down hides. Halfway
/// between the cells, unless the planes are three standard deviations or more apart: then where the cells tell. What
/// stands on the ground, and what it hides, tells nothing. What cells tell is off by anything within each, on its own;
/// in what stands there the edge lies anywhere: if that is the larger, or a cell is hidden, the border is open.
template <Limits limits>
auto BorderFinder<limits>::middle(const Gap& gap) const -> Middle {
  const Line& line = gap.line;
  const float cell_m = pitch_m(line);
  const auto cells = static_cast<float>(gap.second.along - gap.first.along + 1);
  const float halfway_m = (static_cast<float>(gap.first.along) + 0.5f * cells) * cell_m;
  const Border halfway = border_at(line, halfway_m);
  const Plane& first = mixture_.plane(gap.first.label);
  const Plane& second = mixture_.plane(gap.second.label);
  const float step_m = second.height_m(halfway.x_m, halfway.y_m) - first.height_m(halfway.x_m, halfway.y_m);
  float before = 0.0f;  // in cells, from the first one's near side
  float covered = 0.0f;
  int empty = -1;  // one of them
  for (int along = gap.first.along; along <= gap.second.along; ++along) {
    const int s = slot(line, along);
    const Cell& cell = dem_.cell(s);
    if (!cell.valid()) {
      empty = along;
      before += 0.5f;
    } else if (mixture_.covered(s)) {
      covered += 1.0f;
      before += 0.5f;
    } else {
      before += before_middle({above_m(line, along, first) / step_m, 0.5f + offset(line, cell)});
    }
  }
  const bool open = covered * covered > cells - covered || (empty >= 0 && behind_obstacle(gap, empty));
  if (2.0f * step_m * step_m <= gate * (first.variance_m2 + second.variance_m2)) return {halfway_m, open};
  before = before < 0.0f ? 0.0f : before > cells ? cells : before;
  return {(static_cast<float>(gap.first.along) + before) * cell_m, open};
}

/// Does something that stands on the ground hide a cell of a gap, from where the gap's far side was seen? On the way
/// there a cell that bears no ground lies above the planes of both sides: the face of a step up lies between them.
template <Limits limits>
bool BorderFinder<limits>::behind_obstacle(const Gap& gap, int along) const {
  const Sides cells_beside = sides(gap);
  const Plane& near = mixture_.plane(cells_beside.near.label);
  const Plane& far = mixture_.plane(cells_beside.far.label);
  const auto above = [&](int i, int j, const Cell& cell, const Plane& plane) {
    return dem_.above_m(i, j, cell, plane) > 0.0f && !lies_on(i, j, cell, plane);
  };
  const Viewpoint from = dem_.seen_from(slot(gap.line, cells_beside.far.along), view_);
  const Border middle = border_at(gap.line, (static_cast<float>(along) + 0.5f) * pitch_m(gap.line));
  const float dx = (from.x_m - middle.x_m) / dem_.cell_x_m(), dy = (from.y_m - middle.y_m) / dem_.cell_y_m();
  const float cells = square_root(dx * dx + dy * dy);
  float x = middle.x_m / dem_.cell_x_m(), y = middle.y_m / dem_.cell_y_m();
  for (float passed = 1.0f; passed < cells; passed += 1.0f) {
    x += dx / cells;
    y += dy / cells;
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    if (!(x >= 0.0f) || !(y >= 0.0f) || i >= dem_.rows() || j >= dem_.cols()) return false;
    const int s = dem_.slot(i, j);
    const Cell& cell = dem_.cell(s);
    if (!cell.valid() || bears_ground(s)) continue;
    if (above(i, j, cell, near) && above(i, j, cell, far)) return true;
  }
  return false;
}

}  // namespace curbline
