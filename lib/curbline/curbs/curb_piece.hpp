// A straight piece of a chain of borders (borders.hpp), before it is a curb: the line through them, means of what they
// show, and how far the line goes on beyond them. Cost: 40 operations a border.
#pragma once

#include <algorithm>
#include <cstdint>

#include "curbline/borders/beside.hpp"
#include "curbline/borders/border.hpp"
#include "curbline/borders/curb_stages.hpp"
#include "curbline/curbs/line_fit.hpp"
#include "curbline/curbs/plane_pair.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"

namespace curbline {

/// Borders on one line, and means over them.
template <Limits limits>
struct CurbPiece {
  using Stages = CurbStages<limits>;

  const Stages& stages;
  const ChainPart& part;
  const Border& first;  ///< all have the same planes
  PlanePair planes;
  LineFit::Segment line{};
  float x_m = 0.0f, y_m = 0.0f;  ///< mean of the borders
  float drop_m = 0.0f;           ///< of a brink
  float probability = 0.0f, half_gap_m = 0.0f;
  Beside beside_one{}, beside_other{};  ///< sums
  float borders;                        ///< their number
  float observations;                   ///< the number that they weigh as, ChainPart
  float place_variance_m2 = 0.0f;       ///< of a border, across the line
  float borders_variance_m2 = 0.0f;     ///< of the line's middle, across it, if each border is anywhere in its gap
  float located_variance_m2 = 0.0f;     ///< the same for a step, which the cells of the gap locate
  float gap_m = 0.0f, cell_m = 0.0f;    ///< across it: distance of the cells' centres, size of a cell
  bool one_is_near = false;             ///< the robot is on the side of plane `one`
  bool one_is_right = false;            ///< of the line, from its first end to its second
  bool sides_known = true;              ///< else one_is_right and one_is_near mean nothing

  /// Fits the line to the borders and computes the means. The part must outlive it.
  CurbPiece(const Stages& in, const ChainPart& of);
  CurbPiece(const Stages& in, ChainPart&& of) = delete;

  static PlanePair planes_of(const Stages& in, const Border& border) {
    const Label beyond = border.other == no_label ? border.one : border.other;
    return {in.mixture.plane(border.one), in.mixture.plane(beyond)};
  }
  struct Side {
    const Plane& plane;
    Label label;
    const Beside& beside;
  };
  /// That of plane `other`, or of plane `one`.
  Side side(bool of_other) const {
    return of_other ? Side{planes.other, first.other, beside_other} : Side{planes.one, first.one, beside_one};
  }
  /// Is no ground in view on the other side of `one`?
  bool one_sided() const { return first.other == no_label; }
  float middle_x_m() const { return 0.5f * (line.x0_m + line.x1_m); }
  float middle_y_m() const { return 0.5f * (line.y0_m + line.y1_m); }
  /// How many rows of cells across the way ahead it goes through: scan lines run along them, and each row has its own.
  float rows_ahead() const {
    const SinCos& ahead = stages.dem.ahead_is();
    const float dx_m = line.x1_m - line.x0_m, dy_m = line.y1_m - line.y0_m;
    return 1.0f + magnitude(dx_m * ahead.cos + dy_m * ahead.sin) / stages.dem.pitch_m();
  }
  /// Change of its height from end to end, by its planes.
  float change_m() const { return planes.change_m(line.x1_m - line.x0_m, line.y1_m - line.y0_m); }
  /// Variance of a plane's height at the middle.
  float variance_m2(const Plane& plane) const { return plane.height_variance_m2(middle_x_m(), middle_y_m()); }

  enum class End : std::uint8_t { first, second };  ///< of its line
  /// From an end on: a cell along the line, and the way from the line to cells of `other`.
  struct Beyond {
    float x_m, y_m, step_x, step_y, other_x, other_y;
    float cells;  ///< length of the piece
  };
  Beyond beyond(End end) const;
  /// Label of the ground at a place; no_label where none is seen.
  Label ground_at(float place_x_m, float place_y_m) const;
  /// Continues the line beyond the end of its chain, where one side is hidden and so there are no borders: cell by
  /// cell, as long as one side is of its plane, the other of no other plane, and the height stays even; at most to the
  /// middle of the widest gap that a chain bridges, and by at most a quarter of the length, where the variance of its
  /// position has doubled.
  void go_on(End end);
  /// Variance that errors of heights add to the position of a step. Each cell of the gap, and on both sides of it,
  /// locates the edge within it by its own height. If the step's height is wrong by some share, all are off by half of
  /// that share, at most by half the gap; if a cell's own is, that cell is off by the share, at most by all of it.
  float shifted_m2(float step_m, float height_variance_m2, float cell_variance_m2) const {
    const float each = 1.0f / square(step_m);
    const float all = height_variance_m2 * each, own = cell_variance_m2 * each;
    return square(0.5f * gap_m) * std::min(1.0f, all) + (gap_m + cell_m) * cell_m * std::min(1.0f, own) / observations;
  }
  /// Is the viewpoint to the right of the line?
  bool has_right(const Viewpoint& view) const { return !across(view).left; }
  /// Is it on the side of `other` for certain?
  bool seen_from_other(const Viewpoint& view) const {
    const Across from = across(view);
    return from.certain && from.left == one_is_right;
  }

