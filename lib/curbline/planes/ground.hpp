// Which planes are ground. A region may fit a plane on which no wheel could stand:
//   - a face: a strip between two others, at a height between theirs. The heights within its cells spread over most
//     of the step, beyond the noise of the planes beside it, or as on both sides of a border between two rows: it is
//     narrower than a cell and a half, and its plane is a mixture of both sides.
//   - an obstacle, or the top of one: obstacles.hpp.
//   - a veil: readings that mix an edge with what lies behind it, on the rays between, or a single scan line on bent
//     ground. Its plane contains the laser itself, as no visible surface does; or it is no wider than the shadow of a
//     step down between two planes that are no obstacles, and falls there at least half as far as the rays. What is
//     visible beyond an edge is flatter than the ray that grazes it, and so wider. The tread of a stair, with half of
//     the next one in the cells at both ends, falls by half a step where the rays fall by two.
//   - a fringe: a strip beside an obstacle higher than a curb, no wider than the laser's spot on the ground is
//     long, that rises above the ground: readings that mix the obstacle with the ground around it. One that falls
//     away from the laser as its rays do is a veil before the obstacle.
// No cell has the label of such a plane; its cells go to the ground beside them, and curbs look through them. Faces and
// veils mix two sides, and their cells go to the nearer one; obstacles and fringes cover the ground, and their
// heights say nothing about it. A plane that may be a veil, but not for certain, keeps its cells, but is no side of a
// curb:
//   - one that falls away as rays do, perhaps with a little of the ground behind in the window;
//   - a blurred edge: it falls away more steeply than a ramp, relative to the ground's slope, and is no wider than the
//     laser's spot was when it was last seen and the cells that an edge at this angle to the grid crosses. No blur
//     falls by as little of the step as the tread of a stair does, or stands above the ground on both its sides.
// Cost: three passes over the window.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "curbline/grid.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/per_cell.hpp"
#include "curbline/plane.hpp"
#include "curbline/planes/obstacles.hpp"
#include "curbline/planes/strip_tally.hpp"
#include "curbline/point.hpp"

namespace curbline {

template <Limits limits>
class Ground {
 public:
  void clear() { kind_.fill(Kind::ground); }

  /// Classifies each plane again, by the cells of its region; calls changed(label) where it becomes ground, or ceases
  /// to be.
  template <typename Changed>
  void update(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
              const CellLabels<limits>& region_label, Changed&& changed);

  /// Classifies planes of ground once more, by the cells that bear their labels: `labels`, for each valid cell. What is
  /// not ground by these is none. Calls changed(label) for it.
  template <typename Changed>
  void recheck(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
               const CellLabels<limits>& labels, Changed&& changed);

  bool is(int label) const { return is_ground(kind(label)); }
  /// May a plane of ground be a veil?
  bool may_be_veil(int label) const { return kind(label) == Kind::doubtful; }
  /// Is it an obstacle or a fringe?
  bool covers(int label) const { return kind(label) == Kind::cover; }

 private:
  enum class Kind : std::uint8_t { ground, doubtful, mixed, cover };
  static bool is_ground(Kind kind) { return kind == Kind::ground || kind == Kind::doubtful; }

  /// Does a strip beside an obstacle hold readings of it? They lie above the ground, the higher the more of the
  /// obstacle they hold: the strip leans, or is higher than a curb as a whole. A level one below that is a surface.
  static bool stands_out(const Plane& plane, const Plane& ground) {
    const float above_m = plane.above_m(ground);
    const float lean_x = plane.slope_x - ground.slope_x, lean_y = plane.slope_y - ground.slope_y;
    return above_m > 0.0f && (above_m > highest_step_m || lean_x * lean_x + lean_y * lean_y > least_ramp * least_ramp);
  }
  using Kinds = std::array<Kind, limits.planes>;
  static Kind kind_of(std::size_t label, const Plane& plane, const StripTally& tally,
                      const Obstacles<limits>& obstacles, const Viewpoint& view);
  static Kinds kinds(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
                     const CellLabels<limits>& region_label, const Obstacles<limits>& obstacles);
  Kind kind(int label) const { return kind_[static_cast<std::size_t>(label)]; }

