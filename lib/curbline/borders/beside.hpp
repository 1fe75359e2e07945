// What the two cells next to a border show of the ground on its sides, carried on to the border: what becomes of it is
// in curbs/off_plane.hpp. Cost: two cells for each border and side.
#pragma once

namespace curbline {

/// Sums over borders of one side of a curb.
struct Beside {
  float borders = 0.0f;         ///< borders with both cells on the side's plane and nothing else in them
  float off_m = 0.0f;           ///< height above the plane, at the border
  float rise_m = 0.0f;          ///< rise beyond the plane's, per cell toward the border
  float away_cells = 0.0f;      ///< distance of the nearer cell's middle from the border
  float inverse_points = 0.0f;  ///< 1 / points of a cell, mean of both

  struct Shown {
    float above_m, points;  ///< height above the plane
  };
  /// Of one border, by its two cells, the nearer one's middle `away` cells from it.
  static Beside of(const Shown& nearer, const Shown& farther, float away) {
    const float rise_m = nearer.above_m - farther.above_m;
    return {1.0f, nearer.above_m + away * rise_m, rise_m, away, 0.5f / nearer.points + 0.5f / farther.points};
  }
  void add(const Beside& other) {
    borders += other.borders;
    off_m += other.off_m;
    rise_m += other.rise_m;
    away_cells += other.away_cells;
    inverse_points += other.inverse_points;
  }
};

}  // namespace curbline
