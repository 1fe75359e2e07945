// Edges found with no ground in view beyond, on a row or column of the window:
//   - the end of a face: of a strip that rises away from the laser more steeply than a ramp. Had it gone on, the
//     laser would see it as well as the face; what follows is flatter than the rays.
//   - a brink: where the ground is followed, away from the laser, by lower readings that mix an edge with what lies
//     behind it (veils, ground.hpp), are too few for a plane, or belong to an obstacle. They fall as far as is
//     visible of the step. Ground may follow beyond the reach of borders: the foot of a flight of stairs.
// Cost: a look at each cell of a face, a veil and an obstacle, another where ground follows out of reach.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>

#include "curbline/borders/borders.hpp"
#include "curbline/borders/curb_stages.hpp"
#include "curbline/borders/plane_gap.hpp"
#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/cell_line.hpp"
#include "curbline/plane.hpp"

namespace curbline {

template <Limits limits>
class GroundEnds {
 public:
  using Line = CellLine<limits>;
  using Gap = PlaneGap<limits>;

  explicit GroundEnds(const CurbStages<limits>& stages) : stages_(stages) {}

  /// The end of the face that begins beside a gap and goes on along the line (toward 1) or against it (-1); none if it
  /// is no face, or does not end in the window.
  std::optional<Border> of_face(const Gap& gap, const typename Gap::Side& first, int toward) const;
  /// The brink before a cell, if that is the first of a veil, as the laser sees it. A cell of an obstacle counts as one
  /// of a veil if it is below the ground and was seen over the edge: what stands on the ground is not below it.
  std::optional<Border> brink(const Line& line, int first_of_veil) const;

 private:
  static constexpr float widest_face_m = 0.3f;  ///< a curb stone

  /// From an edge to a cell on either side of it, which is taken to bear the same label.
  Gap gap_behind(const Line& line, const LabelledCell& edge, int along) const;
  bool out_of_reach(const Line& line, const LabelledCell& edge, int first_of_veil, int ground) const;
  Border border_behind(const Line& line, int last, int toward, float along_m) const;

