// The ground beside a border may lie off the plane that it bears: a gutter or the camber of a road, too narrow or too
// weak for a plane of its own. The two cells next to the border's own tell, on each side, carried on to the border.
// What lies off toward the other side may be the readings of both that a cell mixes, and is left; what lies off away
// from it cannot be. What is left tells how wrong the plane may be there. Cost: two cells a border and side.
#pragma once

#include <algorithm>

#include "curbline/math.hpp"
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

/// How far the ground of a side lies above its plane, as cells tell that lie a little farther from the border than
/// those that may mix both sides: a plane may hold more than one surface, as a crease too weak to part leaves it, and
/// lies off both, all along a curb.
struct GroundAlong {
  /// Cells from the one that a border lies in.
  static constexpr int nearest = 2, farthest = 5;

  float above_m = 0.0f;      ///< what chance makes, two standard deviations, is taken off
  float share = 0.0f;        ///< of what they say: that much of how well the plane is known is how well they know it
  float variance_m2 = 0.0f;  ///< of what they say, each cell one observation

  /// Of their number and the sum of how far they lie above the plane.
  static GroundAlong of(float cells, float above_m, const Plane& plane) {
    if (!(cells > 0.0f)) return {};
    const float mean_m = above_m / cells, variance_m2 = plane.fit_variance_m2 / cells;
    const float share = square(mean_m) > 4.0f * variance_m2 ? 1.0f - 4.0f * variance_m2 / square(mean_m) : 0.0f;
    return {share * mean_m, share, variance_m2};
  }
};

/// By how much the ground of a side lies farther from the other side than its plane does, on the mean of the borders,
/// and the variance of that. Below 0 it lies nearer.
struct Deviation {
  float away_m = 0.0f, variance_m2 = 0.0f;
  float common_m2 = 0.0f;  ///< as much of it as the cells may have in common: errors of a scan line along the border
  float borders = 0.0f;    ///< that tell it

  /// It lies farther by three standard deviations, and by more than one of what does not average out: the ground beside
  /// the border is not the plane's.
  bool found() const { return away_m > 0.0f && square(away_m) > gate * variance_m2 && square(away_m) > common_m2; }
  /// Variance of the side's height there. The cells' own if they tell it; else the plane may be wrong by up to half of
  /// what they lie off it beyond that, evenly.
  float height_variance_m2() const { return found() ? variance_m2 : (1.0f / 12) * beyond_m2(); }
  /// Mean square, of as many borders as there are on this side, of what makes the planes lie farther apart than the
  /// ground does.
  float too_far_m2(float of_borders) const { return away_m < 0.0f ? borders / of_borders * beyond_m2() : 0.0f; }

 private:
  float beyond_m2() const { return std::max(0.0f, square(away_m) - variance_m2); }
};

/// Of a side that begins `further_cells` beyond the borders, at the near end of a step down's shadow. `away` is 1 if
/// the other side lies below, -1 if above. Each cell is one observation, but for the common_m2 of its variance that
/// points of a place may share; of no border it is 0.
Deviation deviation(const Beside& beside, const Plane& plane, float away, float further_cells, float common_m2);

}  // namespace curbline
