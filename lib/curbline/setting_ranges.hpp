// What each setting may be: what check() refuses, and what programs that read settings from files may tell their users.
// Settings with a bound that depends on other settings, or on the limits, are not here.
#pragma once

#include <limits>

namespace curbline {

/// Both ends included; a setting is compared with them as a float.
struct SettingRange {
  double lowest, highest;
};

namespace setting_ranges {

inline constexpr double half_turn = 3.141592653589793;
inline constexpr SettingRange angle_rad{-2.0 * half_turn, 2.0 * half_turn};
// Standard deviations: larger ones are in a wrong unit.
inline constexpr SettingRange deviation_m{0.0, 10.0}, deviation_rad{0.0, 1.0}, deviation_s{0.0, 1.0};
inline constexpr SettingRange extrapolation_s{0.0, 10.0};

// Window.
inline constexpr SettingRange cell_m{0.001, 10.0};
inline constexpr auto any_height_m = static_cast<double>(std::numeric_limits<float>::max());
inline constexpr SettingRange max_height_m{-any_height_m, any_height_m};
// Laser.
inline constexpr SettingRange bearing_step_rad{-1.0, 1.0};
inline constexpr SettingRange beam_interval_s{0.0, 1.0};
inline constexpr SettingRange range_m{0.0, 1e6};
inline constexpr SettingRange divergence_rad{0.0, 1.0};
// Tilt and pose.
inline constexpr SettingRange mount_m{-100.0, 100.0};
inline constexpr SettingRange fixed_tilt_rad{-half_turn, half_turn};
inline constexpr SettingRange latency_s{-10.0, 10.0};
inline constexpr SettingRange max_gap_s{1e-4, 10.0};
inline constexpr SettingRange lean_sd_rad{0.0, 0.05};
// Inference.
inline constexpr SettingRange degrees{1e-3, 1e6};
inline constexpr SettingRange variance_m2{1e-10, 100.0};
inline constexpr SettingRange leaf_scale{1e-3, 1e6};
inline constexpr SettingRange noise_degrees{1.0, 1e6};
inline constexpr SettingRange common_share{0.01, 1.0};
inline constexpr SettingRange curvature_1_m{0.0, 10.0};
inline constexpr SettingRange min_cells{3.0, 1e6};
inline constexpr SettingRange coupling{0.01, 7.9};
inline constexpr SettingRange max_step_m{1e-3, 1000.0};

}  // namespace setting_ranges
}  // namespace curbline
