#include "curbline/settings.hpp"

#include "curbline/grid.hpp"
#include "curbline/math.hpp"

namespace curbline {
namespace {

/// In [low, high]; false for NaN. Not inlined: a copy for each setting takes 400 bytes of flash in all.
[[gnu::noinline]] bool within(float x, float low, float high) {
  return x >= low && x <= high;
}
bool positive(float x) {
  return is_finite(x) && x > 0.0f;
}
/// Standard deviations: larger ones are in a wrong unit.
bool deviation_m(float x) {
  return within(x, 0.0f, 10.0f);
}
bool deviation_rad(float x) {
  return within(x, 0.0f, 1.0f);
}
bool whole_blocks(int cells, int most) {
  return cells >= block_side && cells <= most && cells % block_side == 0;
}
bool reach(int cells) {
  return cells >= 1 && cells <= max_link_reach;
}
bool bearing(float rad) {
  return within(rad, -2.0f * pi, 2.0f * pi);
}
bool corner(float m) {
  return within(m, -WindowSettings::furthest_m, WindowSettings::furthest_m);
}
bool good(const MountSettings& m) {
  return within(m.x_m, -100.0f, 100.0f) && within(m.y_m, -100.0f, 100.0f) && within(m.z_m, -100.0f, 100.0f) &&
         bearing(m.roll_rad) && bearing(m.pitch_rad) && bearing(m.yaw_rad);
}

/// Name of the first bad setting of a part; null if there is none.
using Bad = const char*;

Bad first_bad(const WindowSettings& w, const Limits& limits) {
  if (!whole_blocks(w.rows, limits.rows)) return "window.rows";
  if (!whole_blocks(w.cols, limits.cols)) return "window.cols";
  if (!within(w.cell_x_m, 0.001f, 10.0f)) return "window.cell_x_m";
  if (!within(w.cell_y_m, 0.001f, 10.0f)) return "window.cell_y_m";
  if (!corner(w.origin_x_m)) return "window.origin_x_m";
  if (!corner(w.origin_y_m)) return "window.origin_y_m";
  return is_finite(w.max_height_m) ? nullptr : "window.max_height_m";
}

Bad first_bad(const LaserSettings& l, const Limits& limits) {
  if (l.beams < 1 || l.beams > limits.beams) return "laser.beams";
  if (!bearing(l.first_bearing_rad)) return "laser.first_bearing_rad";
  const float last_rad = l.first_bearing_rad + static_cast<float>(l.beams) * l.bearing_step_rad;
  if (!within(l.bearing_step_rad, -1.0f, 1.0f) || l.bearing_step_rad == 0.0f ||
      !within(last_rad, -4.0f * pi, 4.0f * pi))
    return "laser.bearing_step_rad";
  if (!within(l.beam_interval_s, 0.0f, 1.0f)) return "laser.beam_interval_s";
  if (!within(l.min_range_m, 0.0f, 1e6f)) return "laser.min_range_m";
  if (!within(l.max_range_m, 0.0f, 1e6f) || l.max_range_m <= l.min_range_m) return "laser.max_range_m";
  if (!deviation_m(l.range_sd_m)) return "laser.range_sd_m";
  if (!deviation_rad(l.bearing_sd_rad)) return "laser.bearing_sd_rad";
  return within(l.beam_divergence_rad, 0.0f, 1.0f) ? nullptr : "laser.beam_divergence_rad";
}

Bad first_bad(const TiltSettings& t) {
  if (!good(t.T_base_tilt)) return "tilt.T_base_tilt";
  if (!good(t.T_tilt_laser)) return "tilt.T_tilt_laser";
  if (!within(t.fixed_tilt_rad, -pi, pi)) return "tilt.fixed_tilt_rad";
  if (!within(t.latency_s, -10.0f, 10.0f)) return "tilt.latency_s";
  if (!within(t.latency_sd_s, 0.0f, 1.0f)) return "tilt.latency_sd_s";
  if (!deviation_rad(t.angle_sd_rad)) return "tilt.angle_sd_rad";
  if (!within(t.time_sd_s, 0.0f, 1.0f)) return "tilt.time_sd_s";
  if (!within(t.max_extrapolation_s, 0.0f, 10.0f)) return "tilt.max_extrapolation_s";
  if (!positive(t.max_gap_s) || t.max_gap_s > 10.0f) return "tilt.max_gap_s";
  if (!deviation_rad(t.roll_sd_rad)) return "tilt.roll_sd_rad";
  return deviation_rad(t.pitch_sd_rad) ? nullptr : "tilt.pitch_sd_rad";
}

Bad first_bad(const PoseSettings& p) {
  if (!deviation_m(p.height_sd_m)) return "pose.height_sd_m";
  if (!deviation_rad(p.attitude_sd_rad)) return "pose.attitude_sd_rad";
  if (!within(p.lean_sd_rad, 0.0f, 0.05f)) return "pose.lean_sd_rad";
  return within(p.max_extrapolation_s, 0.0f, 10.0f) ? nullptr : "pose.max_extrapolation_s";
}

Bad first_bad_of_inference(const Settings& s) {
  if (!within(s.segmentation.cell.degrees, 1e-3f, 1e6f)) return "segmentation.cell.degrees";
  if (!within(s.segmentation.cell.variance_m2, 1e-10f, 100.0f)) return "segmentation.cell.variance_m2";
  if (!positive(s.segmentation.leaf_scale)) return "segmentation.leaf_scale";
  if (!reach(s.segmentation.link_reach)) return "segmentation.link_reach";
  const PlanePrior& prior = s.planes.prior;
  if (!within(prior.noise_m2, 1e-10f, 100.0f)) return "planes.prior.noise_m2";
  if (!within(prior.texture_m2, 0.0f, prior.noise_m2)) return "planes.prior.texture_m2";
  if (!within(prior.degrees, 1.0f, 1e6f)) return "planes.prior.degrees";
  if (!within(prior.common_share, PlanePrior::least_common_share, 1.0f)) return "planes.prior.common_share";
  if (!within(prior.curvature_1_m, 0.0f, 10.0f)) return "planes.prior.curvature_1_m";
  if (!within(s.planes.min_cells, 3.0f, 1e6f)) return "planes.min_cells";
  if (!within(s.labels.coupling, 0.01f, 7.9f)) return "labels.coupling";
  if (!reach(s.labels.link_reach)) return "labels.link_reach";
  if (s.labels.max_messages && *s.labels.max_messages < 4) return "labels.max_messages";
  if (!reach(s.curbs.link_reach)) return "curbs.link_reach";
  return positive(s.curbs.max_step_m) ? nullptr : "curbs.max_step_m";
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
