// Statistics of the runs of a plane's cells (run.hpp), by which ground.hpp decides what it is: how many of its cells
// lie in strips that carry a step, in the shadow of one or beside a high obstacle, or where an edge is blurred. Cost:
// that of the runs.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "curbline/map/cell_line.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/per_cell.hpp"
#include "curbline/plane.hpp"
#include "curbline/planes/obstacles.hpp"
#include "curbline/planes/run.hpp"
#include "curbline/point.hpp"

namespace curbline {

/// Strips in the shadow of a step down.
struct Shadowed {
  float cells = 0.0f;
  Fall fall{};

  void add(float strip_cells, const Fall& of_strip) {
    cells += strip_cells;
    fall.own_m += of_strip.own_m;
    fall.of_rays_m += of_strip.of_rays_m;
  }
  bool falls_with_rays() const { return 2.0f * fall.own_m >= fall.of_rays_m; }
};

/// Cells: a wider strip has cells of its own.
inline constexpr float narrow_cells = 1.5f;

/// Do the heights within the cells of a strip, of variance spread_m2 beyond noise, spread over a step, step_m2 in
/// square, as those of a face do? A step spread evenly over a width of w cells has a standard deviation of step / (w
/// sqrt(12)) within each.
inline bool spreads_over(float step_m2, float spread_m2) {
  return step_m2 <= narrow_cells * narrow_cells * 12.0f * spread_m2;
}

struct StripTally {
  /// Cells: as many as a face of one and a half touches at an angle to the grid, and the length of a 10 mrad beam's
  /// spot on the ground 6 m away, seen from 1.2 m above it.
  static constexpr int longest_strip = 3;
  static constexpr int sparse_gap = 5;  ///< cells: scan lines on the ground are up to that far apart

  float cells = 0.0f;                   ///< of the plane's region
  std::array<float, 2> silent_cells{};  ///< in short strips that are alone, by axis
  // Of strips that rise or fall between two planes that are no obstacles, up to sparse_gap cells away.
  float strip_cells = 0.0f, strips = 0.0f, step_m = 0.0f, strip_spread_m2 = 0.0f, strip_weight = 0.0f;
  float two_levels_m2 = 0.0f;  ///< their scatter if their cells held the two planes, and nothing between
  float along_step_m = 0.0f;   ///< how far they rise or fall themselves, as the step does
  // By the axis along which the strip was found, x and y.
  std::array<Shadowed, 2> shadow{};
  std::array<float, 2> blurred_cells{};  ///< cells that an edge would blur; for planes that drop off
  std::array<float, 2> fringe_cells{};   ///< in strips beside an obstacle higher than a step

  /// Adds a strip between two others. Its cells' spread beyond noise is that beyond the spread of the quieter plane
  /// beside it.
  void add(const Strip& strip) {
    const Run &before = strip.before, &run = strip.run, &next = strip.next;
    const float step = next.first_height_m - before.last_height_m;
    const float one_m2 = before.scatter_m2 / before.weight, other_m2 = next.scatter_m2 / next.weight;
    strips += 1.0f;
    strip_cells += static_cast<float>(run.cells);
    step_m += magnitude(step);
    const float rise_m = run.last_height_m - run.first_height_m;
    along_step_m += step < 0.0f ? -rise_m : rise_m;
    strip_spread_m2 += run.scatter_m2 - run.weight * std::min(other_m2, one_m2);
    strip_weight += run.weight;
    two_levels_m2 += strip.two_levels_m2();
  }

  /// Is the plane a face? At least half of its cells, counted along x and along y, must be in such strips, strips that
  /// are alone left out, on rows or on columns: between sparse scan lines only the face is seen.
  bool face() const {
    if (!(strips > 0.0f) || 2.0f * strip_cells < cells - std::max(silent_cells[0], silent_cells[1])) return false;
    const float mean_step_m = step_m / strips, step_m2 = mean_step_m * mean_step_m * strip_weight;
    return spreads_over(step_m2, strip_spread_m2) || stands_between_cells(step_m2);
  }
  /// Are those strips, on average, narrower than such as have cells of their own?
  bool narrow() const { return strip_cells < narrow_cells * strips; }
  bool veil() const { return veil(shadow[0]) || veil(shadow[1]); }
  bool fringe() const { return most(fringe_cells[0]) || most(fringe_cells[1]); }
  bool blurred_edge() const { return (all(blurred_cells[0]) || all(blurred_cells[1])) && follows_step(); }

