#include "curbline/tilt_latency.hpp"

#include "curbline/line_fit.hpp"

namespace curbline {
namespace {

/// No sweep worth the name is smaller; turns closer together come from damaged readings and from play.
constexpr float least_sweep_rad = 0.05f;

/// Three standard deviations, squared: beyond it something else than latency is seen.
constexpr float gate = 9.0f;

float square(float x) {
  return x * x;
}

float within(float x, float bound) {
  return x < -bound ? -bound : x > bound ? bound : x;
}

}  // namespace

void TiltLatency::init(const TiltSettings& tilt, const PoseSettings& pose) {
  *this = TiltLatency{};
  const float prior_variance_s2 = square(tilt.latency_sd_s);
  largest_offset_s_ = 5.0f * tilt.latency_sd_s;
  time_variance_s2_ = square(tilt.time_sd_s);
  angle_variance_ = square(tilt.angle_sd_rad);
  if (pose.still) {
    new_sweep_variance_s2_ = prior_variance_s2;
  } else {
    one_offset_ = true;
    angle_variance_ += square(pose.attitude_sd_rad);
    height_variance_m2_ = square(pose.height_sd_m);
  }
  state_.fill({0.0f, prior_variance_s2});
  if (tilt.latency_sd_s > 0.0f) slow_rad_s_ = tilt.angle_sd_rad / tilt.latency_sd_s;
}

TiltLatency::Turn TiltLatency::follow(float angle_rad, float rate_rad_s) {
  const bool slow = rate_rad_s < slow_rad_s_ && rate_rad_s > -slow_rad_s_;
  const std::size_t direction = slow ? sweep_ : rate_rad_s > 0.0f ? 1u : 0u;
  if (!begun_) {
    begun_ = true;
    sweep_ = direction;
    turned_at_rad_ = angle_rad;
  }
  if (direction == sweep_) return Turn::none;
  sweep_ = direction;
  const float swept = angle_rad - turned_at_rad_;
  if (swept < least_sweep_rad && swept > -least_sweep_rad) return Turn::back;
  turned_at_rad_ = angle_rad;
  state().variance_s2 += new_sweep_variance_s2_;
  return Turn::new_sweep;
}

void TiltLatency::compare(float above_m, float variance_m2, float growth_m_s) {
  const float variance = variance_m2 + growth_m_s * growth_m_s * state().variance_s2;
  if (square(above_m) > gate * variance) return;  // another surface: the face of a curb, somebody walking
  const float weight = growth_m_s / variance_m2;
  precision_ += weight * growth_m_s;
  weighted_ -= weight * above_m;
  growth_ += growth_m_s;
  points_ += 1.0f;
}

void TiltLatency::end_line(float tilt_rate_rad_s) {
  const float rate2 = square(tilt_rate_rad_s);
  if (precision_ > 0.0f && rate2 > 0.0f) {
    // What all points of the line share: the time and angle of the readings next to it, the pose.
    const float growth = growth_ / points_;
    const float common_s2 = time_variance_s2_ + angle_variance_ / rate2 + height_variance_m2_ / (growth * growth);
    const float observed_s = weighted_ / precision_;
    State& now = state();
    const float innovation_variance = now.variance_s2 + 1.0f / precision_ + common_s2;
    if (square(observed_s) <= gate * innovation_variance) {
      const float gain = now.variance_s2 / innovation_variance;
      now.offset_s = within(now.offset_s + gain * observed_s, largest_offset_s_);
      now.variance_s2 -= gain * now.variance_s2;
    }
  }
  precision_ = weighted_ = growth_ = points_ = 0.0f;
}

float TiltLatency::sd_s() const {
  return square_root(state().variance_s2);
}

}  // namespace curbline
