#include "curbline/settings.hpp"

#include "curbline/grid.hpp"
#include "curbline/math.hpp"
#include "curbline/setting_ranges.hpp"

namespace curbline {
namespace {

namespace ranges = setting_ranges;

/// In [low, high]; false for NaN. Not inlined: a copy for each setting takes 400 bytes of flash in all.
[[gnu::noinline]] bool within(float x, float low, float high) {
  return x >= low && x <= high;
}
bool within(float x, SettingRange range) {
  return within(x, static_cast<float>(range.lowest), static_cast<float>(range.highest));
}
bool whole_blocks(int cells, int most) {
  return cells >= block_side && cells <= most && cells % block_side == 0;
}
bool reach(int cells) {
  return cells >= 1 && cells <= max_link_reach;
}
bool corner(float m) {
  return within(m, -WindowSettings::furthest_m, WindowSettings::furthest_m);
}
bool good(const MountSettings& m) {
  return within(m.x_m, ranges::mount_m) && within(m.y_m, ranges::mount_m) && within(m.z_m, ranges::mount_m) &&
         within(m.roll_rad, ranges::angle_rad) && within(m.pitch_rad, ranges::angle_rad) &&
         within(m.yaw_rad, ranges::angle_rad);
}

/// Name of the first bad setting of a part; null if there is none.
using Bad = const char*;

Bad first_bad(const WindowSettings& w, const Limits& limits) {
  if (!whole_blocks(w.rows, limits.rows)) return "window.rows";
  if (!whole_blocks(w.cols, limits.cols)) return "window.cols";
  if (!within(w.cell_x_m, ranges::cell_m)) return "window.cell_x_m";
  if (!within(w.cell_y_m, ranges::cell_m)) return "window.cell_y_m";
  if (!corner(w.origin_x_m)) return "window.origin_x_m";
  if (!corner(w.origin_y_m)) return "window.origin_y_m";
  return within(w.max_height_m, ranges::max_height_m) ? nullptr : "window.max_height_m";
}

Bad first_bad(const LaserSettings& l, const Limits& limits) {
  if (l.beams < 1 || l.beams > limits.beams) return "laser.beams";
  if (!within(l.first_bearing_rad, ranges::angle_rad)) return "laser.first_bearing_rad";
  const float last_rad = l.first_bearing_rad + static_cast<float>(l.beams) * l.bearing_step_rad;
  if (!within(l.bearing_step_rad, ranges::bearing_step_rad) || l.bearing_step_rad == 0.0f ||
      !within(last_rad, -4.0f * pi, 4.0f * pi))
    return "laser.bearing_step_rad";
  if (!within(l.beam_interval_s, ranges::beam_interval_s)) return "laser.beam_interval_s";
  if (!within(l.min_range_m, ranges::range_m)) return "laser.min_range_m";
  if (!within(l.max_range_m, ranges::range_m) || l.max_range_m <= l.min_range_m) return "laser.max_range_m";
  if (!within(l.range_sd_m, ranges::deviation_m)) return "laser.range_sd_m";
  if (!within(l.bearing_sd_rad, ranges::deviation_rad)) return "laser.bearing_sd_rad";
  return within(l.beam_divergence_rad, ranges::divergence_rad) ? nullptr : "laser.beam_divergence_rad";
}

Bad first_bad(const TiltSettings& t) {
  if (!good(t.T_base_tilt)) return "tilt.T_base_tilt";
  if (!good(t.T_tilt_laser)) return "tilt.T_tilt_laser";
  if (!within(t.fixed_tilt_rad, ranges::fixed_tilt_rad)) return "tilt.fixed_tilt_rad";
  if (!within(t.latency_s, ranges::latency_s)) return "tilt.latency_s";
  if (!within(t.latency_sd_s, ranges::deviation_s)) return "tilt.latency_sd_s";
  if (!within(t.angle_sd_rad, ranges::deviation_rad)) return "tilt.angle_sd_rad";
  if (!within(t.time_sd_s, ranges::deviation_s)) return "tilt.time_sd_s";
  if (!within(t.max_extrapolation_s, ranges::extrapolation_s)) return "tilt.max_extrapolation_s";
  if (!within(t.max_gap_s, ranges::max_gap_s)) return "tilt.max_gap_s";
  if (!within(t.roll_sd_rad, ranges::deviation_rad)) return "tilt.roll_sd_rad";
  return within(t.pitch_sd_rad, ranges::deviation_rad) ? nullptr : "tilt.pitch_sd_rad";
}

Bad first_bad(const PoseSettings& p) {
  if (!within(p.height_sd_m, ranges::deviation_m)) return "pose.height_sd_m";
  if (!within(p.attitude_sd_rad, ranges::deviation_rad)) return "pose.attitude_sd_rad";
  if (!within(p.lean_sd_rad, ranges::lean_sd_rad)) return "pose.lean_sd_rad";
  return within(p.max_extrapolation_s, ranges::extrapolation_s) ? nullptr : "pose.max_extrapolation_s";
}

static_assert(static_cast<float>(ranges::common_share.lowest) == PlanePrior::least_common_share);

Bad first_bad_of_inference(const Settings& s) {
  if (!within(s.segmentation.cell.degrees, ranges::degrees)) return "segmentation.cell.degrees";
  if (!within(s.segmentation.cell.variance_m2, ranges::variance_m2)) return "segmentation.cell.variance_m2";
  if (!within(s.segmentation.leaf_scale, ranges::leaf_scale)) return "segmentation.leaf_scale";
  if (!reach(s.segmentation.link_reach)) return "segmentation.link_reach";
  const PlanePrior& prior = s.planes.prior;
  if (!within(prior.noise_m2, ranges::variance_m2)) return "planes.prior.noise_m2";
  if (!within(prior.texture_m2, 0.0f, prior.noise_m2)) return "planes.prior.texture_m2";
  if (!within(prior.degrees, ranges::noise_degrees)) return "planes.prior.degrees";
  if (!within(prior.common_share, ranges::common_share)) return "planes.prior.common_share";
  if (!within(prior.curvature_1_m, ranges::curvature_1_m)) return "planes.prior.curvature_1_m";
  if (!within(s.planes.min_cells, ranges::min_cells)) return "planes.min_cells";
  if (!within(s.labels.coupling, ranges::coupling)) return "labels.coupling";
  if (!reach(s.labels.link_reach)) return "labels.link_reach";
  if (s.labels.max_messages && *s.labels.max_messages < 4) return "labels.max_messages";
  if (!reach(s.curbs.link_reach)) return "curbs.link_reach";
  return within(s.curbs.max_step_m, ranges::max_step_m) ? nullptr : "curbs.max_step_m";
}

struct Refusal {
  Status status = Status::ok;
  Bad setting = nullptr;
};

Refusal refusal(const Settings& s, const Limits& limits) {
  if (const Bad bad = first_bad(s.window, limits)) return {Status::bad_window, bad};
  if (const Bad bad = first_bad(s.laser, limits)) return {Status::bad_laser, bad};
  if (const Bad bad = first_bad(s.tilt)) return {Status::bad_tilt, bad};
  if (const Bad bad = first_bad(s.pose)) return {Status::bad_pose, bad};
  if (const Bad bad = first_bad_of_inference(s)) return {Status::bad_inference, bad};
  return {};
}

}  // namespace

const char* bad_setting(const Settings& settings, const Limits& limits) {
  return refusal(settings, limits).setting;
}

Status check(const Settings& settings, const Limits& limits) {
  return refusal(settings, limits).status;
}

}  // namespace curbline