 private:
  /// On which side of the line a viewpoint lies, and whether that is certain, with the line anywhere within half a gap
  /// of its own at both ends.
  struct Across {
    bool left, certain;
  };
  Across across(const Viewpoint& view) const;
  /// How far beside the line cells are of one side.
  float aside_m() const { return std::max(stages.dem.pitch_m(), half_gap_m); }
  void take_sides(float toward_x, float toward_y);
  void take_means();
  void take_variances(const LineFit& fit);
  float lines_seen() const;
  void take_widths();
};

template <Limits limits>
CurbPiece<limits>::CurbPiece(const Stages& in, const ChainPart& of)
    : stages(in),
      part(of),
      first(part.front()),
      planes(planes_of(in, first)),
      borders(static_cast<float>(part.size())),
      observations(part.observations()) {
  LineFit fit;
  for (const Border& border : part) fit.add(border.x_m, border.y_m, border.weight() * part.share(border));
  x_m = fit.x_m();
  y_m = fit.y_m();
  const float half_cell_m = 0.5f * stages.dem.pitch_m();
  line = fit.segment(first.x_m, first.y_m, part.back().x_m, part.back().y_m, half_cell_m);
  float toward_x = 0.0f, toward_y = 0.0f;  // plane `other`, from `one`
  for (const Border& border : part) (border.axis == 0 ? toward_x : toward_y) += border.sign;
  // For a single border, or two at one place, where surfaces meet at an unseen cell.
  if (!line.has_direction()) line = LineFit::across(first.x_m, first.y_m, toward_x, toward_y, half_cell_m);
  for (const Border& border : part) line.reach(border.x_m, border.y_m, half_cell_m);  // the last need not be outermost
  take_means();
  take_variances(fit);
  take_widths();
  take_sides(toward_x, toward_y);
}

/// On which side of the line `one` lies, and whether the robot does, too. Given the sum of the ways of one cell from
/// `one` to `other` at all borders.
template <Limits limits>
void CurbPiece<limits>::take_sides(float toward_x, float toward_y) {
  // Ways that are along the line in the mean, as around a cell with the label of the other side, tell nothing.
  constexpr float least_across = 0.1f;  // of a border: 6 degrees
  const float to_left = line.normal_x * toward_x + line.normal_y * toward_y;
  one_is_right = to_left >= 0.0f;
  if (magnitude(to_left) < least_across * borders) {
    const float left_x_m = aside_m() * line.normal_x, left_y_m = aside_m() * line.normal_y;
    const Label left = ground_at(middle_x_m() + left_x_m, middle_y_m() + left_y_m);
    const Label right = ground_at(middle_x_m() - left_x_m, middle_y_m() - left_y_m);
    one_is_right = right == first.one && left == first.other;
    sides_known = one_is_right || (left == first.one && right == first.other);
  }
  const Across from = across(stages.view);
  one_is_near = one_sided() || one_is_right != from.left;
  if (one_sided() || from.certain) return;
  // A short line may pass on either side of a robot far away, but the ground below that may be in view.
  const Label below = ground_at(stages.view.x_m, stages.view.y_m);
  if (below == first.one || below == first.other) one_is_near = below == first.one;
}

template <Limits limits>
auto CurbPiece<limits>::across(const Viewpoint& view) const -> Across {
  const float dx_m = line.x1_m - line.x0_m, dy_m = line.y1_m - line.y0_m;
  const float to_x_m = view.x_m - middle_x_m(), to_y_m = view.y_m - middle_y_m();
  const float to_left = dx_m * to_y_m - dy_m * to_x_m, along = magnitude(dx_m * to_x_m + dy_m * to_y_m);
  const float length_m2 = square(dx_m) + square(dy_m);
  return {to_left > 0.0f, square(to_left) * length_m2 > square(half_gap_m * (length_m2 + 2.0f * along))};
}

template <Limits limits>
void CurbPiece<limits>::take_means() {
  for (const Border& border : part) {
    const float each = part.share(border) / observations;
    drop_m += each * border.drop_m;
    probability += each * border.probability;
    half_gap_m += each * border.half_gap_m;
    beside_one.add(border.beside_one);
    beside_other.add(border.beside_other);
  }
}

template <Limits limits>
void CurbPiece<limits>::take_variances(const LineFit& fit) {
  float located = 0.0f, open = 0.0f, parted_m = 0.0f;
  bool alike = true;  // all err alike: each is open, or has no far plane
  for (const Border& border : part) {
    if (border.open) {
      open += part.share(border) / border.half_gap_m;
    } else if (border.parted) {
      parted_m += border.weight() * stages.dem.cell_m(border.axis);
    } else {
      const float pitch_m = stages.dem.cell_m(border.axis), empty_m = static_cast<float>(border.empty) * pitch_m;
      located += square(border.weight()) * (2.0f * border.half_gap_m - empty_m) * pitch_m;
      open += border.weight() * 0.5f * empty_m;
    }
    alike = alike && (border.open || one_sided());
  }
  const float n = observations;
  // The expected variance, in half gaps, times the mean square of half a gap.
  place_variance_m2 =
      (ChainPart::place_prior + fit.squares()) / (2.0f * ChainPart::place_a0 - 2.0f + n) * n / fit.weight();
  const float grown = fit.grown(middle_x_m(), middle_y_m());
  // Each is anywhere in its gap, independently; borders that err alike are known no better than one.
  borders_variance_m2 = (1.0f / 3) * (alike ? n : 1.0f) / fit.weight() * grown;
  // Each cell of a gap shows how much of it is before the edge, with an independent error of anything within the cell.
  // Open borders are anywhere in their gaps, all alike; so are others in empty cells, of a shadow or between two scan
  // lines. Parted ones lie between the same two lines as far as those run along the piece.
  located += square(parted_m) / lines_seen();
  located_variance_m2 = ((1.0f / 12) * located + (1.0f / 3) * square(open)) / square(fit.weight()) * grown;
}

/// How many scan lines have seen the cells beside the piece, all together: those that crossed one, in each row. A line
/// leaves as many points in a cell as beams fit into it.
template <Limits limits>
float CurbPiece<limits>::lines_seen() const {
  const auto [one, other] = planes;
  const Viewpoint& view = stages.view;
  const float above_m = view.z_m - one.height_m(x_m, y_m);
  const float range_m = square_root(square(above_m) + square(view.x_m - x_m) + square(view.y_m - y_m));
  const float beams = std::max(1.0f, stages.dem.pitch_m() / (view.bearing_step_rad * range_m));
  const float lines = std::max(1.0f, square_root(one.points_a_cell * other.points_a_cell) / beams);
  return lines * rows_ahead();
}

template <Limits limits>
void CurbPiece<limits>::take_widths() {
  for (const Border& border : part) {
    const float cosine = border.axis == 0 ? line.normal_x : line.normal_y;
    const float across = part.share(border) / observations * magnitude(cosine);
    gap_m += 2.0f * border.half_gap_m * across;
    cell_m += stages.dem.cell_m(border.axis) * across;
  }
}

template <Limits limits>
Label CurbPiece<limits>::ground_at(float place_x_m, float place_y_m) const {
  const Dem<limits>& dem = stages.dem;
  const int slot = dem.slot_within(place_x_m, place_y_m);
  return slot >= 0 && dem.cell(slot).valid() && stages.mixture.on_ground(slot) ? stages.field.label(slot) : no_label;
}

template <Limits limits>
auto CurbPiece<limits>::beyond(End end) const -> Beyond {
  const bool second = end == End::second;
  const float dx_m = second ? line.x1_m - line.x0_m : line.x0_m - line.x1_m;
  const float dy_m = second ? line.y1_m - line.y0_m : line.y0_m - line.y1_m;
  const float cells = square_root(dx_m * dx_m + dy_m * dy_m) / stages.dem.pitch_m();
  const float to_other_m = one_is_right ? aside_m() : -aside_m();  // along the normal
  const float each = cells > 0.0f ? 1.0f / cells : 0.0f;
  return {second ? line.x1_m : line.x0_m, second ? line.y1_m : line.y0_m, dx_m * each, dy_m * each,
          line.normal_x * to_other_m,     line.normal_y * to_other_m,     cells};
}

template <Limits limits>
void CurbPiece<limits>::go_on(End end) {
  const Beyond from = beyond(end);
  float& end_x = end == End::first ? line.x0_m : line.x1_m;
  float& end_y = end == End::first ? line.y0_m : line.y1_m;
  const float most = 0.25f * from.cells;
  for (int k = 1; 2 * k <= stages.settings.link_reach && static_cast<float>(k) <= most; ++k) {
    const float middle_x = end_x + 0.5f * from.step_x, middle_y = end_y + 0.5f * from.step_y;
    const Label other = ground_at(middle_x + from.other_x, middle_y + from.other_y);
    const Label one = ground_at(middle_x - from.other_x, middle_y - from.other_y);
    const bool other_unseen = other == no_label, one_unseen = one == no_label;
    if ((other != first.other && !other_unseen) || (one != first.one && !one_unseen) || (other_unseen && one_unseen))
      return;
    const float along = from.cells + static_cast<float>(k);
    if (!planes.even(along * from.step_x, along * from.step_y)) return;
    end_x += from.step_x;
    end_y += from.step_y;
  }
}

}  // namespace curbline