  const CurbStages<limits>& stages_;
};

/// The points of the last cell are taken to reach as far beyond their centroid as before it; the uncertainty is that of
/// the next cell, in which nothing was seen.
template <Limits limits>
auto GroundEnds<limits>::of_face(const Gap& gap, const typename Gap::Side& first, int toward) const
    -> std::optional<Border> {
  const Line& line = gap.line();
  const auto sign = static_cast<float>(toward);
  const float rise = sign * (line.axis == 0 ? first.plane.slope_x : first.plane.slope_y);
  if (rise <= steepest_ramp || line.away(stages_.view, first.along) != toward) return std::nullopt;

  // Cells that the widest face touches, wherever it begins in one.
  const int widest = static_cast<int>(widest_face_m / line.pitch_m() + 1.5f);
  int last = first.along;
  while (const int g = line.next_valid(last, toward, stages_.settings.link_reach)) {
    last += toward * g;
    if (stages_.field.label(line.slot(last)) != first.label || toward * (last - first.along) >= widest)
      return std::nullopt;
  }
  const bool at_end = last == 0 || last == line.cells() - 1;
  if (at_end) return std::nullopt;  // of the window; the face may go on

  const float centroid = sign * line.offset(line.cell(last));
  const float edge = centroid < 0.0f ? 0.5f + 2.0f * centroid : 0.5f;  // from the cell's middle, in cells
  Border border = border_behind(line, last, toward, (static_cast<float>(last) + 0.5f + sign * edge) * line.pitch_m());
  border.half_gap_m = line.pitch_m();
  return border;
}

/// The veil is extrapolated to the far side of its last cell. What is seen over other ground is no veil behind this
/// one, but the face of a step up, which falls along a row, too. A plane that only may be a veil, as a bank seen from
/// above may, does not lead to ground out of reach over a step.
template <Limits limits>
auto GroundEnds<limits>::brink(const Line& line, int first_of_veil) const -> std::optional<Border> {
  const int toward = line.away(stages_.view, first_of_veil);
  const int before = line.next_valid(first_of_veil, -toward, stages_.settings.link_reach);
  const int edge = first_of_veil - toward * before;
  const auto shows_ground = [&](int along) {
    return stages_.shows_ground(line.row(along), line.col(along), line.slot(along));
  };
  if (before == 0 || !shows_ground(edge)) return std::nullopt;
  const LabelledCell before_veil{stages_.field.label(line.slot(edge)), static_cast<std::int16_t>(edge)};
  const Plane& plane = stages_.mixture.plane(before_veil.label);
  const auto below = [&](int along) {
    return line.above_m(along, plane) < 0.0f &&
           !stages_.lies_on(line.row(along), line.col(along), line.cell(along), plane);
  };
  const auto may_fall = [&](int along) {
    const int s = line.slot(along);
    return stages_.may_be_veil(s) || (stages_.mixture.covered(s) && below(along) &&
                                      line.away(line.dem.seen_from(s, stages_.view), along) == toward);
  };
  int last = edge;    // of the veil, as far as it has been followed
  bool bank = false;  // some of it is on a plane that only may be a veil
  while (const int g = line.next_valid(last, toward, stages_.settings.link_reach)) {
    const int next = last + toward * g;
    const int s = line.slot(next);
    if (shows_ground(next)) {
      if (bank || !out_of_reach(line, before_veil, first_of_veil, next)) return std::nullopt;
      break;
    }
    if (!may_fall(next)) break;
    last = next;
    bank = bank || (stages_.mixture.region_label(s) != no_label && stages_.mixture.on_ground(s));
  }
  if (!below(last)) return std::nullopt;
  if (gap_behind(line, before_veil, first_of_veil).seen_over_other(toward > 0))
    return std::nullopt;  // of a face, from its foot

  const auto cells = static_cast<float>(toward * (last - edge));
  Border border = border_behind(line, edge, toward, static_cast<float>(edge + (toward > 0 ? 1 : 0)) * line.pitch_m());
  border.half_gap_m = 0.5f * line.pitch_m();
  border.drop_m = -line.above_m(last, plane) * cells / (cells - 0.5f);
  return border;
}

/// Is the ground behind a veil too far from the edge for a border between the two (BorderFinder), though the veil is
/// seen over that edge? A flight of stairs whose treads are hidden but for their ends goes on for more than the reach,
/// and its foot lies in the shadow of its last edge. A face that the rays meet from its foot begins no veil.
template <Limits limits>
bool GroundEnds<limits>::out_of_reach(const Line& line, const LabelledCell& edge, int first_of_veil, int ground) const {
  if (std::abs(ground - edge.along) <= stages_.settings.link_reach) return false;
  return gap_behind(line, edge, first_of_veil).hidden() && !gap_behind(line, edge, ground).hidden();
}

template <Limits limits>
auto GroundEnds<limits>::gap_behind(const Line& line, const LabelledCell& edge, int along) const -> Gap {
  const LabelledCell far{edge.label, static_cast<std::int16_t>(along)};
  const bool forward = along > edge.along;
  return Gap(stages_, line, forward ? edge : far, forward ? far : edge);
}

/// A border behind the last cell of a plane, with no_label for `other`, on the unseen side.
template <Limits limits>
auto GroundEnds<limits>::border_behind(const Line& line, int last, int toward, float along_m) const -> Border {
  const int slot = line.slot(last);
  const Label label = stages_.field.label(slot);
  Border border = Borders<limits>::on(line, along_m);
  border.probability = stages_.field.belief(line.dem, slot).of(label);
  border.one = label;
  border.other = no_label;
  border.sign = static_cast<std::int8_t>(toward);
  return border;
}

}  // namespace curbline