  Kinds kind_{};
};

/// Veils are only considered for a laser well above the ground: else the points were not seen from the
/// viewpoint, as in a cloud whose origin is on the ground, and a plane that contains it may be a pavement. Where there
/// is no ground yet, all that has been seen may be single scan lines.
template <Limits limits>
auto Ground<limits>::kind_of(std::size_t label, const Plane& plane, const StripTally& tally,
                             const Obstacles<limits>& obstacles, const Viewpoint& view) -> Kind {
  if (tally.face()) return Kind::mixed;
  if (obstacles.is(label)) return Kind::cover;
  const Plane* ground = obstacles.ground();
  if (!plane.alive()) return Kind::ground;
  if (ground == nullptr) return Obstacles<limits>::seen_edge_on(plane, view) ? Kind::mixed : Kind::ground;
  const bool fringe = tally.fringe() && !obstacles.way(label) && stands_out(plane, *ground);
  const float laser_m = view.z_m - ground->height_m(view.x_m, view.y_m);
  if (laser_m <= highest_step_m) return fringe ? Kind::cover : Kind::ground;
  const bool steep = plane.steeper_than_ramp();
  // A mixture of an edge and the ground behind rises toward the laser at least half as steeply as the rays.
  const float above_m = view.z_m - plane.height_m(view.x_m, view.y_m);
  const bool as_rays = above_m < 0.5f * laser_m;
  if (fringe) return as_rays && steep ? Kind::mixed : Kind::cover;
  if (tally.veil() || (as_rays && plane.passes_through(view.x_m, view.y_m, view.z_m))) return Kind::mixed;
  return tally.blurred_edge() || (as_rays && steep) ? Kind::doubtful : Kind::ground;
}

// Not inlined: the tallies are large, and the search for obstacles goes deeper without them on the stack.
template <Limits limits>
[[gnu::noinline]] auto Ground<limits>::kinds(const Dem<limits>& dem, std::span<const Plane> planes,
                                             const Viewpoint& view, const CellLabels<limits>& region_label,
                                             const Obstacles<limits>& obstacles) -> Kinds {
  const StripTallies<limits> tallies(dem, planes, view, region_label, obstacles);
  Kinds found;
  for (std::size_t l = 0; l < found.size(); ++l) found[l] = kind_of(l, planes[l], tallies[l], obstacles, view);
  return found;
}

template <Limits limits>
template <typename Changed>
void Ground<limits>::update(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
                            const CellLabels<limits>& region_label, Changed&& changed) {
  const Obstacles<limits> obstacles(dem, planes, view, region_label);
  const Kinds before = std::exchange(kind_, kinds(dem, planes, view, region_label, obstacles));
  for (std::size_t l = 0; l < kind_.size(); ++l) {
    if (kind_[l] != before[l] && !(is_ground(kind_[l]) && is_ground(before[l]))) changed(static_cast<Label>(l));
  }
}

/// A face is narrower than a cell and a half, and so are the strips of cells that bear its label. A flank of a dropped
/// curb, whose first cells mix both sides of the curb, has wider ones.
template <Limits limits>
template <typename Changed>
void Ground<limits>::recheck(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
                             const CellLabels<limits>& labels, Changed&& changed) {
  const Obstacles<limits> obstacles(dem, planes, view, labels);
  const StripTallies<limits> tallies(dem, planes, view, labels, obstacles);
  for (std::size_t l = 0; l < kind_.size(); ++l) {
    if (!is_ground(kind_[l]) || (tallies[l].face() && !tallies[l].narrow())) continue;
    const Kind now = kind_of(l, planes[l], tallies[l], obstacles, view);
    if (is_ground(now)) continue;
    kind_[l] = now;
    changed(static_cast<Label>(l));
  }
}

}  // namespace curbline
