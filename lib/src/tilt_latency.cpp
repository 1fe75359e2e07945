#include "curbline/tilt_latency.hpp"

#include "curbline/math.hpp"

namespace curbline {
namespace {

/// No sweep worth the name is smaller; turns closer together come from damaged readings and from play.
constexpr float least_sweep_rad = 0.05f;

/// Three standard deviations, squared: beyond it something else than latency is seen.
constexpr float gate = 9.0f;

/// Of what is not known of the latency, the part by which the sweeps of a robot that drives may differ.
constexpr float sweep_share = 0.2f;

float square(float x) {
  return x * x;
}

float within(float x, float bound) {
  return x < -bound ? -bound : x > bound ? bound : x;
}

}  // namespace

void TiltLatency::init(const TiltSettings& tilt, const PoseSettings& pose) {
  *this = TiltLatency{};
  drives_ = !pose.still;
  prior_variance_s2_ = square(tilt.latency_sd_s);
  largest_offset_s_ = 5.0f * tilt.latency_sd_s;
  time_variance_s2_ = square(tilt.time_sd_s);
  angle_variance_ = square(tilt.angle_sd_rad);
  if (tilt.latency_sd_s > 0.0f) slow_rad_s_ = tilt.angle_sd_rad / tilt.latency_sd_s;
  covariance_[now][now] = other_.variance_s2 = prior_variance_s2_;
  if (!drives_) return;
  angle_variance_ += square(pose.attitude_sd_rad);
  height_variance_m2_ = square(pose.height_sd_m);
  covariance_[constant][constant] = prior_variance_s2_;
  turn_driving();
}

TiltLatency::Turn TiltLatency::follow(float angle_rad, float rate_rad_s) {
  const bool slow = rate_rad_s < slow_rad_s_ && rate_rad_s > -slow_rad_s_;
  const bool downward = slow ? downward_ : rate_rad_s > 0.0f;
  if (!begun_) {
    begun_ = true;
    downward_ = downward;
    turned_at_rad_ = angle_rad;
  }
  if (downward == downward_) return Turn::none;
  downward_ = downward;
  if (!drives_) take_up_other_direction();
  const float swept = angle_rad - turned_at_rad_;
  if (swept < least_sweep_rad && swept > -least_sweep_rad) return Turn::back;
  turned_at_rad_ = angle_rad;
  if (drives_) {
    turn_driving();
  } else {
    turn_standing();
  }
  turned_ = true;
  return Turn::new_sweep;
}

void TiltLatency::take_up_other_direction() {
  const Known before{offset_s_, covariance_[now][now]};
  offset_s_ = other_.offset_s;
  covariance_[now][now] = other_.variance_s2;
  other_ = before;
}

/// The second sweep is late as the first is; after that the ground is the datum.
void TiltLatency::turn_standing() {
  auto& p = covariance_;
  p[now][now] = turned_ ? p[now][now] + prior_variance_s2_ : prior_variance_s2_;
  p[earlier][earlier] = p[now][earlier] = p[earlier][now] = turned_ ? 0.0f : prior_variance_s2_;
}

/// The ground that the last sweep has mapped is that before the new one, which differs from the constant by lot.
void TiltLatency::turn_driving() {
  auto& p = covariance_;
  p[earlier][earlier] = p[now][now];
  p[constant][earlier] = p[earlier][constant] = p[constant][now];
  offset_s_ = constant_s_;
  p[now][now] = p[constant][constant] + square(sweep_share) * prior_variance_s2_;
  p[constant][now] = p[now][constant] = p[constant][constant];
  p[now][earlier] = p[earlier][now] = p[constant][earlier];
}

void TiltLatency::compare(const Sighting& seen) {
  const float g = seen.growth_m_s, m = seen.map_growth_m_s;
  const float variance_m2 = seen.variance_m2 + seen.common_variance_m2 + g * g * covariance_[now][now] -
                            2.0f * g * m * covariance_[now][earlier] + m * m * covariance_[earlier][earlier];
  if (square(seen.above_m) > gate * variance_m2) return;  // another surface: the face of a curb, somebody walking
  const float weight = g / seen.variance_m2;
  precision_ += weight * g;
  mapped_ += weight * m;
  weighted_ -= weight * seen.above_m;
  growth_ += g;
  common_m2_ += seen.common_variance_m2;
  points_ += 1.0f;
}

TiltLatency::Correction TiltLatency::end_line(float tilt_rate_rad_s) {
  const float rate2 = square(tilt_rate_rad_s);
  Correction correction;
  if (precision_ > 0.0f && rate2 > 0.0f) {
    // What all points of the line share: the time and angle of the readings next to it, the pose, the ground's slope.
    const float growth = growth_ / points_, height_m2 = height_variance_m2_ + common_m2_ / points_;
    const float common_s2 = time_variance_s2_ + angle_variance_ / rate2 + height_m2 / (growth * growth);
    correction = update({weighted_ / precision_, 1.0f / precision_ + common_s2, mapped_ / precision_});
  }
  precision_ = mapped_ = weighted_ = growth_ = common_m2_ = points_ = 0.0f;
  return correction;
}

/// Kalman's update by one observation, of this sweep's offset less a multiple of that of the ground before.
TiltLatency::Correction TiltLatency::update(const Observation& seen) {
  std::array<float, states> cross{};  // covariance of each state and the observation
  for (std::size_t a = 0; a < states; ++a) cross[a] = covariance_[a][now] - seen.mapped_share * covariance_[a][earlier];
  const float variance_s2 = cross[now] - seen.mapped_share * cross[earlier] + seen.variance_s2;
  if (square(seen.missing_s) > gate * variance_s2) return {};
  const float weight = seen.missing_s / variance_s2, before_s = offset_s_;
  constant_s_ = within(constant_s_ + cross[constant] * weight, largest_offset_s_);
  offset_s_ = within(offset_s_ + cross[now] * weight, largest_offset_s_);
  for (std::size_t a = 0; a < states; ++a) {
    for (std::size_t b = 0; b < states; ++b) covariance_[a][b] -= cross[a] * cross[b] / variance_s2;
  }
  const Correction correction{offset_s_ - before_s, cross[earlier] * weight};
  mended_s_ += correction.earlier_s;
  other_.offset_s += correction.earlier_s;
  return correction;
}

float TiltLatency::sd_s() const {
  return square_root(covariance_[now][now]);
}

float TiltLatency::latest_offset_s() const {
  const float next_s = drives_ ? constant_s_ : other_.offset_s;
  return offset_s_ > next_s ? offset_s_ : next_s;
}

}  // namespace curbline
