// Curbs: where two planes meet. Border points are found along every row and column of the window (border_finder.hpp),
// chained into polylines by the pair of planes they part (borders.hpp), and cut into straight pieces of one height.
// Each tells how much higher the far plane is, and keeps its number from call to call. Cost: two passes over the
// window, a third where there is a deep drop, 50 look-ups a border point, as many again for one with an empty cell in
// its gap, 60 operations for each border of what is left of a chain and each of its pieces, and 20 for each pair of
// curbs, and of one and one of the call before.
#pragma once

#include <algorithm>
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
#include "curbline/curb_piece.hpp"
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
    std::array<bool, limits.curbs> told;  ///< told_by_longer()
    int curbs;
    const Plane* nearest_ground;  ///< null until a deep drop asks for it
  };

  /// Finds all curbs of the window, in working memory that is the caller's.
  void trace(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field,
             const Viewpoint& view, Work& work, Counters& counters);

  /// What the last trace() found. Valid until the next.
  std::span<const Curb> curbs() const { return {curb_.data(), static_cast<std::size_t>(curbs_)}; }

 private:
  using Border = typename Borders<limits>::Border;
  using Stages = CurbStages<limits>;
  using Piece = CurbPiece<limits>;

  void cut(const Stages& stages, int length, Work& work, Counters& counters) const;
  static int bend(const Borders<limits>& borders, int first, int last);
  Curb curb_of(const Stages& stages, const Border& border, const Piece& piece) const;
  float leave_shadow(const Stages& stages, const Borders<limits>& borders, int first, int last, Curb& curb,
                     Piece& piece) const;
  static float carried_m(const Plane& plane, float dx_m, float dy_m);
  static float height_variance_m2(const Stages& stages, const Border& border, const Piece& piece, float hidden_m);
  static float place_variance_m2(const Stages& stages, const Border& border, const Piece& piece, const Curb& curb,
                                 float height_variance_m2);
  static float more_from_afar_m2(const Stages& stages, const Plane& plane, const Piece& piece);
  struct Deviations {
    Deviation low, high;
  };
  static Deviations deviations_of(const Stages& stages, const Border& border, const Piece& piece, float height_m,
                                  float shadow_m);
  static const Plane& nearest_ground(const Stages& stages);
  bool obstacle(const Stages& stages, const Curb& curb, const Piece& piece, Work& work) const;
  void give_out(const Stages& stages, int first, int last, int length, Work& work, Counters& counters) const;
  static void tell_once(Work& work, float cell_m);
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
  work.nearest_ground = nullptr;
  work.borders.clear();
  BorderFinder<limits>(settings_, dem, mixture, field, view).find(work.borders, counters);
  const Stages stages{dem, mixture, field, view};
  for (int b = 0; b < work.borders.size(); ++b) {
    if (!work.borders.chained(b)) cut(stages, work.borders.chain(dem, b, settings_.link_reach), work, counters);
  }
  const float cell_m = dem.cell_x_m() > dem.cell_y_m() ? dem.cell_x_m() : dem.cell_y_m();
  tell_once(work, cell_m);
  keep_ids(work, 2.0f * cell_m);
}

template <Limits limits>
void CurbTracer<limits>::tell_once(Work& work, float cell_m) {
  const auto found = static_cast<std::size_t>(work.curbs);
  told_by_longer(std::span(work.curb.data(), found), cell_m, work.told);
  work.curbs = 0;
  for (std::size_t k = 0; k < found; ++k) {
    if (!work.told[k]) work.curb[static_cast<std::size_t>(work.curbs++)] = work.curb[k];
  }
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
  const std::span<const Curb> kept(work.curb.data(), static_cast<std::size_t>(work.curbs));
  const auto new_id = [&] {
    do {
      last_id_ = static_cast<std::uint16_t>(last_id_ == 65535 ? 1 : last_id_ + 1);
    } while (std::any_of(kept.begin(), kept.end(), [this](const Curb& curb) { return curb.id == last_id_; }));
    return last_id_;
  };
  for (int n = 0; n < work.curbs; ++n) {
    Curb& curb = curb_[static_cast<std::size_t>(n)];
    curb = work.curb[static_cast<std::size_t>(n)];
    if (curb.id == 0) curb.id = new_id();
  }
  curbs_ = work.curbs;
}

