// Makes a curb of a straight part of a chain of borders: its kind, height (step_height.hpp), position and their
// deviations. Cost: 60 operations a border, and eight cells beside each border of a step.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "curbline/borders/border.hpp"
#include "curbline/borders/curb_stages.hpp"
#include "curbline/curbs/curb.hpp"
#include "curbline/curbs/curb_piece.hpp"
#include "curbline/curbs/plane_pair.hpp"
#include "curbline/curbs/step_height.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// Lives for one CurbTracer::trace().
template <Limits limits>
class CurbMaker {
 public:
  explicit CurbMaker(const CurbStages<limits>& stages) : stages_(stages) {
    raised_m2_.fill(std::numeric_limits<float>::infinity());
  }

  PlanePair planes_of(const Border& border) const { return Piece::planes_of(stages_, border); }

  /// The curb; none for the side of an obstacle, where neither borders nor the ground beside them tell which side is
  /// which, or for a step without ground in view behind that is seen on a single row or column, or from the side where
  /// that ground would be: from there its face is in view.
  std::optional<Curb> make(const ChainPart& part);

  /// Is it the drop behind an obstacle, where no robot gets to: does a step up that is higher than any curb lead onto
  /// its near side, nearer to the laser? Behind a pit such a step leads up to the same ground. Call when all are made.
  bool behind_obstacle(const Curb& curb) const {
    const float x_m = 0.5f * (curb.x0_m + curb.x1_m) - stages_.dem.origin_x_m();
    const float y_m = 0.5f * (curb.y0_m + curb.y1_m) - stages_.dem.origin_y_m();
    return curb.height_m < -stages_.settings.max_step_m && raised_m2_[curb.near_label] < away_m2(x_m, y_m);
  }

 private:
  using Piece = CurbPiece<limits>;

  static Curb without_height(const Piece& piece);
  static float place_variance_m2(const Piece& piece, const Curb& curb, float height_variance_m2);
  void set_ends(const Piece& piece, Curb& curb) const;
  float away_m2(float x_m, float y_m) const { return square(x_m - stages_.view.x_m) + square(y_m - stages_.view.y_m); }

  const CurbStages<limits>& stages_;
  std::array<float, limits.planes> raised_m2_;  ///< to the nearest step up onto each plane that is higher than any curb
};

template <Limits limits>
std::optional<Curb> CurbMaker<limits>::make(const ChainPart& part) {
  Piece piece(stages_, part);
  if (!piece.sides_known) return std::nullopt;
  if (part.ends.first) piece.go_on(Piece::End::first);
  if (part.ends.second) piece.go_on(Piece::End::second);
  StepHeight<limits> step(piece);
  Curb curb = without_height(piece);
  curb.kind = piece.planes.kind(piece.line, step.measured());
  const bool one_sided = piece.one_sided();
  if (one_sided && is_step(curb)) {
    if (part.size() == 1) return std::nullopt;  // a single row or column makes no line
    const bool from_behind = piece.seen_from_other(stages_.view);
    if (from_behind && piece.seen_from_other(step.seen_from(piece.first.one))) return std::nullopt;
  }
  step.refine(is_step(curb));
  if (is_step(curb)) curb.height_m = piece.one_is_near ? step.height_m() : -step.height_m();
  if (curb.height_m < 0.0f) curb.kind = CurbKind::step_down;
  // The side of an obstacle; it has a far plane, as what ends unseen is a drop or a crease.
  if (curb.height_m > stages_.settings.max_step_m) {
    float& nearest_m2 = raised_m2_[curb.far_label];
    nearest_m2 = std::min(nearest_m2, away_m2(piece.x_m, piece.y_m));
    return std::nullopt;
  }
  const float place_m2 = place_variance_m2(piece, curb, step.variance_m2());
  curb.position_sd_m = square_root(place_m2);
  step.doubt_place(place_m2);
  curb.height_sd_m = square_root(step.variance_m2());
  const float width_m = piece.gap_m - piece.cell_m - step.shadow_m();
  curb.face_width_m = one_sided ? 0.0f : std::max(0.0f, width_m);
  set_ends(piece, curb);
  return curb;
}

template <Limits limits>
Curb CurbMaker<limits>::without_height(const Piece& piece) {
  Curb curb;
  curb.near_label = piece.one_is_near ? piece.first.one : piece.first.other;
  curb.far_label = piece.one_is_near ? piece.first.other : piece.first.one;
  curb.probability = std::min(1.0f, piece.probability);  // a mean, rounded
  return curb;
}

/// Variance of a piece's position, at its middle, across it.
template <Limits limits>
float CurbMaker<limits>::place_variance_m2(const Piece& piece, const Curb& curb, float height_variance_m2) {
  if (!is_step(curb) || piece.one_sided()) return piece.borders_variance_m2;
  const float cell_variance_m2 = 0.5f * (piece.planes.one.fit_variance_m2 + piece.planes.other.fit_variance_m2);
  return piece.located_variance_m2 + piece.shifted_m2(curb.height_m, height_variance_m2, cell_variance_m2);
}

/// Sets the ends, in the map frame, with the near side to the right looking from the first to the second.
template <Limits limits>
void CurbMaker<limits>::set_ends(const Piece& piece, Curb& curb) const {
  const float x_m = stages_.dem.origin_x_m(), y_m = stages_.dem.origin_y_m();
  curb.x0_m = x_m + piece.line.x0_m;
  curb.y0_m = y_m + piece.line.y0_m;
  curb.x1_m = x_m + piece.line.x1_m;
  curb.y1_m = y_m + piece.line.y1_m;
  if (piece.one_is_right == piece.one_is_near) return;
  std::swap(curb.x0_m, curb.x1_m);
  std::swap(curb.y0_m, curb.y1_m);
}

}  // namespace curbline
