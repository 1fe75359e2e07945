// Which planes are ground. A region may fit a plane and be none that a wheel could stand on:
//   - a face: a strip between two others, of a height between theirs, that no cell shows alone. The heights within its
//     cells spread over most of the step, beyond what noise makes in the planes beside it: it is narrower than a cell
//     and a half, and its plane is what mixing both sides makes.
//   - an obstacle, or the top of one: obstacles.hpp.
//   - a veil: readings that mix an edge and what lies behind it, on the rays between. Its plane holds the laser itself,
//     and no surface that does is seen; or it is no wider than the shadow of a step down, and steeper than ground, or
//     falls there at least a quarter as far as the rays, as about an edge that is bent, or is so narrow that its slope
//     is not known: what is seen beyond an edge is flatter than the ray that grazes it, and so wider. The tread of a
//     stair whose cells at both ends hold half of the next one falls by half a step where the rays fall by two.
//   - a fringe: a strip beside an obstacle that is higher than a kerb, no wider than the laser's spot on the ground is
//     long, that rises above the ground: readings that mix the obstacle and the ground around it. One that falls away
//     from the laser as its rays do is a veil before the obstacle.
// No cell bears such a plane; its cells are left to the ground beside them, and curbs look through them. Faces and
// veils mix two sides, to the nearer of which a cell belongs; obstacles and fringes cover the ground, and their heights
// tell nothing of it. A plane that may be a veil, but is not known to be one, is borne by its cells, and no curb has it
// for a side: one that falls away as rays do, perhaps with what little the window holds behind it; and one that falls
// away more steeply than a ramp and is no wider than the shadow of what it falls and the laser's spot on an edge,
// however the rays pass it, blurs that edge.
// Cost: three passes over the window.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "curbline/dem.hpp"
#include "curbline/grid.hpp"
#include "curbline/obstacles.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"

namespace curbline {

template <Limits limits>
class Ground {
 public:
  void clear() { kind_.fill(Kind::ground); }

  /// Asks each plane anew. label_of(slot) is the plane of a valid cell's region, no_label if it has none;
  /// changed(label) is called for each that is to be borne otherwise than before.
  template <typename LabelOf, typename Changed>
  void update(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view, LabelOf&& label_of,
              Changed&& changed);

  bool is(int label) const { return borne(kind(label)); }
  /// May it, of planes that are ground, be a veil?
  bool may_be_veil(int label) const { return kind(label) == Kind::doubtful; }
  /// Is it an obstacle or a fringe?
  bool covers(int label) const { return kind(label) == Kind::cover; }

 private:
  using PlaneFlags = std::array<bool, limits.planes>;
  enum class Kind : std::uint8_t { ground, doubtful, mixture, cover };
  static bool borne(Kind kind) { return kind == Kind::ground || kind == Kind::doubtful; }

  /// In cells: as many as a face of one and a half touches when it lies across the grid; and as long as the spot of a
  /// beam is on the ground 6 m away, seen from 1.2 m above it.
  static constexpr int longest_strip = 3;
  static constexpr float beam_rad = 0.01f;  ///< divergence of a beam
  static constexpr float narrow = 1.5f;     ///< cells: a wider strip has cells of its own

  /// How far something falls from its end near the laser to the far one, and how far the rays there do.
  struct Fall {
    float own_m = 0.0f, of_rays_m = 0.0f;
  };
  /// Strips that a step down leaves in its shadow.
  struct Shadowed {
    float cells = 0.0f, strips = 0.0f;
    Fall fall{};

    void add(float strip_cells, const Fall& of_strip) {
      cells += strip_cells;
      strips += 1.0f;
      fall.own_m += of_strip.own_m;
      fall.of_rays_m += of_strip.of_rays_m;
    }
    bool falls_with_rays() const { return 4.0f * fall.own_m >= fall.of_rays_m; }
  };
  /// What is known of a plane's cells, and of those of its runs that are strips between other planes.
  struct Tally {
    float cells = 0.0f;
    float strip_cells = 0.0f, strips = 0.0f, step_m = 0.0f, strip_spread_m2 = 0.0f, strip_weight = 0.0f;
    // By the axis along which the strip was found, x or y.
    std::array<Shadowed, 2> shadow{};
    std::array<float, 2> blurred_cells{};  ///< as many as an edge would blur; counted of planes that drop off
    std::array<float, 2> fringe_cells{};   ///< in strips beside an obstacle higher than a step

