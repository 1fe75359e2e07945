#include "curbline/tilt_latency.hpp"

#include "curbline/line_fit.hpp"

namespace curbline {
namespace {

/// A servo that has come back by so much has turned round: less than any sweep worth one, more than play, overshoot and the damaged
/// readings of a degree or two that servos have been seen to send.
constexpr float turn_rad = 0.05f;

}  // namespace

void TiltLatency::init(const TiltSettings& tilt, const PoseSettings& pose) {
  *this = TiltLatency{};
  prior_variance_s2_ = tilt.latency_sd_s * tilt.latency_sd_s;
  time_variance_s2_ = tilt.time_sd_s * tilt.time_sd_s;
  angle_variance_ = tilt.angle_sd_rad * tilt.angle_sd_rad;
  if (!pose.still) {
    angle_variance_ += pose.attitude_sd_rad * pose.attitude_sd_rad;
    height_variance_m2_ = pose.height_sd_m * pose.height_sd_m;
  }
  state_.fill({0.0f, prior_variance_s2_});
}

bool TiltLatency::follow(float angle_rad) {
  if (!any_angle_) {
    any_angle_ = true;
    extreme_rad_ = angle_rad;
    return true;
  }
  const float sign = sweep_ == 1 ? 1.0f : -1.0f;
  const float advance = sign * (angle_rad - extreme_rad_);
  if (advance > 0.0f) extreme_rad_ = angle_rad;
  if (advance >= -turn_rad) return false;
  sweep_ ^= 1u;
  extreme_rad_ = angle_rad;
  state_[sweep_].variance_s2 += prior_variance_s2_;
  return true;
}

void TiltLatency::compare(float above_m, float variance_m2, float growth_m_s) {
  const float variance = variance_m2 + growth_m_s * growth_m_s * state_[sweep_].variance_s2;
  if (above_m * above_m > 9.0f * variance) return;  // another surface: the face of a curb, somebody walking
  const float weight = growth_m_s / variance_m2;
  precision_ += weight * growth_m_s;
  weighted_ -= weight * above_m;
  growth_ += growth_m_s;
  points_ += 1.0f;
}

void TiltLatency::end_line(float tilt_rate_rad_s) {
  const float rate2 = tilt_rate_rad_s * tilt_rate_rad_s;
  if (precision_ > 0.0f && rate2 > 0.0f) {
    // What all points of the line share: the time and angle of the readings next to it, the pose.
    const float growth = growth_ / points_;
    const float common_s2 = time_variance_s2_ + angle_variance_ / rate2 + height_variance_m2_ / (growth * growth);
    const float observed_s = weighted_ / precision_;
    State& state = state_[sweep_];
    const float gain = state.variance_s2 / (state.variance_s2 + 1.0f / precision_ + common_s2);
    state.offset_s += gain * observed_s;
    state.variance_s2 -= gain * state.variance_s2;
  }
  precision_ = weighted_ = growth_ = points_ = 0.0f;
}

float TiltLatency::sd_s() const { return square_root(state_[sweep_].variance_s2); }

}  // namespace curbline
