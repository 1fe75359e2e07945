#include "curbline/tilt_latency.hpp"

#include "curbline/line_fit.hpp"

namespace curbline {
namespace {

/// No sweep worth the name is smaller; turns closer together come from damaged readings and from play.
constexpr float least_sweep_rad = 0.05f;

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
  if (tilt.latency_sd_s > 0.0f) slow_rad_s_ = tilt.angle_sd_rad / tilt.latency_sd_s;
}

TiltLatency::Turn TiltLatency::follow(float angle_rad, float rate_rad_s) {
  const bool slow = rate_rad_s < slow_rad_s_ && rate_rad_s > -slow_rad_s_;
  const std::size_t direction = slow ? sweep_ : rate_rad_s > 0.0f ? 1u : 0u;
  if (direction == sweep_) return Turn::none;
  sweep_ = direction;
  const float swept = angle_rad - turned_at_rad_;
  if (swept < least_sweep_rad && swept > -least_sweep_rad) return Turn::back;
  turned_at_rad_ = angle_rad;
  state_[sweep_].variance_s2 += prior_variance_s2_;
  return Turn::new_sweep;
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
