// Curbs: where two planes meet. Border points are found along every row and column of the window (border_finder.hpp),
// chained into polylines by the pair of planes they part (borders.hpp), and cut into straight pieces of one height.
// Each tells how much higher the far plane is, and keeps its number from call to call. Cost: two passes over the
// window, 50 look-ups a border point, 60 operations for each border of what is left of a chain and each of its pieces,
// and 20 for each pair of a curb and one of the call before.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "curbline/beside.hpp"
#include "curbline/border_finder.hpp"
#include "curbline/borders.hpp"
#include "curbline/counters.hpp"
#include "curbline/curb.hpp"
#include "curbline/dem.hpp"
#include "curbline/label_field.hpp"
#include "curbline/line_fit.hpp"
#include "curbline/math.hpp"
#include "curbline/plane_mixture.hpp"
#include "curbline/settings.hpp"
#include "curbline/shadow.hpp"

namespace curbline {

template <Limits limits>
class CurbTracer {
 public:
  void init(const CurbSettings& settings) {
    settings_ = settings;
    curbs_ = 0;
    last_id_ = 0;
  }

  /// Working memory of one trace().
  struct Work {
    Borders<limits> borders;
    std::array<int, limits.borders / 3 + 1> ends;  ///< of a chain's straight parts, of three borders at least
    std::array<Curb, limits.curbs> curb;
    int curbs;
  };

  /// Finds all curbs of the window, in working memory that is the caller's.
  void trace(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field,
             const Viewpoint& view, Work& work, Counters& counters);

  /// What the last trace() found. Valid until the next.
  std::span<const Curb> curbs() const { return {curb_.data(), static_cast<std::size_t>(curbs_)}; }

 private:
  using Border = typename Borders<limits>::Border;
  struct Stages {
    const Dem<limits>& dem;
    const PlaneMixture<limits>& mixture;
    const LabelField<limits>& field;
    const Viewpoint& view;
  };

  /// Borders that lie on one line; means of what they tell.
  struct Piece {
    LineFit::Segment line{};
    float x_m = 0.0f, y_m = 0.0f;             ///< mean of the borders
    float drop_m = 0.0f, variance_m2 = 0.0f;  ///< of a brink; of the height of the one plane above the other
    float probability = 0.0f, half_gap_m = 0.0f, off_m = 0.0f;
    Beside beside_low{}, beside_high{};  ///< sums
    float place_variance_m2 = 0.0f;      ///< of the borders, across the line
    float gap_m = 0.0f, cell_m = 0.0f;   ///< across it: between the cells' centres; of one cell
    bool low_is_near = false;            ///< the robot stands on the side of the low-numbered plane
    bool low_is_right = false;           ///< of the line, from its first end to its second
  };

  /// The other plane of a border. Where no ground is seen beyond the near one stands for it: no step but the drop, no
  /// known slope.
  static const Plane& beyond(const Stages& stages, const Border& border) {
    return stages.mixture.plane(border.high == no_label<limits> ? border.low : border.high);
  }
  void cut(const Stages& stages, int length, Work& work, Counters& counters) const;
  static Piece piece_of(const Stages& stages, const Borders<limits>& borders, int first, int last);
  /// By how much the height may change along a piece: from its middle to an end by no more than the repeatability of a
  /// range-finder.
  static constexpr float most_change_m = 0.02f;
  static bool even(const Stages& stages, const Border& border, float dx_m, float dy_m);
  /// How far borders lie off their line, in half gaps, is normal, of a variance that is inverse gamma before one is
  /// seen: a0, and b0 as of what lies anywhere from -1 to 1. The prior is 2 b0, to which the sum of the squares is
  /// added.
  static constexpr float place_a0 = 2.0f, place_prior = 2.0f * place_a0 / 3.0f;
  static float weight(const Border& border) { return 1.0f / (border.half_gap_m * border.half_gap_m); }
  static int bend(const Borders<limits>& borders, int first, int last);
  enum class Side : std::uint8_t { unseen, own, other };
  static Side side(const Stages& stages, float x_m, float y_m, Label<limits> own);
  void go_on(const Stages& stages, const Border& border, Piece& piece, bool at_start) const;
  Curb curb_of(const Stages& stages, const Border& border, const Piece& piece) const;
  static float height_variance_m2(const Stages& stages, const Border& border, const Piece& piece, float hidden_m);
  struct Deviations {
    Deviation low, high;
  };
  static Deviations deviations_of(const Stages& stages, const Border& border, const Piece& piece, float height_m,
                                  float shadow_m);
  void give_out(const Stages& stages, int first, int last, int length, Work& work, Counters& counters) const;
  void keep_ids(Work& work, float near_m);

