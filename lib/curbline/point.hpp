// A point on its way from the laser into a cell, and the place from which it is seen.
#pragma once

namespace curbline {

/// Bound of growth_m_s: a servo at 3 rad/s, ground 10 m away. Beyond, a tilt reading is wrong.
inline constexpr float most_growth_m_s = 31.0f;

inline constexpr float usual_bearing_step_rad = 0.004363323f;  ///< a quarter of a degree
inline constexpr float usual_divergence_rad = 0.01f;  ///< of a beam, full angle; data sheets state 5 to 15 mrad

/// Metres, in the map frame; variance_m2 is that of z, from range, bearing, tilt, mount and pose (ProjectedLine).
struct Point {
  float x_m = 0.0f;
  float y_m = 0.0f;
  float z_m = 0.0f;
  float variance_m2 = 0.0f;
  /// Derivative of z by the tilt's latency; 0 without a servo. Cells keep its mean: as the latency becomes known, their
  /// heights move by that (Dem::delay()).
  float growth_m_s = 0.0f;
  /// From here to the place by the ranges of the two neighbouring beams. The point goes into the cell there: by its own
  /// range error it would cross a cell's border or not, and where the next cell is not seen those that do are all too
  /// high, or all too low.
  float shift_x_m = 0.0f, shift_y_m = 0.0f;

  float place_x_m() const { return x_m + shift_x_m; }
  float place_y_m() const { return y_m + shift_y_m; }
};

/// A part of the map, up to its ceiling.
struct Bounds {
  float low_x_m, low_y_m, high_x_m, high_y_m, ceiling_m;

  /// False if a coordinate is not finite.
  bool hold(float x_m, float y_m, float z_m) const {
    return x_m >= low_x_m && x_m <= high_x_m && y_m >= low_y_m && y_m <= high_y_m && z_m <= ceiling_m;
  }
};

/// Where the laser looks from, the tilt axis: x and y in the window's frame, z of the map frame.
struct Viewpoint {
  float x_m = 0.0f, y_m = 0.0f, z_m = 0.0f;
  /// The window's size on a robot that drives: cells were seen from as far away as the window's end. 0 on one that
  /// stands.
  float end_x_m = 0.0f, end_y_m = 0.0f;
  bool localisation_steps = false;                  ///< it has been found to step: PoseOffset::localisation_steps()
  float divergence_rad = usual_divergence_rad;      ///< of a beam: LaserSettings::beam_divergence_rad
  float bearing_step_rad = usual_bearing_step_rad;  ///< from beam to beam, above 0

  /// Length of a beam's spot on level ground that lies above_m below the laser, sqrt(range_m2) away.
  float spot_m(float range_m2, float above_m) const { return divergence_rad * range_m2 / above_m; }
  bool drives() const { return end_x_m > 0.0f; }
  /// Along x (axis 0) or y (1).
  float place_m(int axis) const { return axis == 0 ? x_m : y_m; }
  float end_m(int axis) const { return axis == 0 ? end_x_m : end_y_m; }
};

}  // namespace curbline