    /// A strip between two others, which are no obstacles: a step up to one would be no kerb's. Its cells spread beyond
    /// what noise makes by as much more than those of the quieter plane beside it.
    template <typename Run>
    void add_strip(const Run& before, const Run& run, const Run& next) {
      const float step = next.first_height_m - before.last_height_m;
      const float one_m2 = before.scatter_m2 / before.weight, other_m2 = next.scatter_m2 / next.weight;
      strips += 1.0f;
      strip_cells += static_cast<float>(run.length());
      step_m += step < 0.0f ? -step : step;
      strip_spread_m2 += run.scatter_m2 - run.weight * (one_m2 < other_m2 ? one_m2 : other_m2);
      strip_weight += run.weight;
    }
    bool face() const {
      const float mean_step_m = step_m / (strips > 0.0f ? strips : 1.0f);
      // Heights that are spread evenly over a width of w cells have a standard deviation of step / (w sqrt(12)) within
      // each.
      return most(strip_cells) && mean_step_m * mean_step_m * strip_weight <= narrow * narrow * 12.0f * strip_spread_m2;
    }
    bool veil(bool steep) const { return veil(shadow[0], steep) || veil(shadow[1], steep); }
    bool fringe() const { return most(fringe_cells[0]) || most(fringe_cells[1]); }
    bool blurred_edge() const { return all(blurred_cells[0]) || all(blurred_cells[1]); }

   private:
    bool all(float of_cells) const { return cells > 0.0f && of_cells >= cells; }
    bool most(float in_strips) const { return cells > 0.0f && 2.0f * in_strips >= cells; }
    bool veil(const Shadowed& in_shadow, bool steep) const {
      return most(in_shadow.cells) &&
             (steep || in_shadow.cells < narrow * in_shadow.strips || in_shadow.falls_with_rays());
    }
  };
  using Tallies = std::array<Tally, limits.planes>;
  /// How the laser sees a row or column.
  struct Sight {
    float eye_m, eye_z_m;  ///< where it is along it, from the window's lowest corner, and how high
    float cell_m;          ///< of a cell, along it
    float end_m;           ///< Viewpoint::end_x_m, or end_y_m

    bool ahead(int cell) const { return static_cast<float>(cell) * cell_m > eye_m; }
    /// To the near end of a run; of a robot that drives, as far as it has seen it from. 0 and less: the laser is above.
    float away_m(int first, int last) const {
      const bool is_ahead = ahead(first);
      const float away_m =
          is_ahead ? static_cast<float>(first) * cell_m - eye_m : eye_m - static_cast<float>(last + 1) * cell_m;
      const float from_end_m = is_ahead ? end_m - eye_m : eye_m;
      return end_m > 0.0f && away_m > 0.0f && away_m < from_end_m ? from_end_m : away_m;
    }
    /// The same for an edge that lies across the grid, along a strip: as if the laser were where the edge's parallel
    /// through it crosses the line, which is `aside_m` from the laser.
    Sight across(const Plane& strip, std::size_t axis, float aside_m) const {
      const float along = axis == 0 ? strip.pxx : strip.pyy;  // the strip's normal is (pxx, pxy), or (pxy, pyy)
      return {along > 0.0f ? eye_m - aside_m * strip.pxy / along : eye_m, eye_z_m, cell_m, end_m};
    }
  };
  /// Cells of one plane that follow each other on a row or column.
  struct Run {
    Label label;
    int first, last;
    float first_height_m, last_height_m, lowest_m, highest_m;
    float scatter_m2, weight;