  CurbSettings settings_{};
  std::array<Curb, limits.curbs> curb_{};
  int curbs_ = 0;
  std::uint16_t last_id_ = 0;
};

template <Limits limits>
void CurbTracer<limits>::trace(const Dem<limits>& dem, const PlaneMixture<limits>& mixture,
                               const LabelField<limits>& field, const Viewpoint& view, Work& work, Counters& counters) {
  work.curbs = 0;
  work.borders.clear();
  BorderFinder<limits>(settings_, dem, mixture, field, view).find(work.borders, counters);
  const Stages stages{dem, mixture, field, view};
  for (int b = 0; b < work.borders.size(); ++b) {
    if (!work.borders.chained(b)) cut(stages, work.borders.chain(dem, b, settings_.link_reach), work, counters);
  }
  keep_ids(work, dem.cell_x_m() > dem.cell_y_m() ? 2.0f * dem.cell_x_m() : 2.0f * dem.cell_y_m());
}

/// A curb is the one of the call before that it overlaps most, a step only a step, in the order in which they were
/// found; others get new numbers.
template <Limits limits>
void CurbTracer<limits>::keep_ids(Work& work, float near_m) {
  for (int n = 0; n < work.curbs; ++n) {
    Curb& now = work.curb[static_cast<std::size_t>(n)];
    Curb* same = nullptr;
    float most_m = 0.0f;
    for (int o = 0; o < curbs_; ++o) {
      Curb& before = curb_[static_cast<std::size_t>(o)];
      if (before.id == 0 || is_step(before) != is_step(now)) continue;
      const float length_m = overlap_m(now, before, near_m);
      if (length_m <= most_m) continue;
      most_m = length_m;
      same = &before;
    }
    now.id = 0;
    if (same == nullptr) continue;
    now.id = same->id;
    same->id = 0;  // taken
  }
  for (int n = 0; n < work.curbs; ++n) {
    Curb& curb = curb_[static_cast<std::size_t>(n)];
    curb = work.curb[static_cast<std::size_t>(n)];
    if (curb.id == 0) curb.id = last_id_ = static_cast<std::uint16_t>(last_id_ == 65535 ? 1 : last_id_ + 1);
  }
  curbs_ = work.curbs;
}

/// Splits the chain where it bends, halves what is straight until its height is one, and gives out the pieces in order.
template <Limits limits>
void CurbTracer<limits>::cut(const Stages& stages, int length, Work& work, Counters& counters) const {
  int first = 0;
  const auto even_to = [&](const Border& to) {
    const Border& from = work.borders.at(first);
    return even(stages, from, to.x_m - from.x_m, to.y_m - from.y_m);
  };
  std::size_t parts = 0;  // whose ends are known; the next one's last
  work.ends[parts++] = length - 1;
  while (parts > 0) {
    const int last = work.ends[parts - 1], split = bend(work.borders, first, last);
    if (split >= 0) {
      work.ends[parts++] = split;
      continue;
    }
    --parts;
    while (first <= last) {
      int end = last;
      while (end - first > 1 && !even_to(work.borders.at(end))) end = (first + end) / 2;
      give_out(stages, first, end, length, work, counters);
      first = end + 1;
    }
  }
}

/// The last border of the first of two lines that follow the others better than one does, -1 if one is enough: by the
/// evidence of how far they lie off, in half gaps, normal noise of unknown variance, before it is seen with the weight
/// of four as if each lay anywhere within its gap. Another line has two parameters and a place to begin, each of which
/// costs half the logarithm of the number of borders (Schwarz 1978). Two borders always lie on a line: it takes three
/// to follow one.
template <Limits limits>
int CurbTracer<limits>::bend(const Borders<limits>& borders, int first, int last) {
  LineFit before, after;
  for (int k = first; k <= last; ++k) after.add(borders.at(k).x_m, borders.at(k).y_m, weight(borders.at(k)));
  const float one = after.squares();
  float two = one;
  int found = -1;
  for (int k = first; k <= last - 3; ++k) {
    const Border& border = borders.at(k);
    const float border_weight = weight(border);
    before.add(border.x_m, border.y_m, border_weight);
    after.remove(border.x_m, border.y_m, border_weight);
    if (k < first + 2) continue;
    const float squares = before.squares() + after.squares();
    if (squares >= two) continue;
    two = squares;
    found = k;
  }
  if (found < 0) return -1;
  const auto n = static_cast<float>(last - first + 1);
  const float gain = (place_a0 + 0.5f * n) * log((place_prior + one) / (place_prior + two)) - 1.5f * log(n);
  return gain > 0.0f ? found : -1;
}

/// Is a border's step one height from one place to another, (dx, dy) from it?
template <Limits limits>
bool CurbTracer<limits>::even(const Stages& stages, const Border& border, float dx_m, float dy_m) {
  const Plane& low = stages.mixture.plane(border.low);
  const Plane& high = beyond(stages, border);
  const float change_m = (high.slope_x - low.slope_x) * dx_m + (high.slope_y - low.slope_y) * dy_m;
  return change_m >= -most_change_m && change_m <= most_change_m;
}

/// Fits a line to the borders and takes the mean of what they tell.
template <Limits limits>
auto CurbTracer<limits>::piece_of(const Stages& stages, const Borders<limits>& borders, int first, int last) -> Piece {
  const Dem<limits>& dem = stages.dem;
  const Border& a = borders.at(first);
  const Border& b = borders.at(last);
  const Plane& low = stages.mixture.plane(a.low);
  const Plane& high = beyond(stages, a);
  const auto n = static_cast<float>(last - first + 1);
  const float each = 1.0f / n;
  Piece piece;
  LineFit fit;
  float toward_x = 0.0f, toward_y = 0.0f;  // the high-numbered plane, from the other
  for (int k = first; k <= last; ++k) {
    const Border& border = borders.at(k);
    const float x_m = border.x_m, y_m = border.y_m;
    fit.add(x_m, y_m, weight(border));
    piece.drop_m += each * border.drop_m;
    piece.variance_m2 += each * (high.height_variance_m2(x_m, y_m) + low.height_variance_m2(x_m, y_m));
    piece.probability += each * border.probability;
    piece.half_gap_m += each * border.half_gap_m;
    piece.off_m += each * border.off_m;
    piece.beside_low.add(border.beside_low);
    piece.beside_high.add(border.beside_high);
    (border.axis == 0 ? toward_x : toward_y) += border.sign;
  }
  // Of borders whose errors are alike: the variance expected, in half gaps, times the mean square of half a gap.
  piece.place_variance_m2 = (place_prior + fit.squares()) / (2.0f * place_a0 - 2.0f + n) * n / fit.weight();
  piece.x_m = fit.x_m();
  piece.y_m = fit.y_m();
  const float half_cell_m = 0.25f * (dem.cell_x_m() + dem.cell_y_m());
  piece.line = first == last ? LineFit::across(a.x_m, a.y_m, a.axis, half_cell_m)
                             : fit.segment(a.x_m, a.y_m, b.x_m, b.y_m, half_cell_m);
  const float dx_m = piece.line.x1_m - piece.line.x0_m, dy_m = piece.line.y1_m - piece.line.y0_m;
  piece.low_is_right = dx_m * toward_y - dy_m * toward_x >= 0.0f;
  const bool robot_is_right = dx_m * (stages.view.y_m - piece.line.y0_m) <= dy_m * (stages.view.x_m - piece.line.x0_m);
  piece.low_is_near = a.high == no_label<limits> || piece.low_is_right == robot_is_right;
  for (int k = first; k <= last; ++k) {
    const Border& border = borders.at(k);
    const float cosine = border.axis == 0 ? piece.line.normal_x : piece.line.normal_y;
    const float across = each * (cosine < 0.0f ? -cosine : cosine);
    piece.gap_m += 2.0f * border.half_gap_m * across;
    piece.cell_m += (border.axis == 0 ? dem.cell_x_m() : dem.cell_y_m()) * across;
  }
  return piece;
}

/// What is seen of one side of a line, which should be of the plane `own`.
template <Limits limits>
auto CurbTracer<limits>::side(const Stages& stages, float x_m, float y_m, Label<limits> own) -> Side {
  const Dem<limits>& dem = stages.dem;
  const int slot = dem.slot_at(dem.origin_x_m() + x_m, dem.origin_y_m() + y_m);
  if (slot < 0 || !dem.cell(slot).valid() || !stages.mixture.on_ground(slot)) return Side::unseen;
  const Label<limits> label = stages.field.label(slot);
  return label == own ? Side::own : label == no_label<limits> ? Side::unseen : Side::other;
}

/// Where one of its sides is not seen no border tells of a line. From the end of a chain it goes on cell by cell, as
/// long as one side is that of its plane, the other no other plane's, and its height one; no farther than to the middle
/// of the widest gap that a chain bridges, nor than a quarter of its length, where the variance of where it lies has
/// doubled.
template <Limits limits>
void CurbTracer<limits>::go_on(const Stages& stages, const Border& border, Piece& piece, bool at_start) const {
  LineFit::Segment& line = piece.line;
  const float from_x = at_start ? line.x1_m : line.x0_m, from_y = at_start ? line.y1_m : line.y0_m;
  float& x_m = at_start ? line.x0_m : line.x1_m;
  float& y_m = at_start ? line.y0_m : line.y1_m;
  const float dx_m = x_m - from_x, dy_m = y_m - from_y;
  const float length_m = square_root(dx_m * dx_m + dy_m * dy_m);
  if (!(length_m > 0.0f)) return;
  const float cell_m = 0.5f * (stages.dem.cell_x_m() + stages.dem.cell_y_m());
  const float step_x = dx_m * cell_m / length_m, step_y = dy_m * cell_m / length_m;
  const float along = (border.axis == 0 ? line.normal_x : line.normal_y) * border.sign;
  const float aside_m = piece.half_gap_m > cell_m ? piece.half_gap_m : cell_m;
  const float to_high_m = along < 0.0f ? -aside_m : aside_m;  // along the normal
  const float high_x = line.normal_x * to_high_m, high_y = line.normal_y * to_high_m;
  const float most = 0.25f * length_m / cell_m;
  for (int k = 1; 2 * k <= settings_.link_reach && static_cast<float>(k) <= most; ++k) {
    const float middle_x = x_m + 0.5f * step_x, middle_y = y_m + 0.5f * step_y;
    const Side high = side(stages, middle_x + high_x, middle_y + high_y, border.high);
    const Side low = side(stages, middle_x - high_x, middle_y - high_y, border.low);
    if (high == Side::other || low == Side::other || (high == Side::unseen && low == Side::unseen)) return;
    if (!even(stages, border, x_m + step_x - from_x, y_m + step_y - from_y)) return;
    x_m += step_x;
    y_m += step_y;
  }
}

/// Kind and height as the planes tell them, the labels of both sides.
template <Limits limits>
Curb CurbTracer<limits>::curb_of(const Stages& stages, const Border& border, const Piece& piece) const {
  Curb curb;
  curb.near_label = piece.low_is_near ? border.low : border.high;
  curb.far_label = piece.low_is_near ? border.high : border.low;
  curb.probability = piece.probability < 1.0f ? piece.probability : 1.0f;  // a mean, rounded
  const Plane& low = stages.mixture.plane(border.low);
  const Plane& high = beyond(stages, border);
  const float middle_x = 0.5f * (piece.line.x0_m + piece.line.x1_m);
  const float middle_y = 0.5f * (piece.line.y0_m + piece.line.y1_m);
  const float height_m = high.height_m(middle_x, middle_y) - low.height_m(middle_x, middle_y) - piece.drop_m;
  const float cell_x_m = stages.dem.cell_x_m(), cell_y_m = stages.dem.cell_y_m();
  const float reach_m = static_cast<float>(settings_.link_reach) * (cell_x_m < cell_y_m ? cell_x_m : cell_y_m);
  const Deviations sides = deviations_of(stages, border, piece, height_m, 0.0f);
  const float height_sd_m = square_root(piece.variance_m2 + sides.low.too_far_m2() + sides.high.too_far_m2());
  curb.kind =
      kind_of(low, high, piece.line, {height_m, height_sd_m, piece.half_gap_m, reach_m, stages.dem.prior().texture_m2});
  if (curb.kind != CurbKind::step_up) return curb;
  curb.height_m = piece.low_is_near ? height_m : -height_m;
  if (curb.height_m < 0.0f) curb.kind = CurbKind::step_down;
  return curb;
}

/// How the ground lies off its planes beside a piece of which the height is above 0 if `high` is the higher plane. Both
/// sides begin at the near end of a shadow, in the middle of which the borders lie.
template <Limits limits>
auto CurbTracer<limits>::deviations_of(const Stages& stages, const Border& border, const Piece& piece, float height_m,
                                       float shadow_m) -> Deviations {
  const float up = height_m < 0.0f ? -1.0f : 1.0f;
  const float beyond_cells = (piece.low_is_near ? 0.5f : -0.5f) * shadow_m / piece.cell_m;
  return {deviation(piece.beside_low, stages.mixture.plane(border.low), -up, -beyond_cells),
          deviation(piece.beside_high, beyond(stages, border), up, beyond_cells)};
}

/// The errors of a plane are common to the piece: they do not average out. Planes of different slope differ as much as
/// the border's place does. What the cells beside the border lie off their planes may be the planes' fault too, up to a
/// quarter of it, evenly: as a rule they hold points of both sides, and those that show it, or bear another plane, have
/// no part in the fit. Behind a brink as much again as is seen, `hidden_m`, may be hidden, or less, evenly.
template <Limits limits>
float CurbTracer<limits>::height_variance_m2(const Stages& stages, const Border& border, const Piece& piece,
                                             float hidden_m) {
  const Plane& low = stages.mixture.plane(border.low);
  const Plane& high = beyond(stages, border);
  const float slope =
      (high.slope_x - low.slope_x) * piece.line.normal_x + (high.slope_y - low.slope_y) * piece.line.normal_y;
  return piece.variance_m2 + square(slope) * piece.place_variance_m2 + square(piece.off_m) * (1.0f / 48) +
         square(hidden_m) * (1.0f / 3);
}

template <Limits limits>
void CurbTracer<limits>::give_out(const Stages& stages, int first, int last, int length, Work& work,
                                  Counters& counters) const {
  if (work.curbs == limits.curbs) {
    ++counters.curbs_full;
    return;
  }
  const Border& border = work.borders.at(first);
  Piece piece = piece_of(stages, work.borders, first, last);
  if (first == 0) go_on(stages, border, piece, true);
  if (last == length - 1) go_on(stages, border, piece, false);
  Curb curb = curb_of(stages, border, piece);
  const bool one_sided = border.high == no_label<limits>;
  if (one_sided && is_step(curb) && first == last) return;  // a row's or column's alone is no line
  float variance_m2 = height_variance_m2(stages, border, piece, one_sided ? curb.height_m : 0.0f);
  float shadow_m = 0.0f;
  if (curb.kind == CurbKind::step_down && !one_sided) {
    const float above_m = stages.view.z_m - stages.mixture.plane(curb.near_label).height_m(piece.x_m, piece.y_m);
    shadow_m = move_before_shadow(piece.line, stages.view, {-curb.height_m, above_m, piece.gap_m + piece.cell_m});
  }
  if (is_step(curb)) {
    const float toward = curb.height_m < 0.0f ? -1.0f : 1.0f;
    const auto [low, high] = deviations_of(stages, border, piece, piece.low_is_near ? toward : -toward, shadow_m);
    for (const Deviation& side : {low, high}) {
      if (side.found()) curb.height_m += toward * side.away_m;
      variance_m2 += side.height_variance_m2();
    }
  }
  if (curb.height_m > settings_.max_step_m || curb.height_m < -settings_.max_step_m) return;
  curb.height_sd_m = square_root(variance_m2);
  const float width_m = piece.gap_m - piece.cell_m - shadow_m;
  curb.face_width_m = width_m > 0.0f && !one_sided ? width_m : 0.0f;
  if (piece.low_is_right != piece.low_is_near) {
    std::swap(piece.line.x0_m, piece.line.x1_m);
    std::swap(piece.line.y0_m, piece.line.y1_m);
  }
  curb.x0_m = stages.dem.origin_x_m() + piece.line.x0_m;
  curb.y0_m = stages.dem.origin_y_m() + piece.line.y0_m;
  curb.x1_m = stages.dem.origin_x_m() + piece.line.x1_m;
  curb.y1_m = stages.dem.origin_y_m() + piece.line.y1_m;
  work.curb[static_cast<std::size_t>(work.curbs++)] = curb;
}

}  // namespace curbline
