// The height of the step at a piece of curb, and its variance: by its planes, at the edge that casts a shadow, and by
// the ground along it and next to it where that deviates from them. Cost: four cells beside each border; the way to
// the first cell of each side, again if it is too narrow to show the ground beside it, and on a robot that drives to
// that of the lower side.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

#include "curbline/borders/border.hpp"
#include "curbline/borders/curb_stages.hpp"
#include "curbline/curbs/curb_piece.hpp"
#include "curbline/curbs/line_weights.hpp"
#include "curbline/curbs/off_plane.hpp"
#include "curbline/curbs/plane_pair.hpp"
#include "curbline/curbs/shadow.hpp"
#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"
#include "curbline/planes/strip_tally.hpp"
#include "curbline/point.hpp"
#include "curbline/sweeps.hpp"

namespace curbline {

template <Limits limits>
class StepHeight {
 public:
  using Piece = CurbPiece<limits>;

  /// Starts with the height by the planes, at the middle of a piece, which must outlive this.
  explicit StepHeight(Piece& piece) : stages_(piece.stages), piece_(piece) {
    height_m_ = piece.planes.step_m(piece.middle_x_m(), piece.middle_y_m()) - piece.drop_m;
    latency_m2_ = latency_m2();
  }

  /// For PlanePair::kind(), to decide whether it is a step.
  MeasuredStep measured() const;
  /// Refines the height by everything else. Moves the piece's line to the edge of a step that casts a shadow. Without a
  /// step the height is 0, with a variance.
  void refine(bool is_step);
  /// Adds the uncertainty of the piece's position, given its variance.
  void doubt_place(float place_variance_m2);

  /// From where the ground on one of its sides was last seen: mean over its cells next to the borders.
  Viewpoint seen_from(Label side) const;

  /// Of PlanePair::other above PlanePair::one.
  float height_m() const { return height_m_; }
  float variance_m2() const { return variance_m2_; }
  /// Width of its shadow; 0 if it casts none.
  float shadow_m() const { return shadow_m_; }

 private:
  bool other_is_upper() const { return height_m_ > 0.0f; }
  typename Piece::Side lower() const { return piece_.side(!other_is_upper()); }
  typename Piece::Side upper() const { return piece_.side(other_is_upper()); }
  void leave_shadow(const Viewpoint& view);
  struct CellBeside {
    int i, j, slot;
  };
  template <typename Wanted>
  CellBeside cell_beside(const Border& border, Label own, Wanted&& wanted) const;
  /// The cell that shows the ground of the plane `own`.
  CellBeside ground_beside(const Border& border, Label own) const;
  std::optional<BySweep> growth_m_s(Label side) const;
  float latency_m2() const;
  float narrow_too_far_m2(bool of_other) const;
  static float carried_m(const Plane& plane, float dx_m, float dy_m);
  GroundAlong ground_along(bool of_other) const;
  void follow_ground();
  struct Deviations {
    Deviation one, other;
  };
  Deviations deviations() const;
  /// Variances of the planes' heights beside the piece, and their covariance.
  struct PlaneErrors {
    float one_m2, other_m2, covariance_m2;
  };
  PlaneErrors plane_errors() const;
  float hidden_m2(bool of_other) const;
  [[gnu::cold]] float lower_m2(typename Piece::End end) const;
  float ground_share_of_slopes(const Viewpoint& view) const;

