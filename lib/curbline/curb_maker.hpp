// Makes a curb of a straight part of a chain of borders: what kind it is and how high, by its planes and by the ground
// beside it; where it lies, which of a step down is before its shadow; and how well all of that is known. Cost: 60
// operations a border, eight cells beside each border of a step, and a pass over the window where there is a deep drop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "curbline/beside.hpp"
#include "curbline/borders.hpp"
#include "curbline/curb.hpp"
#include "curbline/curb_piece.hpp"
#include "curbline/curb_stages.hpp"
#include "curbline/dem.hpp"
#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"
#include "curbline/settings.hpp"
#include "curbline/shadow.hpp"

namespace curbline {

/// For one call of CurbTracer::trace().
template <Limits limits>
class CurbMaker {
 public:
  using Border = typename Borders<limits>::Border;
  using Part = typename Borders<limits>::Part;

  CurbMaker(const CurbSettings& settings, const CurbStages<limits>& stages) : settings_(settings), stages_(stages) {}

  PlanePair planes_of(const Border& border) const { return Piece::planes_of(stages_, border); }

  /// Which ends of its chain a part is at.
  struct Ends {
    bool first, last;
  };
  /// None of the side of an obstacle, nor of a step that only one row or column shows and no ground behind.
  std::optional<Curb> make(const Part& part, const Ends& at);

 private:
  using Piece = CurbPiece<limits>;

  Curb as_planes_tell(const Piece& piece) const;
  float leave_shadow(const Part& part, Curb& curb, Piece& piece) const;
  static float carried_m(const Plane& plane, float dx_m, float dy_m);
  GroundAlong ground_along(const Part& part, const Piece& piece, Label label) const;
  void follow_ground(const Part& part, Piece& piece, float shadow_m, Curb& curb, float& variance_m2) const;
  void follow_ground_beside(const Piece& piece, float shadow_m, Curb& curb, float& variance_m2) const;
  struct Deviations {
    Deviation low, high;
  };
  // Called: inlined three times it takes 320 bytes of flash more.
  [[gnu::noinline]] Deviations deviations_of(const Piece& piece, float height_m, float shadow_m) const;
  Deviations deviations_of(const Piece& piece, const Curb& curb, float shadow_m) const {
    return deviations_of(piece, piece.low_is_near ? curb.height_m : -curb.height_m, shadow_m);
  }
  float plane_variance_m2(const Plane& plane, const Piece& piece) const;
  static float place_variance_m2(const Piece& piece, const Curb& curb, float height_variance_m2);
  bool obstacle(const Curb& curb, const Piece& piece);
  const Plane& nearest_ground();
  void set_ends(const Piece& piece, Curb& curb) const;