    int length() const { return last - first + 1; }
    /// Of a strip: does a step from `before` to `next` lead over it?
    bool between(const Run& before, const Run& next) const {
      const float from = before.last_height_m, to = next.first_height_m;
      return first - before.last <= widest_gap && next.first - last <= widest_gap &&
             ((from < lowest_m && highest_m < to) || (from > highest_m && lowest_m > to));
    }
    /// Of a strip between two planes: does the step lead down as the laser sees it, and is the strip no wider than its
    /// shadow (shadow.hpp), and a cell for what those at its ends have of the planes? Then how far it falls. Inlined,
    /// since calls of it would cost the worst line of a Cortex-M7 20,000 instructions more (tools/budget).
    [[gnu::always_inline]] bool in_shadow(const Run& before, const Run& next, const Sight& sight, Fall& fall) const {
      const bool ahead = sight.ahead(first);
      const float near_m = ahead ? before.last_height_m : next.first_height_m;
      const float drop_m = ahead ? near_m - next.first_height_m : near_m - before.last_height_m;
      const float above_m = sight.eye_z_m - near_m, away_m = sight.away_m(first, last);
      if (!(above_m > 0.0f) || !(away_m > 0.0f)) return false;
      fall.of_rays_m = static_cast<float>(length() - 1) * sight.cell_m * above_m / away_m;
      fall.own_m = ahead ? first_height_m - last_height_m : last_height_m - first_height_m;
      return fall.of_rays_m <= drop_m;
    }
    /// How far it begins below where `before` or `next`, the one nearer to the laser, ends; 0 if there is none.
    float begins_below_m(const Run& before, const Run& next, const Sight& sight) const {
      if (sight.ahead(first)) return before.label == no_label ? 0.0f : before.last_height_m - first_height_m;
      return next.label == no_label ? 0.0f : next.first_height_m - last_height_m;
    }
    /// Cells that hold something of both sides of an edge here: as long as the spot on the ground and the shadow of
    /// what the run falls, and one more. If a step of more than that parts it from the run before it, it is not the
    /// fall of the edge, and casts no shadow. `aside_m`: how far the line is from the laser.
    float blurred_cells(const Run& before, const Run& next, const Sight& sight, float aside_m) const {
      const float above_m = sight.eye_z_m - first_height_m, away_m = sight.away_m(first, last);
      if (!(above_m > 0.0f)) return 0.0f;
      const float spot = beam_rad * (above_m * above_m + away_m * away_m + aside_m * aside_m);
      const float fall_m = highest_m - lowest_m, step_m = begins_below_m(before, next, sight);
      const float shadow = away_m > 0.0f && step_m <= fall_m && step_m >= -fall_m ? away_m * fall_m : 0.0f;
      return 1.0f + (spot + shadow) / (above_m * sight.cell_m);
    }
  };

  /// Does a strip beside an obstacle hold readings of it? They lie above the ground, the more of it they hold the
  /// higher: the strip leans, or all of it is higher than a kerb. A level one below that is a surface.
  static bool stands_out(const Plane& plane, const Plane& ground) {
    const float above_m = plane.above_m(ground);
    const float lean_x = plane.slope_x - ground.slope_x, lean_y = plane.slope_y - ground.slope_y;
    return above_m > 0.0f && (above_m > highest_step_m || lean_x * lean_x + lean_y * lean_y > least_ramp * least_ramp);
  }
  /// Of a plane that lies `above_m` below the laser, or above it, where the laser stands: within five standard
  /// deviations, since an edge need not be straight.
  static bool holds_laser(const Plane& plane, const Viewpoint& view, float above_m) {
    return above_m * above_m <= 25.0f * (plane.variance_m2 + plane.height_variance_m2(view.x_m, view.y_m));
  }
  /// Does it fall away from the laser, and more steeply than a ramp?
  static bool drops_off(const Plane& plane, const Viewpoint& view) {
    return plane.steeper_than_ramp() &&
           plane.slope_x * (plane.x_m - view.x_m) + plane.slope_y * (plane.y_m - view.y_m) < 0.0f;
  }
  static Sight sight(const Dem<limits>& dem, const Viewpoint& view, std::size_t axis) {
    return axis == 0 ? Sight{view.x_m, view.z_m, dem.cell_x_m(), view.end_x_m}
                     : Sight{view.y_m, view.z_m, dem.cell_y_m(), view.end_y_m};
  }
  template <typename LabelOf, typename EndRun>
  static void walk(const Dem<limits>& dem, int axis, LabelOf&& label_of, EndRun&& end_run);
  template <typename LabelOf>
  static void tally_runs(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
                         LabelOf&& label_of, const Obstacles<limits>& obstacles, const PlaneFlags& drops,
                         Tallies& tallies);
  static Kind kind_of(std::size_t label, const Plane& plane, const Tally& tally, const Obstacles<limits>& obstacles,
                      const Viewpoint& view);
  Kind kind(int label) const { return kind_[static_cast<std::size_t>(label)]; }

