// A point on its way from the laser into a cell, and where it was seen from.
#pragma once

#include "curbline/math.hpp"

namespace curbline {

/// No tilt makes ground grow faster: 3 rad/s, seen 10 m away. What does is a wrong reading's.
inline constexpr float most_growth_m_s = 31.0f;

/// Metres, in the map frame; variance_m2 is that of z, from range, bearing, tilt, mount and pose (ProjectedLine).
struct Point {
  float x_m = 0.0f;
  float y_m = 0.0f;
  float z_m = 0.0f;
  float variance_m2 = 0.0f;
  float growth_m_s = 0.0f;  ///< of z, by a second that is added to the tilt's latency, its derivative; 0 of what no
                            ///< servo tilts
  /// From here to where the beams beside its own have it. It goes to the cell there: by its own error in range it would
  /// cross a cell's border or not, and where the next cell is not seen those that do are all too high, or too low.
  float shift_x_m = 0.0f, shift_y_m = 0.0f;

  float place_x_m() const { return x_m + shift_x_m; }
  float place_y_m() const { return y_m + shift_y_m; }
};

/// A part of the map, as high as its ceiling.
struct Bounds {
  float low_x_m, low_y_m, high_x_m, high_y_m, ceiling_m;

  /// False of what is not finite.
  bool hold(float x_m, float y_m, float z_m) const {
    return x_m >= low_x_m && x_m <= high_x_m && y_m >= low_y_m && y_m <= high_y_m && z_m <= ceiling_m;
  }
};

/// Where the laser looks from, the tilt axis: x and y in the window's frame, z of the map frame.
struct Viewpoint {
  float x_m = 0.0f, y_m = 0.0f, z_m = 0.0f;
  /// Of a robot that drives, the window's size: what lies in it was seen from as far away as its end. 0 of one that
  /// stands.
  float end_x_m = 0.0f, end_y_m = 0.0f;

  bool drives() const { return end_x_m > 0.0f; }
  /// How the variance of cells about (px_m, py_m), of which the places scatter by `scatter_m2`, grows by what scan
  /// lines err in tilt and pose: each by the square of how far it falls from the laser, along the ground, and the mean
  /// of a cell by the less, the more points of them it holds. What a robot that drives maps it has seen from near and
  /// from afar: there the points alone tell, as if all were 1 m away.
  float reach_m2(float px_m, float py_m, float scatter_m2, float points_a_cell) const {
    const float away_m2 = drives() ? 1.0f : square(px_m - x_m) + square(py_m - y_m) + scatter_m2;
    return away_m2 / points_a_cell;
  }
};

}  // namespace curbline
