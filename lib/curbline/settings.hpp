// What the builder of a robot states: geometry, noise and tuning, each with its unit, range and reason. Checked once,
// at init; a bad setting is refused with the Status of its part, and bad_setting() names it. setting_ranges.hpp has the
// ranges as numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "curbline/cell_prior.hpp"
#include "curbline/limits.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"
#include "curbline/status.hpp"

namespace curbline {

/// The rolling window: rows x cols cells of cell_x_m by cell_y_m, along the map's axes. It follows the robot in steps
/// of four cells, so that its centre stays at one place in the base frame, whatever the heading. Its corner and
/// max_height_m are in the base frame, for a robot that heads along the map's x axis; for a fixed window, in the map
/// frame.
struct WindowSettings {
  static constexpr float furthest_m = 1e5f;  ///< of the corner along each axis: float tells a centimetre there
  int rows = 40;                             ///< cells along x, a multiple of 4, at most Limits::rows
  int cols = 40;                             ///< cells along y, a multiple of 4, at most Limits::cols
  float cell_x_m = 0.1f;                     ///< [0.001, 10]; as in the paper, and as far as lines of a nodding
  float cell_y_m = 0.1f;                     ///< laser lie apart 3 m away (tools/robots/README.md); the same
  float origin_x_m = 0.0f;                   ///< lowest corner, [-furthest_m, furthest_m]
  float origin_y_m = -2.0f;                  ///< the same along y
  bool fixed = false;                        ///< true: the window never moves
  float max_height_m = 1e9f;                 ///< points above it are ignored; finite
};

/// The range-finder, from its data sheet.
struct LaserSettings {
  int beams = 1081;                       ///< 1 to Limits::beams
  float first_bearing_rad = -2.3561945f;  ///< of beam 0, counterclockwise about the laser's z axis, [-2 pi, 2 pi]
  float bearing_step_rad = usual_bearing_step_rad;  ///< [-1, 1], negative for a scanner that turns clockwise; not 0.
                                                    ///< first_bearing_rad + beams * this: [-4 pi, 4 pi]
  float beam_interval_s = 25e-3f / 1440.f;  ///< between beams, [0, 1]: a UTM-30LX takes 1440 steps a turn of 25 ms
  float min_range_m = 0.1f;                 ///< readings below, and 0, mean no return; [0, 1e6]
  float max_range_m = 30.0f;                ///< readings at or above mean no return; (min_range_m, 1e6]. Of a UTM-30LX
                                            ///< what its data sheet guarantees; it gives some to 60 m
  float range_sd_m = 0.01f;                 ///< standard deviation of a range, [0, 10]
  /// Of a bearing, [0, 1]. No data sheet states it: 0.5 mrad is what a mirror of 40 Hz turns in 2 us. 3 m away it moves
  /// the height of a point on the ground by half a millimetre, where range_sd_m moves it by 4.
  float bearing_sd_rad = 0.0005f;
  float beam_divergence_rad = usual_divergence_rad;  ///< full angle, 10 mrad unless set, [0, 1]

