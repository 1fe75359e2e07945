// The ground beside a border may lie off the plane that it bears: a gutter or the camber of a road, too narrow or too
// weak for a plane of its own. The two cells next to the border's own tell, on each side, carried on to the border.
// What lies off toward the other side may be the readings of both that a cell mixes, and is left; what lies off away
// from it cannot be. Cost: two cells a border and side.
#pragma once

#include "curbline/plane.hpp"

namespace curbline {

/// Sums over borders of one side of a curb.
struct Beside {
  float borders = 0.0f;     ///< of which both cells bear the side's plane and hold nothing else
  float off_m = 0.0f;       ///< above the plane, at the border
  float rise_m = 0.0f;      ///< more than the plane's, per cell toward the border
  float away_cells = 0.0f;  ///< how far the nearer cell's middle is from the border

  /// Of one border: how far two cells lie above the plane, the nearer one's middle `away_cells` from the border.
  static Beside of(float nearer_m, float farther_m, float away) {
    return {1.0f, nearer_m + away * (nearer_m - farther_m), nearer_m - farther_m, away};
  }
  void add(const Beside& other) {
    borders += other.borders;
    off_m += other.off_m;
    rise_m += other.rise_m;
    away_cells += other.away_cells;
  }
};

/// By how much a side lies farther from the other one than its plane does, and the variance.
struct Deviation {
  float away_m = 0.0f, variance_m2 = 0.0f;
};

/// Of a side that begins `further_cells` beyond the borders, at the near end of a step down's shadow. `away` is 1 if
/// the other side lies below, -1 if above. Each cell is one observation; none within three standard deviations.
Deviation deviation(const Beside& beside, const Plane& plane, float away, float further_cells);

}  // namespace curbline