/// Splits the chain where it bends, halves what is straight until its height is one, and gives out the pieces in order.
template <Limits limits>
void CurbTracer<limits>::cut(const Stages& stages, int length, Work& work, Counters& counters) const {
  int first = 0;
  const auto even_to = [&](const Border& to) {
    const Border& from = work.borders.at(first);
    return Piece::even(stages, from, to.x_m - from.x_m, to.y_m - from.y_m);
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
/// of four as if each lay anywhere within its gap. All open borders are one observation together. Another line has two
/// parameters and a place to begin, each of which costs half the logarithm of the number of borders (Schwarz 1978). Two
/// borders always lie on a line: it takes three to follow one.
template <Limits limits>
int CurbTracer<limits>::bend(const Borders<limits>& borders, int first, int last) {
  LineFit before, after;
  const float open_share = Piece::open_share(borders, first, last);
  const auto weight = [&](const Border& border) { return Piece::weight(border) * Piece::share(border, open_share); };
  float n = 0.0f;
  for (int k = first; k <= last; ++k) {
    const Border& border = borders.at(k);
    after.add(border.x_m, border.y_m, weight(border));
    n += Piece::share(border, open_share);
  }
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
  const float gain =
      (Piece::place_a0 + 0.5f * n) * log((Piece::place_prior + one) / (Piece::place_prior + two)) - 1.5f * log(n);
  return gain > 0.0f ? found : -1;
}

/// Kind and height as the planes tell them, the labels of both sides.
template <Limits limits>
Curb CurbTracer<limits>::curb_of(const Stages& stages, const Border& border, const Piece& piece) const {
  Curb curb;
  curb.near_label = piece.low_is_near ? border.low : border.high;
  curb.far_label = piece.low_is_near ? border.high : border.low;
  curb.probability = piece.probability < 1.0f ? piece.probability : 1.0f;  // a mean, rounded
  const Plane& low = stages.mixture.plane(border.low);
  const Plane& high = stages.beyond(border);
  const float middle_x = 0.5f * (piece.line.x0_m + piece.line.x1_m);
  const float middle_y = 0.5f * (piece.line.y0_m + piece.line.y1_m);
  const float height_m = high.height_m(middle_x, middle_y) - low.height_m(middle_x, middle_y) - piece.drop_m;
  const Deviations sides = deviations_of(stages, border, piece, height_m, 0.0f);
  const float too_far_m2 = sides.low.too_far_m2(piece.borders) + sides.high.too_far_m2(piece.borders);
  const float height_sd_m = square_root(piece.variance_m2 + too_far_m2);
  curb.kind =
      kind_of(low, high, piece.line,
              {height_m, height_sd_m, piece.half_gap_m, piece.place_variance_m2, stages.dem.prior().texture_m2});
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
  const float beyond_cells = -0.5f * up * shadow_m / piece.cell_m;
  const float common_m2 = stages.dem.prior().common_m2();
  return {deviation(piece.beside_low, stages.mixture.plane(border.low), -up, -beyond_cells, common_m2),
          deviation(piece.beside_high, stages.beyond(border), up, beyond_cells, common_m2)};
}

/// The errors of a plane are common to the piece: they do not average out. Planes of different slope differ as much as
/// the border's place does. Behind a brink as much again as is seen, `hidden_m`, may be hidden, or less, evenly.
template <Limits limits>
float CurbTracer<limits>::height_variance_m2(const Stages& stages, const Border& border, const Piece& piece,
                                             float hidden_m) {
  const Plane& low = stages.mixture.plane(border.low);
  const Plane& high = stages.beyond(border);
  const float slope =
      (high.slope_x - low.slope_x) * piece.line.normal_x + (high.slope_y - low.slope_y) * piece.line.normal_y;
  return piece.variance_m2 + more_from_afar_m2(stages, low, piece) + more_from_afar_m2(stages, high, piece) +
         square(slope) * piece.place_variance_m2 + square(hidden_m) * (1.0f / 3);
}

/// Of a piece's middle, across it.
template <Limits limits>
float CurbTracer<limits>::place_variance_m2(const Stages& stages, const Border& border, const Piece& piece,
                                            const Curb& curb, float height_variance_m2) {
  if (!is_step(curb) || border.high == no_label) return piece.borders_variance_m2;
  const float cell_variance_m2 =
      0.5f * (stages.mixture.plane(border.low).fit_variance_m2 + stages.mixture.plane(border.high).fit_variance_m2);
  return piece.told_variance_m2 + piece.shifted_m2(curb.height_m, height_variance_m2, cell_variance_m2);
}

/// By how much more a plane errs beside a piece than its fit says, which takes what cells share for the same wherever
/// they lie.
template <Limits limits>
float CurbTracer<limits>::more_from_afar_m2(const Stages& stages, const Plane& plane, const Piece& piece) {
  const float reach_m2 = stages.view.reach_m2(plane.x_m, plane.y_m, plane.scatter_m2, plane.points_a_cell);
  const float more_m2 = stages.dem.common_m2(reach_m2) - plane.fit_variance_m2;
  return more_m2 > 0.0f ? more_m2 / plane.fit_variance_m2 * plane.height_variance_m2(piece.x_m, piece.y_m) : 0.0f;
}

/// A step hides what lies behind it from a laser on its upper side: on which the robot need not be any more. It is as
/// high as its planes lie apart at the edge, where its line moves to. Returns how wide the shadow is.
template <Limits limits>
float CurbTracer<limits>::leave_shadow(const Stages& stages, const Borders<limits>& borders, int first, int last,
                                       Curb& curb, Piece& piece) const {
  const bool down = curb.height_m < 0.0f;
  const std::uint16_t upper = down ? curb.near_label : curb.far_label, lower = down ? curb.far_label : curb.near_label;
  const Viewpoint view =
      Piece::seen_from(stages, borders, first, last, settings_.link_reach, static_cast<Label>(lower));
  const bool upper_is_right = (upper == borders.at(first).low) == piece.low_is_right;
  if (piece.has_right(view) != upper_is_right) return 0.0f;
  const Plane& above = stages.mixture.plane(upper);
  const Plane& below = stages.mixture.plane(lower);
  const float above_m = view.z_m - above.height_m(piece.x_m, piece.y_m);
  const float drop_m = down ? -curb.height_m : curb.height_m;
  const float x_m = piece.line.x0_m, y_m = piece.line.y0_m;
  const float shadow_m = move_before_shadow(piece.line, view, {drop_m, above_m, piece.gap_m + piece.cell_m});
  const float dx_m = piece.line.x0_m - x_m, dy_m = piece.line.y0_m - y_m;
  const float rise_m = carried_m(above, dx_m, dy_m) - carried_m(below, dx_m, dy_m);
  curb.height_m += down ? -rise_m : rise_m;
  curb.kind = curb.height_m < 0.0f ? CurbKind::step_down : CurbKind::step_up;
  return shadow_m;
}

/// What a plane rises on the way to where nothing of it is seen: less than its slope makes, by the share that the
/// square of that way has beside the mean square of how far its cells reach along it. A strip of two rows, of which one
/// holds something of the other side, tells no slope to go by.
template <Limits limits>
float CurbTracer<limits>::carried_m(const Plane& plane, float dx_m, float dy_m) {
  const float beyond = plane.rise_variance_m2(dx_m, dy_m) * plane.cells / plane.fit_variance_m2;
  return (plane.slope_x * dx_m + plane.slope_y * dy_m) / (1.0f + beyond);
}

/// The plane that is borne nearest to the laser: the robot's own ground, as far as is seen.
template <Limits limits>
const Plane& CurbTracer<limits>::nearest_ground(const Stages& stages) {
  int nearest = 0;
  float least_m2 = -1.0f;
  stages.dem.for_each_valid([&](int i, int j, int s) {
    if (stages.field.label(s) == no_label || !stages.mixture.on_ground(s)) return;
    const float away_m2 = square((static_cast<float>(i) + 0.5f) * stages.dem.cell_x_m() - stages.view.x_m) +
                          square((static_cast<float>(j) + 0.5f) * stages.dem.cell_y_m() - stages.view.y_m);
    if (least_m2 >= 0.0f && away_m2 >= least_m2) return;
    least_m2 = away_m2;
    nearest = stages.field.label(s);
  });
  return stages.mixture.plane(nearest);
}

/// Is a step the side of an obstacle: higher than any, or the drop behind one, from where no robot gets to?
template <Limits limits>
bool CurbTracer<limits>::obstacle(const Stages& stages, const Curb& curb, const Piece& piece, Work& work) const {
  if (curb.height_m >= -settings_.max_step_m) return curb.height_m > settings_.max_step_m;
  const Plane& near = stages.mixture.plane(curb.near_label);
  if (work.nearest_ground == nullptr) work.nearest_ground = &nearest_ground(stages);
  return near.height_m(piece.x_m, piece.y_m) - work.nearest_ground->height_m(piece.x_m, piece.y_m) >
         settings_.max_step_m;
}

template <Limits limits>
void CurbTracer<limits>::give_out(const Stages& stages, int first, int last, int length, Work& work,
                                  Counters& counters) const {
  if (work.curbs == limits.curbs) {
    ++counters.curbs_full;
    return;
  }
  const Border& border = work.borders.at(first);
  Piece piece = Piece::of(stages, work.borders, first, last);
  if (first == 0) piece.go_on(stages, border, settings_.link_reach, true);
  if (last == length - 1) piece.go_on(stages, border, settings_.link_reach, false);
  Curb curb = curb_of(stages, border, piece);
  const bool one_sided = border.high == no_label;
  if (one_sided && is_step(curb) && first == last) return;  // a row's or column's alone is no line
  float variance_m2 = height_variance_m2(stages, border, piece, one_sided ? curb.height_m : 0.0f);
  const float shadow_m =
      is_step(curb) && !one_sided ? leave_shadow(stages, work.borders, first, last, curb, piece) : 0.0f;
  if (is_step(curb)) {
    const float toward = curb.height_m < 0.0f ? -1.0f : 1.0f;
    const auto [low, high] = deviations_of(stages, border, piece, piece.low_is_near ? toward : -toward, shadow_m);
    for (const Deviation& side : {low, high}) {
      if (side.found()) curb.height_m += toward * side.away_m;
      variance_m2 += side.height_variance_m2();
    }
  }
  if (obstacle(stages, curb, piece, work)) return;
  curb.position_sd_m = square_root(place_variance_m2(stages, border, piece, curb, variance_m2));
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
