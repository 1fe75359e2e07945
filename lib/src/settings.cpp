#include "curbline/settings.hpp"

#include "curbline/grid.hpp"
#include "curbline/math.hpp"

namespace curbline {
namespace {

/// In [low, high]; false for NaN.
bool within(float x, float low, float high) {
  return x >= low && x <= high;
}
bool positive(float x) {
  return is_finite(x) && x > 0.0f;
}
bool not_negative(float x) {
  return is_finite(x) && x >= 0.0f;
}

bool good(const MountSettings& m) {
  for (const float length : {m.x_m, m.y_m, m.z_m}) {
    if (!within(length, -100.0f, 100.0f)) return false;
  }
  for (const float angle : {m.roll_rad, m.pitch_rad, m.yaw_rad}) {
    if (!within(angle, -2.0f * pi, 2.0f * pi)) return false;
  }
  return true;
}

bool good(const WindowSettings& w) {
  return w.rows >= block_side && w.cols >= block_side && w.rows % block_side == 0 && w.cols % block_side == 0 &&
         within(w.cell_x_m, 0.001f, 10.0f) && within(w.cell_y_m, 0.001f, 10.0f) && within(w.origin_x_m, -1e6f, 1e6f) &&
         within(w.origin_y_m, -1e6f, 1e6f) && is_finite(w.max_height_m);
}

bool good(const LaserSettings& l) {
  return l.beams >= 1 && within(l.first_bearing_rad, -2.0f * pi, 2.0f * pi) &&
         within(l.bearing_step_rad, -1.0f, 1.0f) && l.bearing_step_rad != 0.0f &&
         within(l.first_bearing_rad + static_cast<float>(l.beams) * l.bearing_step_rad, -4.0f * pi, 4.0f * pi) &&
         within(l.beam_interval_s, 0.0f, 1.0f) && not_negative(l.min_range_m) && is_finite(l.max_range_m) &&
         l.max_range_m > l.min_range_m && not_negative(l.range_sd_m) && not_negative(l.bearing_sd_rad);
}

bool good(const TiltSettings& t) {
  return good(t.T_base_tilt) && good(t.T_tilt_laser) && within(t.fixed_tilt_rad, -pi, pi) &&
         within(t.latency_s, -10.0f, 10.0f) && within(t.latency_sd_s, 0.0f, 1.0f) && not_negative(t.angle_sd_rad) &&
         not_negative(t.time_sd_s) && within(t.max_extrapolation_s, 0.0f, 10.0f) && positive(t.max_gap_s) &&
         t.max_gap_s <= 10.0f && not_negative(t.roll_sd_rad) && not_negative(t.pitch_sd_rad);
}

bool good(const PoseSettings& p) {
  return not_negative(p.height_sd_m) && not_negative(p.attitude_sd_rad) && within(p.max_extrapolation_s, 0.0f, 10.0f);
}

bool good_inference(const Settings& s) {
  const PlanePrior& prior = s.planes.prior;
  return positive(s.segmentation.cell.degrees) && positive(s.segmentation.cell.variance_m2) &&
         positive(s.segmentation.leaf_scale) && s.segmentation.link_reach >= 1 &&
         s.segmentation.link_reach <= max_link_reach && positive(prior.noise_m2) && not_negative(prior.texture_m2) &&
         within(prior.degrees, 1.0f, 1e6f) && within(prior.common_share, PlanePrior::least_common_share, 1.0f) &&
         within(prior.curvature_1_m, 0.0f, 10.0f) && s.planes.min_cells >= 3.0f &&
         within(s.labels.coupling, 0.01f, 7.9f) && s.labels.link_reach >= 1 && s.labels.link_reach <= max_link_reach &&
         s.labels.refresh_rows >= 0 && (s.labels.max_messages == 0 || s.labels.max_messages >= 4) &&
         s.curbs.link_reach >= 1 && s.curbs.link_reach <= max_link_reach && positive(s.curbs.max_step_m);
}

}  // namespace

Status check(const Settings& settings) {
  if (!good(settings.window)) return Status::bad_window;
  if (!good(settings.laser)) return Status::bad_laser;
  if (!good(settings.tilt)) return Status::bad_tilt;
  if (!good(settings.pose)) return Status::bad_pose;
  if (!good_inference(settings)) return Status::bad_inference;
  return Status::ok;
}

}  // namespace curbline