  /// From one beam to the next, in whole nanoseconds.
  std::int64_t beam_interval_ns() const { return static_cast<std::int64_t>(beam_interval_s * 1e9f + 0.5f); }
  /// From the first beam of a line of `count` to the last.
  std::int64_t duration_ns(std::size_t count) const { return duration_ns(count, beam_interval_ns()); }
  static std::int64_t duration_ns(std::size_t count, std::int64_t interval_ns) {
    return count > 1 ? static_cast<std::int64_t>(count - 1) * interval_ns : 0;
  }
};

/// A rigid transform as a builder measures it: rotation R_z(yaw) R_y(pitch) R_x(roll), then translation. Lengths in
/// [-100, 100], angles in [-2 pi, 2 pi].
struct MountSettings {
  float x_m = 0.0f, y_m = 0.0f, z_m = 0.0f;
  float roll_rad = 0.0f, pitch_rad = 0.0f, yaw_rad = 0.0f;
};

/// The tilt axis. p_base = T_base_tilt * R_y(tilt) * T_tilt_laser * p_laser; tilt > 0 looks down.
struct TiltSettings {
  MountSettings T_base_tilt{};
  MountSettings T_tilt_laser{};
  bool fixed = false;           ///< true: no servo, the angle is fixed_tilt_rad
  float fixed_tilt_rad = 0.0f;  ///< [-pi, pi]
  float latency_s = 0.0f;       ///< [-10, 10]: an angle stamped t was true at t - latency_s
  float latency_sd_s = 0.01f;   ///< [0, 1]: its error, and change between sweeps; 0: it is not estimated
  /// Of one reading, [0, 1]: its step / sqrt(12), 0.44 mrad with 4096 counts a turn, and the play of the gear, say 3
  /// arc minutes, 0.87 mrad: together 1.
  float angle_sd_rad = 0.001f;
  /// Jitter of its time stamp, [0, 1], by the tilt's rate an error of the angle. 0: of a drive that samples on a SYNC
  /// frame; a frame that waits for another on a bus of 125 kbit/s is a millisecond late.
  float time_sd_s = 0.0f;
  /// [0, 10]: beams later than the newest reading by more are dropped. Two periods of a servo of 50 Hz, one frame of
  /// which is lost, and a latency of 10 ms. The two readings that show the rate lie at least half as far apart: the
  /// angle errs by up to sqrt(3^2 + 2^2) angle_sd_rad.
  float max_extrapolation_s = 0.05f;
  /// [1e-4, 10]: no interpolation between readings further apart. Two periods of a servo of 10 Hz, one frame of which
  /// is lost. Less is better for faster ones: while the servo reverses, accelerating by a, the line between readings T
  /// apart is off by up to a T^2 / 8, at 3 rad/s^2 15 mrad in 0.2 s, but 1 mrad in 0.05 s.
  float max_gap_s = 0.2f;
  /// Of the mount about an x axis through the tilt axis' origin, and about y, [0, 1]. 0: it is rigid, so that its error
  /// tilts the map as a whole; while the robot drives that of its pitch is found (PoseSettings::lean_sd_rad).
  float roll_sd_rad = 0.0f;
  float pitch_sd_rad = 0.0f;
};

/// The robot's pose, T_map_base. A robot that stands gives none. One that drives must state both deviations: with 0
/// every rounding of a pose is a jump, and a step of its localisation cannot be told from a curb that it climbs.
struct PoseSettings {
  bool still = true;             ///< true: no poses will come, base and map frame are one
  float height_sd_m = 0.0f;      ///< of each pose's z, independent of the next one's: jitter, not drift. [0, 10];
                                 ///< standing, how much the robot sways: for the variance of heights; the tilt's
                                 ///< latency is estimated as if it did not
  float attitude_sd_rad = 0.0f;  ///< of roll and pitch, [0, 1]; standing, the same
  float lean_sd_rad = 0.005f;    ///< of the laser's pitch against the poses, [0, 0.05]: mount, zero of the attitude,
                                 ///< z that drifts with the way. 0: it is not estimated, as is
                                 ///< best of a laser that looks more to the side than ahead: there all but the
                                 ///< servo's own zero comes out too large
  /// [0, 10]: lines further from the nearest pose are dropped. Of poses of 10 Hz one may be lost, and no line
  /// between the others lies further. A robot that brakes by 1 m/s^2 is 5 mm short of its extrapolated place by then.
  float max_extrapolation_s = 0.1f;
};

/// How cells become regions. lib/README.md has the reason of each constant, and how little depends on it.
struct SegmentationSettings {
  CellPrior cell{};
  float leaf_scale = 2.0f;  ///< Felzenszwalb and Huttenlocher's s, inside a block only; [1e-3, 1e6]
  int link_reach = 10;      ///< cells; neighbours further apart are not linked, 1 to max_link_reach
};

/// Where a plane's parameters come from.
enum class PlaneUpdate : unsigned char {
  regions,           ///< moments of its region: scores better
  responsibilities,  ///< the M-step of the paper's EM, from the beliefs of the label field
};

struct PlaneSettings {
  PlanePrior prior{};      ///< of the ground's noise and curvature
  float min_cells = 4.0f;  ///< fewer cells make no plane, 3 to 1e6; 4 is one more than a plane has parameters
  PlaneUpdate update = PlaneUpdate::regions;
};

struct LabelSettings {
  float coupling = 1.5f;  ///< J of the Potts factor exp(J) between like labels, [0.01, 7.9]
  int link_reach = 10;    ///< as in SegmentationSettings; the coupling falls as 1 / distance
  /// Per call, >= 4. Cells left over wait for the next call; with at least 4 * cols none waits for ever. Not set: that
  /// many or, where it is more, five for every eight cells, 1000 in the usual window: as many as the budgets of board/
  /// allow.
  std::optional<int> max_messages{};
};

struct CurbSettings {
  int link_reach = 5;       ///< cells, 1 to max_link_reach: the widest gap of a curb, unless a step down hides more
  float max_step_m = 0.3f;  ///< [1e-3, 1000]; a higher step up is an obstacle, not a curb: curbs and steps of stairs
                            ///< stay below 0.2 m, and half as much again allows for the unusual. A step down may have
                            ///< any depth, unless its upper side lies behind such a step up, nearer to the laser
};

/// Everything, as Pipeline::init() takes it.
struct Settings {
  WindowSettings window{};
  LaserSettings laser{};
  TiltSettings tilt{};
  PoseSettings pose{};
  SegmentationSettings segmentation{};
  PlaneSettings planes{};
  LabelSettings labels{};
  CurbSettings curbs{};
};

/// The first setting that is out of its range, or beyond these limits, by its name here, as in "tilt.max_gap_s". Null
/// if all are good. Static storage.
[[gnu::cold]] const char* bad_setting(const Settings& settings, const Limits& limits);

/// The part of the settings that it belongs to, ok if all are good: what Pipeline::init() returns.
[[gnu::cold]] Status check(const Settings& settings, const Limits& limits);

}  // namespace curbline