  std::array<Kind, limits.planes> kind_{};
};

/// Calls end_run(before, run, next, line) for each run of cells along x (axis 0) or along y (axis 1); the label of a
/// run that is not there is no_label.
template <Limits limits>
template <typename LabelOf, typename EndRun>
void Ground<limits>::walk(const Dem<limits>& dem, int axis, LabelOf&& label_of, EndRun&& end_run) {
  const int lines = axis == 0 ? dem.cols() : dem.rows();
  const Run nothing{no_label, 0, 0, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  for (int line = 0; line < lines; ++line) {
    Run before = nothing, run = nothing;
    dem.for_each_valid_along(axis, line, [&](int k, int s) {
      const Label label = label_of(s);
      if (label == no_label) return;
      const Cell& cell = dem.cell(s);
      const float h = cell.height_m;
      if (label != run.label) {
        const Run next{label, k, k, h, h, h, h, cell.scatter_m2, cell.weight};
        end_run(before, run, next, line);
        before = run;
        run = next;
        return;
      }
      run.last = k;
      run.last_height_m = h;
      if (h < run.lowest_m) run.lowest_m = h;
      if (h > run.highest_m) run.highest_m = h;
      run.scatter_m2 += cell.scatter_m2;
      run.weight += cell.weight;
    });
    end_run(before, run, nothing, line);
  }
}

/// What runs tell: strips in the shadow of a step, as the laser saw them last, beside a high obstacle, between two
/// planes.
template <Limits limits>
template <typename LabelOf>
void Ground<limits>::tally_runs(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
                                LabelOf&& label_of, const Obstacles<limits>& obstacles, const PlaneFlags& drops,
                                Tallies& tallies) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    walk(dem, static_cast<int>(axis), label_of, [&](const Run& before, const Run& run, const Run& next, int line) {
      if (run.label == no_label) return;
      Tally& tally = tallies[run.label];
      const auto cells = static_cast<float>(run.length());
      const bool leads = before.label != no_label && next.label != no_label && run.between(before, next);
      if (leads || drops[run.label]) {
        const Viewpoint from = dem.seen_from(axis == 0 ? dem.slot(run.first, line) : dem.slot(line, run.first), view);
        const Sight along = sight(dem, from, axis), aside = sight(dem, from, 1 - axis);
        const float aside_m = (static_cast<float>(line) + 0.5f) * aside.cell_m - aside.eye_m;
        const Sight across = along.across(planes[run.label], axis, aside_m);
        if (Fall fall; leads && run.in_shadow(before, next, across, fall)) tally.shadow[axis].add(cells, fall);
        if (drops[run.label]) tally.blurred_cells[axis] += run.blurred_cells(before, next, across, aside_m);
      }
      if (run.length() > longest_strip) return;
      const bool after_high = before.label != no_label && obstacles.high(before.label) && run.first == before.last + 1;
      const bool before_high = next.label != no_label && obstacles.high(next.label) && next.first == run.last + 1;
      if (after_high || before_high) tally.fringe_cells[axis] += cells;
      if (leads && !obstacles.is(before.label) && !obstacles.is(next.label)) tally.add_strip(before, run, next);
    });
  }
}

/// Veils are only seen from well above the ground: else the viewpoint is not where the points were seen from, as of a
/// cloud whose origin lies on the ground, and a plane that holds it may be a pavement.
template <Limits limits>
auto Ground<limits>::kind_of(std::size_t label, const Plane& plane, const Tally& tally,
                             const Obstacles<limits>& obstacles, const Viewpoint& view) -> Kind {
  if (tally.face()) return Kind::mixture;
  if (obstacles.is(label)) return Kind::cover;
  const Plane* ground = obstacles.ground();
  if (ground == nullptr || !plane.alive()) return Kind::ground;
  const bool fringe = tally.fringe() && !obstacles.way(label) && stands_out(plane, *ground);
  const float laser_m = view.z_m - ground->height_m(view.x_m, view.y_m);
  if (laser_m <= highest_step_m) return fringe ? Kind::cover : Kind::ground;
  const bool steep = plane.steeper_than_ramp();
  // What mixes an edge and the ground behind rises toward the laser at least half as steeply as the rays.
  const float above_m = view.z_m - plane.height_m(view.x_m, view.y_m);
  const bool as_rays = above_m < 0.5f * laser_m;
  if (fringe) return as_rays && steep ? Kind::mixture : Kind::cover;
  if (tally.veil(plane.steeper_than_ground()) || (as_rays && holds_laser(plane, view, above_m))) return Kind::mixture;
  return tally.blurred_edge() || (as_rays && steep) ? Kind::doubtful : Kind::ground;
}

template <Limits limits>
template <typename LabelOf, typename Changed>
void Ground<limits>::update(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
                            LabelOf&& label_of, Changed&& changed) {
  const Obstacles<limits> obstacles(dem, planes, view, label_of);
  PlaneFlags drops{};
  for (std::size_t l = 0; l < drops.size(); ++l) drops[l] = !obstacles.is(l) && drops_off(planes[l], view);
  Tallies tallies{};
  for (std::size_t l = 0; l < tallies.size(); ++l) tallies[l].cells = obstacles.cells(l);
  tally_runs(dem, planes, view, label_of, obstacles, drops, tallies);
  for (std::size_t l = 0; l < kind_.size(); ++l) {
    const Kind kind = kind_of(l, planes[l], tallies[l], obstacles, view);
    const Kind before = kind_[l];
    kind_[l] = kind;
    if (kind != before && !(borne(kind) && borne(before))) changed(static_cast<Label>(l));
  }
}

}  // namespace curbline