  const CurbStages<limits>& stages_;
  Piece& piece_;
  float height_m_, latency_m2_, variance_m2_ = 0.0f, shadow_m_ = 0.0f;
};

template <Limits limits>
MeasuredStep StepHeight<limits>::measured() const {
  const Deviations sides = deviations();
  const float too_far_m2 = sides.one.too_far_m2(piece_.borders) + sides.other.too_far_m2(piece_.borders) +
                           narrow_too_far_m2(false) + narrow_too_far_m2(true);
  const auto [one, other] = piece_.planes;
  const float sd_m = square_root(piece_.variance_m2(one) + piece_.variance_m2(other) + latency_m2_ + too_far_m2);
  return {height_m_, sd_m, piece_.half_gap_m, piece_.place_variance_m2, stages_.dem.prior().texture_m2};
}

/// Mean growth of a side's cells next to the borders with the latency of each sweep; none if there are none. What they
/// mix does not matter here.
template <Limits limits>
std::optional<BySweep> StepHeight<limits>::growth_m_s(Label side) const {
  BySweep sum{};
  float cells = 0.0f;
  for (const Border& border : piece_.part) {
    const int slot = cell_beside(border, side, [](int, int, int) { return true; }).slot;
    if (slot < 0) continue;
    const BySweep of_cell = stages_.dem.growths_m_s(slot, stages_.latency.rates);
    sum.now += of_cell.now;
    sum.last += of_cell.last;
    sum.before += of_cell.before;
    cells += 1.0f;
  }
  if (!(cells > 0.0f)) return std::nullopt;
  return BySweep{sum.now / cells, sum.last / cells, sum.before / cells};
}

/// What is not known of the tilt's latency lifts both sides alike where the same sweeps have seen them, and apart where
/// upward ones have seen the one and downward ones the other.
template <Limits limits>
float StepHeight<limits>::latency_m2() const {
  if (piece_.one_sided()) return 0.0f;
  const auto one = growth_m_s(piece_.first.one), other = growth_m_s(piece_.first.other);
  if (!one || !other) return 0.0f;
  return stages_.latency.height_variance_m2(
      {other->now - one->now, other->last - one->last, other->before - one->before});
}

/// Deviation::too_far_m2() of the borders beside which a side is too narrow for that, as a scan line that is the first
/// one there, or cells that a plane lost to its neighbour: by the cell next to each. If that mixes both sides, it is up
/// to half of the step off its plane; what it is off beyond that, twice, is missing from the step.
template <Limits limits>
float StepHeight<limits>::narrow_too_far_m2(bool of_other) const {
  const auto [plane, label, beside] = piece_.side(of_other);
  if (piece_.one_sided() || beside.borders == piece_.borders) return 0.0f;
  const float step_m = magnitude(height_m_), toward = of_other == other_is_upper() ? -1.0f : 1.0f;
  float sum_m = 0.0f, cells = 0.0f;
  for (const Border& border : piece_.part) {
    if ((of_other ? border.beside_other : border.beside_one).borders > 0.0f) continue;
    const auto [i, j, slot] = ground_beside(border, label);
    if (slot < 0) continue;
    const float off_m = toward * stages_.dem.above_m(i, j, stages_.dem.cell(slot), plane);
    sum_m += std::clamp(2.0f * off_m - step_m, 0.0f, step_m);
    cells += 1.0f;
  }
  if (!(cells > 0.0f)) return 0.0f;
  const float chance_m2 = 4.0f * plane.fit_variance_m2 / cells;
  return cells / piece_.borders * std::max(0.0f, square(sum_m / cells) - chance_m2);
}

template <Limits limits>
void StepHeight<limits>::refine(bool is_step) {
  const bool one_sided = piece_.one_sided();
  if (!is_step) height_m_ = 0.0f;
  float ground_share = 0.0f;  // of the step
  if (is_step && !one_sided) {
    const Viewpoint view = seen_from(lower().label);
    leave_shadow(view);
    ground_share = ground_share_of_slopes(view);
  }
  const auto [one, other] = piece_.planes;
  // Behind a brink up to as much again as is visible may be hidden, uniformly.
  variance_m2_ = (one_sided ? square(height_m_) : square(ground_share * height_m_)) * (1.0f / 3);
  if (is_step) {
    follow_ground();
  } else {
    const PlaneErrors planes = plane_errors();
    variance_m2_ += planes.one_m2 + planes.other_m2 - 2.0f * planes.covariance_m2;
  }
  // Rough ground may begin at its edge anywhere within its roughness, uniformly.
  variance_m2_ += (one.rough_m2 + other.rough_m2) * (1.0f / 3) + latency_m2_;
  if (!is_step || one_sided) return;
  variance_m2_ += hidden_m2(false) + hidden_m2(true);
  // Beyond an end of the chain the ground may be another plane's.
  if (piece_.part.ends.first) variance_m2_ += lower_m2(Piece::End::first) * (1.0f / 3);
  if (piece_.part.ends.second) variance_m2_ += lower_m2(Piece::End::second) * (1.0f / 3);
}

/// Beyond an end of the chain another plane may take the place of a side's: by how much lower the step would be, in
/// square, if that plane reached the piece's middle; 0 if labels tell it from the side's, as they do where the two
/// differ, over all borders, by three standard deviations.
template <Limits limits>
float StepHeight<limits>::lower_m2(typename Piece::End end) const {
  const auto from = piece_.beyond(end);
  const float middle_x_m = piece_.middle_x_m(), middle_y_m = piece_.middle_y_m();
  float most_m2 = 0.0f;
  for (const bool other : {false, true}) {
    const Plane& own = piece_.side(other).plane;
    for (const float cells : {0.5f, 1.5f}) {
      const float aside = other ? 1.0f : -1.0f;
      const Label label = piece_.ground_at(from.x_m + cells * from.step_x + aside * from.other_x,
                                           from.y_m + cells * from.step_y + aside * from.other_y);
      if (label == no_label || label == piece_.first.one || label == piece_.first.other) continue;
      const Plane& third = stages_.mixture.plane(label);
      if (!third.alive()) continue;
      const float rise_m = third.height_m(middle_x_m, middle_y_m) - own.height_m(middle_x_m, middle_y_m);
      const float lower_m = other == other_is_upper() ? -rise_m : rise_m;
      const bool alike = square(lower_m) * piece_.borders <= gate * (own.variance_m2 + third.variance_m2);
      if (lower_m > 0.0f && alike) most_m2 = std::max(most_m2, square(lower_m));
    }
  }
  return most_m2;
}

/// A side may be a face, of which so far only a part is seen, as when a sweep arrives at it: behind most borders no
/// cell holds the side's plane alone, and its readings spread over the step. Then its ground lies anywhere within them,
/// and as much again as is seen may be hidden, uniformly: the variance of that.
template <Limits limits>
float StepHeight<limits>::hidden_m2(bool of_other) const {
  const auto [plane, label, beside] = piece_.side(of_other);
  const float spread_m2 = plane.variance_m2 - plane.rough_m2 - stages_.dem.prior().noise_m2;
  const float step_m2 = square(height_m_);
  if (2.0f * beside.borders >= piece_.borders || !spreads_over(step_m2, spread_m2)) return 0.0f;
  return spread_m2 + step_m2 * (1.0f / 3);
}

/// Where slopes differ, the height is as uncertain as the piece's position. If the localisation steps, both sides may
/// have been seen before and after a jump of it, and the height may also be that of any other place along the piece.
template <Limits limits>
void StepHeight<limits>::doubt_place(float place_variance_m2) {
  variance_m2_ += square(piece_.planes.slope_across(piece_.line)) * place_variance_m2;
  if (stages_.view.localisation_steps) variance_m2_ += square(piece_.change_m()) * (1.0f / 12);
}

template <Limits limits>
Viewpoint StepHeight<limits>::seen_from(Label side) const {
  Viewpoint mean = stages_.view;
  if (!stages_.dem.seen_from_several()) return mean;
  float sum_x = 0.0f, sum_y = 0.0f, cells = 0.0f;
  for (const Border& border : piece_.part) {
    const int slot = ground_beside(border, side).slot;
    if (slot < 0) continue;
    const Viewpoint view = stages_.dem.seen_from(slot, stages_.view);
    sum_x += view.x_m;
    sum_y += view.y_m;
    cells += 1.0f;
  }
  if (cells > 0.0f) {
    mean.x_m = sum_x / cells;
    mean.y_m = sum_y / cells;
  }
  return mean;
}

/// The cell that bears the label `own` and is `wanted(i, j, slot)`, nearest to a border, on its side; slot -1 if there
/// is none.
template <Limits limits>
template <typename Wanted>
auto StepHeight<limits>::cell_beside(const Border& border, Label own, Wanted&& wanted) const -> CellBeside {
  const Dem<limits>& dem = stages_.dem;
  const std::size_t d = border.toward(own);
  const int reach = stages_.settings.link_reach + static_cast<int>(border.half_gap_m / dem.cell_m(border.axis));
  int i = static_cast<int>(border.x_m / dem.cell_x_m()), j = static_cast<int>(border.y_m / dem.cell_y_m());
  for (int g = 0; g <= reach && dem.contains(i, j); ++g) {
    const int slot = dem.slot(i, j);
    if (dem.cell(slot).valid() && stages_.field.label(slot) == own && wanted(i, j, slot)) return {i, j, slot};
    i += step_i[d];
    j += step_j[d];
  }
  return {i, j, -1};
}

template <Limits limits>
auto StepHeight<limits>::ground_beside(const Border& border, Label own) const -> CellBeside {
  return cell_beside(border, own, [this](int i, int j, int slot) { return stages_.shows_ground(i, j, slot); });
}

/// A vertical face takes a cell, the laser's spot blurs it, and readings that mix both sides may fill its shadow. A
/// slope longer than these is flatter than the rays and in view from plane to plane, as the flank of a dropped curb is:
/// all of it but the cell and the blur may be ground, and the step lower by anything up to what that rises. The share
/// that this is of the step, mean over the borders.
template <Limits limits>
float StepHeight<limits>::ground_share_of_slopes(const Viewpoint& view) const {
  const float above_m = view.z_m - lower().plane.height_m(piece_.x_m, piece_.y_m);
  if (!(above_m > 0.0f)) return 0.0f;
  const float range_m2 = square(above_m) + square(view.x_m - piece_.x_m) + square(view.y_m - piece_.y_m);
  const float face_cells = 1.0f + view.spot_m(range_m2, above_m) / piece_.cell_m;
  const float longest_face = face_cells + shadow_m_ / piece_.cell_m;
  float share = 0.0f;
  for (const Border& border : piece_.part) {
    if (border.sloped_cells > longest_face)  // never of a piece along its borders' axis, whose cell_m may be 0
      share += piece_.part.share(border) * (1.0f - face_cells / border.sloped_cells);
  }
  return share / piece_.observations;
}

/// A step hides what is behind it from a laser on its upper side (where the robot may no longer be). Its height is the
/// distance of its planes at the edge, to which the line moves.
template <Limits limits>
void StepHeight<limits>::leave_shadow(const Viewpoint& view) {
  const bool upper_is_right = other_is_upper() != piece_.one_is_right;
  if (piece_.has_right(view) != upper_is_right) return;
  const Plane &above = upper().plane, &below = lower().plane;
  const float above_m = view.z_m - above.height_m(piece_.x_m, piece_.y_m);
  const float x_m = piece_.line.x0_m, y_m = piece_.line.y0_m;
  shadow_m_ = move_before_shadow(piece_.line, view, {magnitude(height_m_), above_m, piece_.gap_m + piece_.cell_m});
  const float dx_m = piece_.line.x0_m - x_m, dy_m = piece_.line.y0_m - y_m;
  const float rise_m = carried_m(above, dx_m, dy_m) - carried_m(below, dx_m, dy_m);
  height_m_ += other_is_upper() ? rise_m : -rise_m;
}

/// Rise of a plane extrapolated to an unseen place: less than its slope says, by the square of the distance relative to
/// the mean square extent of its cells in that direction. A strip of two rows, one of which holds something of the
/// other side, has no reliable slope.
template <Limits limits>
float StepHeight<limits>::carried_m(const Plane& plane, float dx_m, float dy_m) {
  const float beyond = plane.rise_variance_m2(dx_m, dy_m) * plane.cells / plane.fit_variance_m2;
  return (plane.slope_x * dx_m + plane.slope_y * dy_m) / (1.0f + beyond);
}

/// By the cells of a side a little farther from the borders.
template <Limits limits>
GroundAlong StepHeight<limits>::ground_along(bool of_other) const {
  const Dem<limits>& dem = stages_.dem;
  const auto [plane, label, beside] = piece_.side(of_other);
  const float slope_m2 = dem.slope_m2(plane);
  float cells = 0.0f, borders = 0.0f, above_m = 0.0f;
  for (const Border& border : piece_.part) {
    const float before = cells;
    const std::size_t d = border.toward(label);
    const int border_i = static_cast<int>(border.x_m / dem.cell_x_m());
    const int border_j = static_cast<int>(border.y_m / dem.cell_y_m());
    for (const int k : GroundAlong::away_cells) {
      const int i = border_i + k * step_i[d], j = border_j + k * step_j[d];
      if (!dem.contains(i, j)) break;
      const int s = dem.slot(i, j);
      if (!stages_.holds_alone(s, label, slope_m2)) continue;
      cells += 1.0f;
      above_m += dem.above_m(i, j, dem.cell(s), plane);
    }
    borders += cells > before ? 1.0f : 0.0f;
  }
  return GroundAlong::of(cells, borders, above_m, plane);
}

/// Where the ground next to the borders deviates from a plane, the step begins at that ground, by its share; for the
/// rest at the ground along the step, by that one's share; and for the rest of that at the plane.
template <Limits limits>
void StepHeight<limits>::follow_ground() {
  const Deviations beside = deviations();
  const PlaneErrors planes = plane_errors();
  const float toward = height_m_ < 0.0f ? -1.0f : 1.0f;
  float planes_share = 1.0f;  // of both planes' errors
  for (const bool other : {false, true}) {
    const Deviation& next = other ? beside.other : beside.one;
    const GroundAlong along = piece_.one_sided() ? GroundAlong{} : ground_along(other);
    const float share = next.share(), rest = 1.0f - share;
    height_m_ += toward * share * next.away_m + rest * (other ? along.above_m : -along.above_m);
    const float plane_m2 = other ? planes.other_m2 : planes.one_m2;
    variance_m2_ += next.height_variance_m2(share) + rest * (plane_m2 + along.share * (along.variance_m2 - plane_m2));
    planes_share *= rest * (1.0f - along.share);
  }
  variance_m2_ -= 2.0f * planes_share * planes.covariance_m2;
}

/// Deviation of the ground from its planes beside the piece. Both sides begin at the near end of a shadow; the borders
/// are in its middle.
template <Limits limits>
auto StepHeight<limits>::deviations() const -> Deviations {
  const float up = height_m_ < 0.0f ? -1.0f : 1.0f;
  const float beyond_cells = shadow_m_ > 0.0f ? -0.5f * up * shadow_m_ / piece_.cell_m : 0.0f;  // cell_m may be 0
  // Of the mean over the piece: all of a line's error if lines run along it, less where it leads ahead.
  const float common_m2 = stages_.dem.common_m2(), line_m2 = stages_.dem.line_m2() / piece_.rows_ahead();
  return {deviation(piece_.beside_one, piece_.planes.one, -up, -beyond_cells, common_m2, line_m2),
          deviation(piece_.beside_other, piece_.planes.other, up, beyond_cells, common_m2, line_m2)};
}

/// As the fits state, of cells that err each on its own, and by the scan lines that have seen one plane or both.
template <Limits limits>
auto StepHeight<limits>::plane_errors() const -> PlaneErrors {
  const Dem<limits>& dem = stages_.dem;
  const auto weights_of = [&](const Plane& plane) {
    return LineWeights(plane, dem.ahead_is(), dem.pitch_m(), piece_.middle_x_m(), piece_.middle_y_m());
  };
  const auto [one, other] = piece_.planes;
  const LineWeights lines_of_one = weights_of(one), lines_of_other = weights_of(other);
  const float line_m2 = dem.line_m2();
  return {piece_.variance_m2(one) + line_m2 / one.points_a_cell * lines_of_one.times(lines_of_one),
          piece_.variance_m2(other) + line_m2 / other.points_a_cell * lines_of_other.times(lines_of_other),
          line_m2 / square_root(one.points_a_cell * other.points_a_cell) * lines_of_one.times(lines_of_other)};
}

}  // namespace curbline