 private:
  bool all(float of_cells) const { return cells > 0.0f && of_cells >= cells; }
  bool most(float in_strips) const { return cells > 0.0f && 2.0f * in_strips >= cells; }
  /// Is it a face that lies on the border of two rows of cells, each of which holds more of the plane beside it than of
  /// the face? The cells of an even slope from height a to height b, w cells wide, with mean heights h and variances
  /// s^2, have
  ///   sum((h - a) (b - h) - s^2) = w (b - a)^2 / 6,
  /// wherever its cells begin: this tells w. And it is 2 w^2 times sum(s^2); on a level tread between a and b, whose
  /// cells do not scatter, many times as much.
  bool stands_between_cells(float step_m2) const {
    const float lacking_m2 = two_levels_m2 - strip_spread_m2;
    return lacking_m2 <= 2.0f * narrow_cells * narrow_cells * strip_spread_m2 &&
           lacking_m2 * strip_cells <= narrow_cells * (1.0f / 6) * step_m2 * strips;
  }
  /// The blur of an edge goes from one plane to the other: over n cells it falls by 1 - 1/n of the step. What falls by
  /// less than a quarter of that is no blur but the tread of a stair, level but for what its end cells hold of the
  /// next. Narrow strips have too few cells to tell.
  bool follows_step() const { return narrow() || 4.0f * along_step_m * strip_cells >= step_m * (strip_cells - strips); }
  bool veil(const Shadowed& in_shadow) const { return most(in_shadow.cells) && in_shadow.falls_with_rays(); }
};

/// Those of all planes. Shadows are those for the place from which the laser last saw a strip.
template <Limits limits>
class StripTallies {
 public:
  /// `region_label`: for each valid cell, the plane of its region.
  StripTallies(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
               const CellLabels<limits>& region_label, const Obstacles<limits>& obstacles);

  const StripTally& operator[](std::size_t label) const { return tallies_[label]; }

 private:
  using Line = CellLine<limits>;
  static constexpr int sparse_gap = StripTally::sparse_gap;

  void take(const Strip& strip, const Line& line);
  void take_edge(const Strip& strip, const Line& line, bool rises);
  void take_short(const Strip& strip, const Line& line, bool rises);

  const Dem<limits>& dem_;
  const std::span<const Plane> planes_;
  const Viewpoint& view_;
  const Obstacles<limits>& obstacles_;
  std::array<StripTally, limits.planes> tallies_{};
  std::array<bool, limits.planes> drops_{};  ///< planes that fall away from the laser, and are no obstacles
};

/// Does a plane fall away from the laser, more steeply than a ramp, relative to the ground's slope?
inline bool drops_off(const Plane& plane, const Plane& lean, const Viewpoint& view) {
  return plane.steeper_than_ramp(lean) &&
         plane.slope_x * (plane.x_m - view.x_m) + plane.slope_y * (plane.y_m - view.y_m) < 0.0f;
}

template <Limits limits>
StripTallies<limits>::StripTallies(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
                                   const CellLabels<limits>& region_label, const Obstacles<limits>& obstacles)
    : dem_(dem), planes_(planes), view_(view), obstacles_(obstacles) {
  const Plane lean = obstacles.ground() == nullptr ? Plane{} : obstacles.ground()->lean();
  for (std::size_t l = 0; l < tallies_.size(); ++l) {
    tallies_[l].cells = obstacles.cells(l);
    drops_[l] = !obstacles.is(l) && drops_off(planes[l], lean, view);
  }
  for (const int axis : {0, 1}) {
    for_each_run(dem, axis, region_label, [this](const Strip& strip, const Line& line) { take(strip, line); });
  }
}

template <Limits limits>
void StripTallies<limits>::take(const Strip& strip, const Line& line) {
  // A step up onto an obstacle is no curb, nor does a veil end at one.
  const bool rises = strip.between(sparse_gap) && strip.rises_between() && !obstacles_.is(strip.before.label) &&
                     !obstacles_.is(strip.next.label);
  if (rises || drops_[strip.run.label]) take_edge(strip, line, rises);
  if (strip.run.length() <= StripTally::longest_strip) take_short(strip, line, rises);
}

/// A strip that rises or falls between two others, or of a plane that drops off.
template <Limits limits>
void StripTallies<limits>::take_edge(const Strip& strip, const Line& line, bool rises) {
  const Run& run = strip.run;
  StripTally& tally = tallies_[run.label];
  const auto axis = static_cast<std::size_t>(line.axis);
  const Viewpoint from = dem_.seen_from(line.slot(run.first), view_);
  const float tangent = askew(planes_[run.label], line.axis);
  const Sight sight = Sight::along(line, from), across = sight.across(tangent);
  if (rises) {
    if (const auto fall = strip.fall_in_shadow(across)) tally.shadow[axis].add(static_cast<float>(run.cells), *fall);
  }
  if (drops_[run.label] && !strip.stands()) tally.blurred_cells[axis] += strip.blurred_cells(sight, tangent);
}

template <Limits limits>
void StripTallies<limits>::take_short(const Strip& strip, const Line& line, bool rises) {
  const Run &before = strip.before, &run = strip.run, &next = strip.next;
  StripTally& tally = tallies_[run.label];
  const auto axis = static_cast<std::size_t>(line.axis);
  const auto cells = static_cast<float>(run.cells);
  const bool after_high = before.any() && obstacles_.high(before.label) && run.first == before.last + 1;
  const bool before_high = next.any() && obstacles_.high(next.label) && next.first == run.last + 1;
  if (after_high || before_high) tally.fringe_cells[axis] += cells;
  if (strip.alone(sparse_gap)) {
    tally.silent_cells[axis] += cells;
  } else if (rises) {
    tally.add(strip);
  }
}

}  // namespace curbline
