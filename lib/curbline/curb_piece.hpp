// A straight piece of a chain of borders (borders.hpp) before it is a curb: the line that they lie on, what they tell
// on the mean, how far the line goes on beyond them, and from where what lies beside it was seen. Cost: 40 operations a
// border, and of a robot that drives a look at the cells beside it.
#pragma once

#include <cstdint>

#include "curbline/beside.hpp"
#include "curbline/borders.hpp"
#include "curbline/dem.hpp"
#include "curbline/label_field.hpp"
#include "curbline/line_fit.hpp"
#include "curbline/math.hpp"
#include "curbline/plane_mixture.hpp"
#include "curbline/point.hpp"

namespace curbline {

/// What curbs are found in.
template <Limits limits>
struct CurbStages {
  const Dem<limits>& dem;
  const PlaneMixture<limits>& mixture;
  const LabelField<limits>& field;
  const Viewpoint& view;

  /// The other plane of a border. Where no ground is seen beyond the near one stands for it: no step but the drop, no
  /// known slope.
  const Plane& beyond(const typename Borders<limits>::Border& border) const {
    return mixture.plane(border.high == no_label ? border.low : border.high);
  }
};

/// Borders that lie on one line; means of what they tell.
template <Limits limits>
struct CurbPiece {
  using Border = typename Borders<limits>::Border;
  using Stages = CurbStages<limits>;

  /// How far borders lie off their line, in half gaps, is normal, of a variance that is inverse gamma before one is
  /// seen: a0, and b0 as of what lies anywhere from -1 to 1. The prior is 2 b0, to which the sum of the squares is
  /// added.
  static constexpr float place_a0 = 2.0f, place_prior = 2.0f * place_a0 / 3.0f;
  /// By how much the height may change along a piece: from its middle to an end by no more than the repeatability of a
  /// range-finder.
  static constexpr float most_change_m = 0.02f;

  LineFit::Segment line{};
  float x_m = 0.0f, y_m = 0.0f;             ///< mean of the borders
  float drop_m = 0.0f, variance_m2 = 0.0f;  ///< of a brink; of the height of the one plane above the other
  float probability = 0.0f, half_gap_m = 0.0f;
  Beside beside_low{}, beside_high{};  ///< sums
  float borders = 0.0f;                ///< how many
  float observations = 0.0f;           ///< as how many they weigh, see share()
  float place_variance_m2 = 0.0f;      ///< of a border, across the line
  float borders_variance_m2 = 0.0f;    ///< of the line's middle, across it, as far as borders err each on its own
  float told_variance_m2 = 0.0f;       ///< the same of a step, whose cells tell where in the gap it lies
  float gap_m = 0.0f, cell_m = 0.0f;   ///< across it: between the cells' centres; of one cell
  bool low_is_near = false;            ///< the robot stands on the side of the low-numbered plane
  bool low_is_right = false;           ///< of the line, from its first end to its second

  /// Fits a line to the borders and takes the mean of what they tell.
  static CurbPiece of(const Stages& stages, const Borders<limits>& borders, int first, int last);
  /// What an open border weighs beside the others. Those of one shadow err alike: all together they weigh as one,
  /// unless there are no others.
  static float open_share(const Borders<limits>& borders, int first, int last);
  static float share(const Border& border, float open_share) { return border.open ? open_share : 1.0f; }
  /// Of a border in the line.
  static float weight(const Border& border) { return 1.0f / (border.half_gap_m * border.half_gap_m); }
  /// Is a border's step one height from one place to another, (dx, dy) from it?
  static bool even(const Stages& stages, const Border& border, float dx_m, float dy_m);
  /// Where one of its sides is not seen no border tells of a line. From the end of a chain it goes on cell by cell, as
  /// long as one side is that of its plane, the other no other plane's, and its height one; no farther than to the
  /// middle of the widest gap that a chain bridges, nor than a quarter of its length, where the variance of where it
  /// lies has doubled.
  void go_on(const Stages& stages, const Border& border, int link_reach, bool at_start);
  /// Mean square of how far heights shift the line of a step. Each cell of the gap, the ones on both sides too, tells
  /// by its own height where in it the edge lies. If the step's is wrong by a share of it all are off by half of that
  /// share, at most by half the gap; if a cell's own is, it alone is off by that share, at most by all of it.
  float shifted_m2(float step_m, float height_variance_m2, float cell_variance_m2) const {
    const float each = 1.0f / square(step_m);
    const float all = height_variance_m2 * each, own = cell_variance_m2 * each;
    return square(0.5f * gap_m) * (all < 1.0f ? all : 1.0f) +
           (gap_m + cell_m) * cell_m * (own < 1.0f ? own : 1.0f) / observations;
  }
  /// Does it look from the right of the line?
  bool has_right(const Viewpoint& view) const {
    return (line.x1_m - line.x0_m) * (view.y_m - line.y0_m) <= (line.y1_m - line.y0_m) * (view.x_m - line.x0_m);
  }
  /// From where the lower side of a piece was seen last: the mean of its cells next to the borders.
  static Viewpoint seen_from(const Stages& stages, const Borders<limits>& borders, int first, int last, int link_reach,
                             Label lower);

