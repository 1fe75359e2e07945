#include "curbline/intake/tilt_latency.hpp"

#include <algorithm>

#include "curbline/math.hpp"
#include "curbline/point.hpp"

namespace curbline {
namespace {

/// Share of the prior deviation by which sweeps of a robot that drives may differ.
constexpr float sweep_share = 0.2f;

/// Consecutive lines that disagree with the estimate, each by at least three standard deviations.
constexpr int lines_of_a_step = 10;

/// Lower bound of an estimate's variance, as a share of the prior's: 3 us of 10 ms. Rounding could make it 0, which
/// means that it is not estimated.
constexpr float least_share = 1e-7f;

}  // namespace

void TiltLatency::init(const TiltSettings& tilt, const PoseSettings& pose) {
  *this = TiltLatency{};
  drives_ = !pose.still;
  prior_variance_s2_ = square(tilt.latency_sd_s);
  largest_offset_s_ = 5.0f * tilt.latency_sd_s;
  time_variance_s2_ = square(tilt.time_sd_s);
  angle_variance_ = square(tilt.angle_sd_rad);
  // At slower rates a wrong latency matters less than the error of an angle.
  turns_.init(tilt.latency_sd_s > 0.0f ? tilt.angle_sd_rad / tilt.latency_sd_s : 0.0f);
  covariance_[now][now] = other_.variance_s2 = prior_variance_s2_;
  if (!drives_) return;
  angle_variance_ += square(pose.attitude_sd_rad);
  height_variance_m2_ = square(pose.height_sd_m);
  covariance_[constant][constant] = prior_variance_s2_;
  lean_.init(pose.lean_sd_rad);
  turn_driving();
}

TiltLatency::Turn TiltLatency::begin_line(float angle_rad, float rate_rad_s, std::uint32_t reading) {
  const Turn turn = turns_.follow(angle_rad, rate_rad_s, reading);
  if (turn != Turn::none && !drives_) take_up_other_direction();
  if (turn != Turn::new_sweep) return turn;
  if (drives_) {
    turn_driving();
  } else {
    turn_standing();
  }
  turned_ = true;
  return turn;
}

void TiltLatency::take_up_other_direction() {
  const Known before{offset_s_, covariance_[now][now]};
  offset_s_ = other_.offset_s;
  covariance_[now][now] = other_.variance_s2;
  other_ = before;
}

/// The second sweep is as late as the first; after that the ground is the datum.
void TiltLatency::turn_standing() {
  auto& p = covariance_;
  p[now][now] = turned_ ? p[now][now] + prior_variance_s2_ : prior_variance_s2_;
  p[earlier][earlier] = p[now][earlier] = p[earlier][now] = turned_ ? 0.0f : prior_variance_s2_;
}

/// The last sweep's ground becomes the ground before; the new sweep differs from the constant at random.
void TiltLatency::turn_driving() {
  auto& p = covariance_;
  p[earlier][earlier] = p[now][now];
  p[constant][earlier] = p[earlier][constant] = p[constant][now];
  other_.offset_s = offset_s_;
  offset_s_ = constant_s_;
  p[now][now] = p[constant][constant] + square(sweep_share) * prior_variance_s2_;
  p[constant][now] = p[now][constant] = p[constant][constant];
  p[now][earlier] = p[earlier][now] = p[constant][earlier];
  by_lean_s_rad_[earlier] = by_lean_s_rad_[now];
  by_lean_s_rad_[now] = by_lean_s_rad_[constant];
  lean_.begin_sweep();
}

void TiltLatency::Sums::add(const Sighting& seen) {
  const float weight = seen.growth_m_s / seen.variance_m2;
  precision += weight * seen.growth_m_s;
  mapped += weight * seen.map_growth_m_s;
  farther += weight * seen.farther_m;
  weighted -= weight * seen.above_m;
  growth += seen.growth_m_s;
  common_m2 += seen.common_variance_m2;
  points += 1.0f;
}

void TiltLatency::Sums::add(const Sums& other) {
  precision += other.precision;
  mapped += other.mapped;
  farther += other.farther;
  weighted += other.weighted;
  growth += other.growth;
  common_m2 += other.common_m2;
  points += other.points;
}

/// A point that not even a step explains is of another surface: the face of a curb, a pedestrian.
void TiltLatency::compare(const Sighting& seen) {
  const float g = seen.growth_m_s, m = seen.map_growth_m_s;
  if (!(g > -most_growth_m_s && g < most_growth_m_s)) return;
  const float by_lean_m = seen.farther_m - g * by_lean_s_rad_[now] + m * by_lean_s_rad_[earlier];
  const float variance_m2 =
      seen.variance_m2 + seen.common_variance_m2 + earlier_variance_m2(g, m) + lean_.variance(by_lean_m);
  const float above_m2 = square(seen.above_m - lean_.mean(by_lean_m));
  if (above_m2 <= gate * variance_m2) {
    seen_.add(seen);
    return;
  }
  const float by_step_m2 = prior_variance_s2_ * square(known(earlier) ? g : g - m);
  if (above_m2 <= gate * (variance_m2 + by_step_m2)) stepped_.add(seen);
}

TiltLatency::Correction TiltLatency::end_line(float tilt_rate_rad_s) {
  Correction correction;
  const bool moves = square(tilt_rate_rad_s) > 0.0f;
  const bool agrees = moves && seen_.precision > 0.0f && update(observation(seen_, tilt_rate_rad_s), correction);
  if (agrees && seen_.points >= stepped_.points) {
    lines_suspected_ = 0;
  } else {
    seen_.add(stepped_);
    if (moves && seen_.precision > 0.0f) suspect(observation(seen_, tilt_rate_rad_s));
  }
  seen_ = stepped_ = Sums{};
  return correction;
}

/// The observation of a whole line, with the variance that all its points share: time and angle of the readings next to
/// it, pose, slope of the ground.
TiltLatency::Observation TiltLatency::observation(const Sums& sums, float tilt_rate_rad_s) const {
  const float growth = sums.growth / sums.points, height_m2 = height_variance_m2_ + sums.common_m2 / sums.points;
  const float common_s2 = time_variance_s2_ + angle_variance_ / square(tilt_rate_rad_s) + height_m2 / (growth * growth);
  return {sums.weighted / sums.precision, 1.0f / sums.precision + common_s2, sums.mapped / sums.precision,
          sums.farther / sums.precision};
}

/// Kalman update by one observation of this sweep's offset less a multiple of the ground's; false if it disagrees with
/// the estimate.
bool TiltLatency::update(const Observation& seen, Correction& correction) {
  std::array<float, states> cross{};  // covariance of each state and the observation
  for (std::size_t a = 0; a < states; ++a) cross[a] = covariance_[a][now] - seen.mapped_share * covariance_[a][earlier];
  const float variance_s2 = cross[now] - seen.mapped_share * cross[earlier] + seen.variance_s2;
  const float by_lean = by_lean_s_rad_[now] - seen.mapped_share * by_lean_s_rad_[earlier] - seen.farther_share;
  const float off_s2 = square(seen.missing_s - lean_.mean(by_lean));
  if (!(off_s2 <= gate * (variance_s2 + lean_.variance(by_lean)))) return false;  // NaN too
  lean_.observe(by_lean, seen.missing_s, variance_s2);
  const float weight = seen.missing_s / variance_s2, before_s = offset_s_;
  constant_s_ = std::clamp(constant_s_ + cross[constant] * weight, -largest_offset_s_, largest_offset_s_);
  offset_s_ = std::clamp(offset_s_ + cross[now] * weight, -largest_offset_s_, largest_offset_s_);
  for (std::size_t a = 0; a < states; ++a) {
    const bool open = !known(static_cast<State>(a));
    by_lean_s_rad_[a] -= cross[a] / variance_s2 * by_lean;
    for (std::size_t b = 0; b < states; ++b) covariance_[a][b] -= cross[a] * cross[b] / variance_s2;
    const float least_s2 = least_share * prior_variance_s2_;
    if (open && covariance_[a][a] < least_s2) covariance_[a][a] = least_s2;
  }
  correction = {offset_s_ - before_s, cross[earlier] * weight, 0.0f};
  take_off_lean(correction);
  mended_s_ += correction.earlier_s;
  other_.offset_s += correction.earlier_s;
  return true;
}

/// With it go the parts of the offsets that it had bent.
void TiltLatency::take_off_lean(Correction& correction) {
  correction.lean_rad = lean_.take_off();
  if (correction.lean_rad == 0.0f) return;
  const auto bent_s = [&](State state) { return by_lean_s_rad_[state] * correction.lean_rad; };
  const float before_s = offset_s_;
  constant_s_ = std::clamp(constant_s_ + bent_s(constant), -largest_offset_s_, largest_offset_s_);
  offset_s_ = std::clamp(offset_s_ + bent_s(now), -largest_offset_s_, largest_offset_s_);
  correction.this_sweep_s += offset_s_ - before_s;
  correction.earlier_s += bent_s(earlier);
}

/// A line that disagrees with the estimate. A step moves every state that is not known exactly: ground that is the
/// datum stays.
void TiltLatency::suspect(const Observation& seen) {
  if (known(now)) return;  // the latency is not estimated
  const float apart_s2 = square(seen.missing_s - suspected_.missing_s);
  const bool like_last = lines_suspected_ > 0 && apart_s2 <= gate * (seen.variance_s2 + suspected_.variance_s2);
  lines_suspected_ = like_last ? lines_suspected_ + 1 : 1;
  suspected_ = seen;
  if (lines_suspected_ < lines_of_a_step) return;
  lines_suspected_ = 0;
  ++steps_;
  lean_.forget();
  std::array<bool, states> open{};
  for (const State state : {constant, now, earlier}) open[state] = !known(state);
  for (std::size_t a = 0; a < states; ++a) {
    for (std::size_t b = 0; b < states; ++b) {
      if (open[a] && open[b]) covariance_[a][b] += prior_variance_s2_;
    }
  }
}

float TiltLatency::sd_s() const {
  return square_root(covariance_[now][now]);
}

/// Driving, the constant; standing, the mean of both directions, weighted by variance. Single sweeps differ from it at
/// random, standing too (and both of two that were taken to be alike). If the mean of a drive's last two sweeps, one of
/// each direction, deviates from the constant by more than that, the servo's latency may have changed, and the constant
/// lags.
TiltLatency::Usual TiltLatency::usual() const {
  const auto& p = covariance_;
  if (!turned_ || known(now)) return {offset_s_, sd_s()};
  const float by_lot_s2 = square(sweep_share) * prior_variance_s2_;
  if (drives_) {
    const float off_s2 = square(0.5f * (offset_s_ + other_.offset_s) - constant_s_);
    return {constant_s_, square_root(p[constant][constant] + std::max(0.0f, off_s2 - 0.5f * by_lot_s2))};
  }
  const float of_this_s2 = p[now][now] + by_lot_s2;
  const float of_other_s2 = (known(earlier) ? other_.variance_s2 : p[now][now]) + by_lot_s2;
  const float share = of_other_s2 / (of_this_s2 + of_other_s2);
  return {share * offset_s_ + (1.0f - share) * other_.offset_s, square_root(share * of_this_s2)};
}

float TiltLatency::latest_offset_s() const {
  const float next_s = drives_ ? constant_s_ : other_.offset_s;
  return std::max(next_s, offset_s_);
}

}  // namespace curbline
