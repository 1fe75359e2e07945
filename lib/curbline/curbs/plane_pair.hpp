// The planes on both sides of a border: how the height of the step between them changes from place to place, and
// whether they meet at a step or at a crease. O(1); functions without state.
#pragma once

#include "curbline/curbs/curb.hpp"
#include "curbline/curbs/line_fit.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"

namespace curbline {

/// The step at a border of two planes, by what was measured of it.
struct MeasuredStep {
  float height_m, height_sd_m;  ///< of PlanePair::other above PlanePair::one, at the border
  float half_gap_m;             ///< between the cells of the one and the other
  float place_variance_m2;      ///< of where the border lies, across it
  float texture_m2;             ///< of the ground, PlanePrior::texture_m2
};

/// With no ground in view beyond a border, the near plane stands for both: no step but the drop, no slope of its own.
struct PlanePair {
  const Plane &one, &other;  ///< of the lower number, and of the higher

  /// From one end of a piece to the other a step may change by no more than the repeatability of a range-finder.
  static constexpr float most_change_m = 0.02f;

  /// Height of the step at a place: that of `other` above `one`.
  float step_m(float x_m, float y_m) const { return other.height_m(x_m, y_m) - one.height_m(x_m, y_m); }
  /// Does it keep its height over (dx, dy)?
  bool even(float dx_m, float dy_m) const { return magnitude(change_m(dx_m, dy_m)) <= most_change_m; }
  /// By how much that height changes.
  float change_m(float dx_m, float dy_m) const {
    return (other.slope_x - one.slope_x) * dx_m + (other.slope_y - one.slope_y) * dy_m;
  }
  /// Difference of their slopes across a line: change of the step's height with the line's position.
  float slope_across(const LineFit::Segment& line) const {
    return (other.slope_x - one.slope_x) * line.normal_x + (other.slope_y - one.slope_y) * line.normal_y;
  }
  /// A border is a crease, not a step, if the planes' difference in height there is within its uncertainty (95 %): that
  /// of the planes, of the cells that define the border, at least the ground's texture, and of the border's position
  /// times the difference of slopes. A face, too steep for ground, begins at its foot, anywhere in the gap: as much
  /// more as the slopes make up across half of it. CurbKind::step_up stands for either step.
  CurbKind kind(const LineFit::Segment& border, const MeasuredStep& step) const;
};

}  // namespace curbline