 private:
  enum class Side : std::uint8_t { unseen, own, other };
  static Side side(const Stages& stages, float x_m, float y_m, Label own);
};

template <Limits limits>
auto CurbPiece<limits>::of(const Stages& stages, const Borders<limits>& borders, int first, int last) -> CurbPiece {
  const Dem<limits>& dem = stages.dem;
  const Border& a = borders.at(first);
  const Border& b = borders.at(last);
  const Plane& low = stages.mixture.plane(a.low);
  const Plane& high = stages.beyond(a);
  const float open_share = CurbPiece::open_share(borders, first, last);
  CurbPiece piece;
  piece.borders = static_cast<float>(last - first + 1);
  for (int k = first; k <= last; ++k) piece.observations += share(borders.at(k), open_share);
  const float n = piece.observations;
  LineFit fit;
  float told = 0.0f, open = 0.0f;
  bool alike = true;                       // do they err: each is open, or has no far plane
  float toward_x = 0.0f, toward_y = 0.0f;  // the high-numbered plane, from the other
  for (int k = first; k <= last; ++k) {
    const Border& border = borders.at(k);
    const float x_m = border.x_m, y_m = border.y_m, own = share(border, open_share), each = own / n;
    fit.add(x_m, y_m, weight(border) * own);
    piece.drop_m += each * border.drop_m;
    piece.variance_m2 += each * (high.height_variance_m2(x_m, y_m) + low.height_variance_m2(x_m, y_m));
    piece.probability += each * border.probability;
    piece.half_gap_m += each * border.half_gap_m;
    piece.beside_low.add(border.beside_low);
    piece.beside_high.add(border.beside_high);
    (border.axis == 0 ? toward_x : toward_y) += border.sign;
    if (border.open) {
      open += own / border.half_gap_m;
    } else {
      told += weight(border) / border.half_gap_m * dem.cell_m(border.axis);
    }
    alike = alike && (border.open || a.high == no_label);
  }
  // Of borders whose errors are alike: the variance expected, in half gaps, times the mean square of half a gap.
  piece.place_variance_m2 = (place_prior + fit.squares()) / (2.0f * place_a0 - 2.0f + n) * n / fit.weight();
  // Each lies anywhere in its gap, on its own; those that err alike are as little known as one of them.
  piece.borders_variance_m2 = (1.0f / 3) * (alike ? n : 1.0f) / fit.weight();
  // Each cell of a gap tells how much of it lies before the edge: off by anything within it, on its own. Open ones lie
  // anywhere in their gaps, all alike.
  piece.told_variance_m2 = ((1.0f / 6) * told + (1.0f / 3) * square(open)) / square(fit.weight());
  piece.x_m = fit.x_m();
  piece.y_m = fit.y_m();
  const float half_cell_m = 0.25f * (dem.cell_x_m() + dem.cell_y_m());
  piece.line = first == last ? LineFit::across(a.x_m, a.y_m, a.axis, half_cell_m)
                             : fit.segment(a.x_m, a.y_m, b.x_m, b.y_m, half_cell_m);
  const float grown = fit.grown(0.5f * (piece.line.x0_m + piece.line.x1_m), 0.5f * (piece.line.y0_m + piece.line.y1_m));
  piece.borders_variance_m2 *= grown;
  piece.told_variance_m2 *= grown;
  const float dx_m = piece.line.x1_m - piece.line.x0_m, dy_m = piece.line.y1_m - piece.line.y0_m;
  piece.low_is_right = dx_m * toward_y - dy_m * toward_x >= 0.0f;
  piece.low_is_near = a.high == no_label || piece.low_is_right == piece.has_right(stages.view);
  for (int k = first; k <= last; ++k) {
    const Border& border = borders.at(k);
    const float cosine = border.axis == 0 ? piece.line.normal_x : piece.line.normal_y;
    const float across = share(border, open_share) / n * (cosine < 0.0f ? -cosine : cosine);
    piece.gap_m += 2.0f * border.half_gap_m * across;
    piece.cell_m += dem.cell_m(border.axis) * across;
  }
  return piece;
}

template <Limits limits>
float CurbPiece<limits>::open_share(const Borders<limits>& borders, int first, int last) {
  int open = 0;
  for (int k = first; k <= last; ++k) open += borders.at(k).open;
  if (open == 0 || open > last - first) return 1.0f;
  return 1.0f / static_cast<float>(open);
}

template <Limits limits>
bool CurbPiece<limits>::even(const Stages& stages, const Border& border, float dx_m, float dy_m) {
  const Plane& low = stages.mixture.plane(border.low);
  const Plane& high = stages.beyond(border);
  const float change_m = (high.slope_x - low.slope_x) * dx_m + (high.slope_y - low.slope_y) * dy_m;
  return change_m >= -most_change_m && change_m <= most_change_m;
}

/// What is seen of one side of a line, which should be of the plane `own`.
template <Limits limits>
auto CurbPiece<limits>::side(const Stages& stages, float x_m, float y_m, Label own) -> Side {
  const Dem<limits>& dem = stages.dem;
  const int slot = dem.slot_within(x_m, y_m);
  if (slot < 0 || !dem.cell(slot).valid() || !stages.mixture.on_ground(slot)) return Side::unseen;
  const Label label = stages.field.label(slot);
  return label == own ? Side::own : label == no_label ? Side::unseen : Side::other;
}

template <Limits limits>
void CurbPiece<limits>::go_on(const Stages& stages, const Border& border, int link_reach, bool at_start) {
  const float from_x = at_start ? line.x1_m : line.x0_m, from_y = at_start ? line.y1_m : line.y0_m;
  float& end_x = at_start ? line.x0_m : line.x1_m;
  float& end_y = at_start ? line.y0_m : line.y1_m;
  const float dx_m = end_x - from_x, dy_m = end_y - from_y;
  const float length_m = square_root(dx_m * dx_m + dy_m * dy_m);
  if (!(length_m > 0.0f)) return;
  const float pitch_m = 0.5f * (stages.dem.cell_x_m() + stages.dem.cell_y_m());
  const float step_x = dx_m * pitch_m / length_m, step_y = dy_m * pitch_m / length_m;
  const float along = (border.axis == 0 ? line.normal_x : line.normal_y) * border.sign;
  const float aside_m = half_gap_m > pitch_m ? half_gap_m : pitch_m;
  const float to_high_m = along < 0.0f ? -aside_m : aside_m;  // along the normal
  const float high_x = line.normal_x * to_high_m, high_y = line.normal_y * to_high_m;
  const float most = 0.25f * length_m / pitch_m;
  for (int k = 1; 2 * k <= link_reach && static_cast<float>(k) <= most; ++k) {
    const float middle_x = end_x + 0.5f * step_x, middle_y = end_y + 0.5f * step_y;
    const Side high = side(stages, middle_x + high_x, middle_y + high_y, border.high);
    const Side low = side(stages, middle_x - high_x, middle_y - high_y, border.low);
    if (high == Side::other || low == Side::other || (high == Side::unseen && low == Side::unseen)) return;
    if (!even(stages, border, end_x + step_x - from_x, end_y + step_y - from_y)) return;
    end_x += step_x;
    end_y += step_y;
  }
}

template <Limits limits>
Viewpoint CurbPiece<limits>::seen_from(const Stages& stages, const Borders<limits>& borders, int first, int last,
                                       int link_reach, Label lower) {
  const Dem<limits>& dem = stages.dem;
  if (!dem.seen_from_several()) return stages.view;
  float sum_x = 0.0f, sum_y = 0.0f, cells = 0.0f;
  for (int k = first; k <= last; ++k) {
    const Border& border = borders.at(k);
    const int d = direction(border.axis, lower == border.high ? border.sign : -border.sign);
    const float pitch_m = dem.cell_m(border.axis);
    const int reach = link_reach + static_cast<int>(border.half_gap_m / pitch_m);
    int i = static_cast<int>(border.x_m / dem.cell_x_m()), j = static_cast<int>(border.y_m / dem.cell_y_m());
    for (int g = 0; g <= reach && i >= 0 && j >= 0 && i < dem.rows() && j < dem.cols(); ++g) {
      const int slot = dem.slot(i, j);
      if (dem.cell(slot).valid() && stages.field.label(slot) == lower) {
        const Viewpoint view = dem.seen_from(slot, stages.view);
        sum_x += view.x_m;
        sum_y += view.y_m;
        cells += 1.0f;
        break;
      }
      i += step_i[static_cast<std::size_t>(d)];
      j += step_j[static_cast<std::size_t>(d)];
    }
  }
  Viewpoint view = stages.view;
  if (cells > 0.0f) {
    view.x_m = sum_x / cells;
    view.y_m = sum_y / cells;
  }
  return view;
}

}  // namespace curbline