  const CurbSettings& settings_;
  const CurbStages<limits>& stages_;
  const Plane* nearest_ground_ = nullptr;  ///< until a deep drop asks for it
};

template <Limits limits>
std::optional<Curb> CurbMaker<limits>::make(const Part& part, const Ends& at) {
  Piece piece(stages_, part);
  if (at.first) piece.go_on(stages_, settings_.link_reach, Piece::End::first);
  if (at.last) piece.go_on(stages_, settings_.link_reach, Piece::End::second);
  Curb curb = as_planes_tell(piece);
  const bool one_sided = piece.one_sided();
  if (one_sided && is_step(curb) && part.size() == 1) return std::nullopt;  // a row's or column's alone is no line
  const bool two_sided_step = is_step(curb) && !one_sided;
  const float shadow_m = two_sided_step ? leave_shadow(part, curb, piece) : 0.0f;
  // The errors of a plane are common to the piece: they do not average out. Behind a brink as much again as is seen may
  // be hidden, or less, evenly.
  float variance_m2 = plane_variance_m2(piece.planes.low, piece) + plane_variance_m2(piece.planes.high, piece) +
                      (one_sided ? square(curb.height_m) * (1.0f / 3) : 0.0f);
  if (two_sided_step) follow_ground(part, piece, shadow_m, curb, variance_m2);
  if (is_step(curb)) follow_ground_beside(piece, shadow_m, curb, variance_m2);
  if (curb.height_m < 0.0f) curb.kind = CurbKind::step_down;
  if (obstacle(curb, piece)) return std::nullopt;
  // Planes of different slope differ as much as the borders' place does. Rough ground hangs over its edge, anywhere
  // within its roughness, evenly.
  variance_m2 += square(piece.planes.slope_across(piece.line)) * piece.place_variance_m2 +
                 (piece.planes.low.rough_m2 + piece.planes.high.rough_m2) * (1.0f / 3);
  curb.position_sd_m = square_root(place_variance_m2(piece, curb, variance_m2));
  curb.height_sd_m = square_root(variance_m2);
  const float width_m = piece.gap_m - piece.cell_m - shadow_m;
  curb.face_width_m = one_sided ? 0.0f : std::max(0.0f, width_m);
  set_ends(piece, curb);
  return curb;
}

/// Kind, height and the labels of both sides. A step is step_up until make() knows its height.
template <Limits limits>
Curb CurbMaker<limits>::as_planes_tell(const Piece& piece) const {
  Curb curb;
  curb.near_label = piece.low_is_near ? piece.first.low : piece.first.high;
  curb.far_label = piece.low_is_near ? piece.first.high : piece.first.low;
  curb.probability = std::min(1.0f, piece.probability);  // a mean, rounded
  const auto [low, high] = piece.planes;
  const float x_m = piece.middle_x_m(), y_m = piece.middle_y_m();
  const float height_m = high.height_m(x_m, y_m) - low.height_m(x_m, y_m) - piece.drop_m;
  const Deviations sides = deviations_of(piece, height_m, 0.0f);
  const float too_far_m2 = sides.low.too_far_m2(piece.borders) + sides.high.too_far_m2(piece.borders);
  const float height_sd_m = square_root(piece.variance_m2(low) + piece.variance_m2(high) + too_far_m2);
  curb.kind =
      kind_of(low, high, piece.line,
              {height_m, height_sd_m, piece.half_gap_m, piece.place_variance_m2, stages_.dem.prior().texture_m2});
  if (is_step(curb)) curb.height_m = piece.low_is_near ? height_m : -height_m;
  return curb;
}

/// A step hides what lies behind it from a laser on its upper side: on which the robot need not be any more. It is as
/// high as its planes lie apart at the edge, where its line moves to. Returns how wide the shadow is.
template <Limits limits>
float CurbMaker<limits>::leave_shadow(const Part& part, Curb& curb, Piece& piece) const {
  const bool down = curb.height_m < 0.0f;
  const Label upper = down ? curb.near_label : curb.far_label, lower = down ? curb.far_label : curb.near_label;
  const Viewpoint view = Piece::seen_from(stages_, part, settings_.link_reach, lower);
  const bool upper_is_right = (upper == piece.first.low) == piece.low_is_right;
  if (piece.has_right(view) != upper_is_right) return 0.0f;
  const Plane& above = stages_.mixture.plane(upper);
  const Plane& below = stages_.mixture.plane(lower);
  const float above_m = view.z_m - above.height_m(piece.x_m, piece.y_m);
  const float drop_m = down ? -curb.height_m : curb.height_m;
  const float x_m = piece.line.x0_m, y_m = piece.line.y0_m;
  const float shadow_m = move_before_shadow(piece.line, view, {drop_m, above_m, piece.gap_m + piece.cell_m});
  const float dx_m = piece.line.x0_m - x_m, dy_m = piece.line.y0_m - y_m;
  const float rise_m = carried_m(above, dx_m, dy_m) - carried_m(below, dx_m, dy_m);
  curb.height_m += down ? -rise_m : rise_m;
  return shadow_m;
}

/// What a plane rises on the way to where nothing of it is seen: less than its slope makes, by the share that the
/// square of that way has beside the mean square of how far its cells reach along it. A strip of two rows, of which one
/// holds something of the other side, tells no slope to go by.
template <Limits limits>
float CurbMaker<limits>::carried_m(const Plane& plane, float dx_m, float dy_m) {
  const float beyond = plane.rise_variance_m2(dx_m, dy_m) * plane.cells / plane.fit_variance_m2;
  return (plane.slope_x * dx_m + plane.slope_y * dy_m) / (1.0f + beyond);
}

/// As the cells of a side tell that lie a little farther from the borders of a piece, on those of rows and columns that
/// lie more across it: each cell once.
template <Limits limits>
GroundAlong CurbMaker<limits>::ground_along(const Part& part, const Piece& piece, Label label) const {
  const Dem<limits>& dem = stages_.dem;
  const Plane& plane = stages_.mixture.plane(label);
  const float slope_m2 = dem.slope_m2(plane);
  const int across = magnitude(piece.line.normal_x) < magnitude(piece.line.normal_y);
  float cells = 0.0f, above_m = 0.0f;
  for (const Border& border : part) {
    if (border.axis != across) continue;
    const std::size_t d = border.toward(label);
    int i = static_cast<int>(border.x_m / dem.cell_x_m()), j = static_cast<int>(border.y_m / dem.cell_y_m());
    for (int k = 1; k <= GroundAlong::farthest; ++k) {
      i += step_i[d];
      j += step_j[d];
      if (!dem.contains(i, j)) break;
      const int s = dem.slot(i, j);
      if (k < GroundAlong::nearest || !stages_.holds_alone(s, label, slope_m2)) continue;
      cells += 1.0f;
      above_m += dem.above_m(i, j, dem.cell(s), plane);
    }
  }
  return GroundAlong::of(cells, above_m, plane);
}

/// A step is as high as the ground along it, where that lies off the planes. What the cells next to it lie off is then
/// told from there. Where those tell on their own they are nearer: of a gutter three cells wide and the road beside it
/// the mean would be told.
template <Limits limits>
void CurbMaker<limits>::follow_ground(const Part& part, Piece& piece, float shadow_m, Curb& curb,
                                      float& variance_m2) const {
  const Deviations beside = deviations_of(piece, curb, shadow_m);
  for (const bool high : {false, true}) {
    if ((high ? beside.high : beside.low).found()) continue;
    const Plane& plane = high ? piece.planes.high : piece.planes.low;
    const GroundAlong ground = ground_along(part, piece, high ? piece.first.high : piece.first.low);
    curb.height_m += high == piece.low_is_near ? ground.above_m : -ground.above_m;
    variance_m2 += ground.share * (ground.variance_m2 - plane_variance_m2(plane, piece));
    Beside& told = high ? piece.beside_high : piece.beside_low;
    told.off_m -= told.borders * ground.above_m;
  }
}

/// A step is as high as the ground beside it, where that lies off the planes, and as well known.
template <Limits limits>
void CurbMaker<limits>::follow_ground_beside(const Piece& piece, float shadow_m, Curb& curb, float& variance_m2) const {
  const float toward = curb.height_m < 0.0f ? -1.0f : 1.0f;
  const auto [low, high] = deviations_of(piece, curb, shadow_m);
  for (const Deviation& side : {low, high}) {
    if (side.found()) curb.height_m += toward * side.away_m;
    variance_m2 += side.height_variance_m2();
  }
}

/// How the ground lies off its planes beside a piece of which the height is above 0 if `high` is the higher plane. Both
/// sides begin at the near end of a shadow, in the middle of which the borders lie.
template <Limits limits>
auto CurbMaker<limits>::deviations_of(const Piece& piece, float height_m, float shadow_m) const -> Deviations {
  const float up = height_m < 0.0f ? -1.0f : 1.0f;
  const float beyond_cells = -0.5f * up * shadow_m / piece.cell_m;
  const float common_m2 = stages_.dem.common_m2();
  return {deviation(piece.beside_low, piece.planes.low, -up, -beyond_cells, common_m2),
          deviation(piece.beside_high, piece.planes.high, up, beyond_cells, common_m2)};
}

/// Of a plane's height beside a piece. Its fit takes what cells share for the same wherever they lie: it is no less
/// than how far and how often they were seen makes it.
template <Limits limits>
float CurbMaker<limits>::plane_variance_m2(const Plane& plane, const Piece& piece) const {
  const float reach_m2 = stages_.view.reach_m2(plane.x_m, plane.y_m, plane.scatter_m2, plane.points_a_cell);
  return std::max(1.0f, stages_.dem.common_m2(reach_m2) / plane.fit_variance_m2) * piece.variance_m2(plane);
}

/// Of a piece's middle, across it.
template <Limits limits>
float CurbMaker<limits>::place_variance_m2(const Piece& piece, const Curb& curb, float height_variance_m2) {
  if (!is_step(curb) || piece.one_sided()) return piece.borders_variance_m2;
  const float cell_variance_m2 = 0.5f * (piece.planes.low.fit_variance_m2 + piece.planes.high.fit_variance_m2);
  return piece.told_variance_m2 + piece.shifted_m2(curb.height_m, height_variance_m2, cell_variance_m2);
}

/// Is a step the side of an obstacle: higher than any, or the drop behind one, from where no robot gets to?
template <Limits limits>
bool CurbMaker<limits>::obstacle(const Curb& curb, const Piece& piece) {
  if (curb.height_m >= -settings_.max_step_m) return curb.height_m > settings_.max_step_m;
  const Plane& near = stages_.mixture.plane(curb.near_label);
  return near.height_m(piece.x_m, piece.y_m) - nearest_ground().height_m(piece.x_m, piece.y_m) > settings_.max_step_m;
}

/// The plane that is borne nearest to the laser: the robot's own ground, as far as is seen.
template <Limits limits>
const Plane& CurbMaker<limits>::nearest_ground() {
  if (nearest_ground_ != nullptr) return *nearest_ground_;
  int nearest = 0;
  float least_m2 = -1.0f;
  stages_.dem.for_each_valid([&](int i, int j, int s) {
    if (stages_.field.label(s) == no_label || !stages_.mixture.on_ground(s)) return;
    const float away_m2 = square((static_cast<float>(i) + 0.5f) * stages_.dem.cell_x_m() - stages_.view.x_m) +
                          square((static_cast<float>(j) + 0.5f) * stages_.dem.cell_y_m() - stages_.view.y_m);
    if (least_m2 >= 0.0f && away_m2 >= least_m2) return;
    least_m2 = away_m2;
    nearest = stages_.field.label(s);
  });
  nearest_ground_ = &stages_.mixture.plane(nearest);
  return *nearest_ground_;
}

/// In the map frame, the near side to the right of the way from the first to the second.
template <Limits limits>
void CurbMaker<limits>::set_ends(const Piece& piece, Curb& curb) const {
  const float x_m = stages_.dem.origin_x_m(), y_m = stages_.dem.origin_y_m();
  curb.x0_m = x_m + piece.line.x0_m;
  curb.y0_m = y_m + piece.line.y0_m;
  curb.x1_m = x_m + piece.line.x1_m;
  curb.y1_m = y_m + piece.line.y1_m;
  if (piece.low_is_right == piece.low_is_near) return;
  std::swap(curb.x0_m, curb.x1_m);
  std::swap(curb.y0_m, curb.y1_m);
}

}  // namespace curbline
