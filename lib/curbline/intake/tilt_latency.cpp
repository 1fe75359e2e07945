#include "curbline/intake/tilt_latency.hpp"

#include <algorithm>

#include "curbline/math.hpp"
#include "curbline/point.hpp"

namespace curbline {
namespace {

/// Share of the prior deviation by which sweeps of a robot that drives may differ.
constexpr float sweep_share = 0.2f;

/// Share of the difference between upward and downward sweeps that a robot which stands takes off at a turn: they
/// differ by lot, and that of two sweeps weighs little against a hundred.
constexpr float approach_share = 0.02f;

/// Consecutive lines that disagree with the estimate, each by at least three standard deviations.
constexpr int lines_of_a_step = 10;

/// Lower bound of an estimate's variance, as a share of the prior's: 3 us of 10 ms. Rounding could make it 0, which
/// means that it is not estimated.
constexpr float least_share = 1e-7f;

/// A line whose observation has a larger variance tells nothing, and would soon not fit a float: its growths cancel, or
/// the servo hardly moves.
constexpr float most_variance_s2 = 1e12f;

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
  follow_rate(turn, rate_rad_s);
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

void TiltLatency::follow_rate(Turn turn, float rate_rad_s) {
  if (turn == Turn::new_sweep) {
    const float mean_rad_s = rate_sum_rad_s_ / lines_, before_rad_s = turned_ ? sweep_rates_.last_rad_s : -mean_rad_s;
    const bool opposite = before_rad_s * mean_rad_s < 0.0f;  // damaged readings may say otherwise
    sweep_rates_ = {mean_rad_s, opposite ? before_rad_s / (before_rad_s - mean_rad_s) : 0.5f};
    rate_sum_rad_s_ = lines_ = 0.0f;
  }
  if (!turned_ && turn == Turn::none) sweep_rates_.last_rad_s = -rate_rad_s;
  rate_sum_rad_s_ += rate_rad_s;
  lines_ += 1.0f;
}

void TiltLatency::take_up_other_direction() {
  const Known of_last{offset_s_, covariance_[now][now]};
  offset_s_ = other_.offset_s;
  covariance_[now][now] = other_.variance_s2;
  other_ = of_last;
}

/// The second sweep is as late as the first; after that the ground is the datum. What is known of a direction's sweeps
/// wears off, but while the laser sees nothing they become no more uncertain than at first. Nor is the ground exact: it
/// is that of the last sweeps, whose small errors add up. They lean it, and part the directions; in the mean over many
/// sweeps both are equally late.
void TiltLatency::turn_standing() {
  auto& p = covariance_;
  if (turned_ && !known(now)) {
    approach_s_ = 0.5f * approach_share * (other_.offset_s - offset_s_);
    other_.offset_s -= approach_s_;
    offset_s_ += approach_s_;
  }
  p[now][now] = turned_ ? std::min(p[now][now], prior_variance_s2_) + prior_variance_s2_ : prior_variance_s2_;
  const float ground_s2 = turned_ ? 0.0f : prior_variance_s2_;
  for (const State state : {last, before}) p[state][now] = p[now][state] = ground_s2;
  for (const State state : {last, before}) p[state][last] = p[state][before] = ground_s2;
}

/// The sweeps become earlier ones; the new one differs from the constant at random.
void TiltLatency::turn_driving() {
  constexpr std::array<State, states> was = {constant, constant, now, last};
  const auto p = covariance_;
  const auto by_lean = by_lean_s_rad_;
  for (std::size_t a = 0; a < states; ++a) {
    for (std::size_t b = 0; b < states; ++b) covariance_[a][b] = p[was[a]][was[b]];
    by_lean_s_rad_[a] = by_lean[was[a]];
  }
  covariance_[now][now] += square(sweep_share) * prior_variance_s2_;
  other_.offset_s = offset_s_;
  offset_s_ = constant_s_;
  lean_.begin_sweep();
}

void TiltLatency::Sums::add(const Sighting& seen) {
  const auto [g, l, b] = seen.growth_m_s;
  const float weight = g / seen.variance_m2;
  precision += weight * g;
  last += weight * l;
  before += weight * b;
  farther += weight * seen.farther_m;
  weighted -= weight * seen.above_m;
  growth += g;
  common_m2 += seen.common_variance_m2;
  points += 1.0f;
}

void TiltLatency::Sums::add(const Sums& other) {
  precision += other.precision;
  last += other.last;
  before += other.before;
  farther += other.farther;
  weighted += other.weighted;
  growth += other.growth;
  common_m2 += other.common_m2;
  points += other.points;
}

/// A point that not even a step explains is of another surface: the face of a curb, a pedestrian.
void TiltLatency::compare(const Sighting& seen) {
  const auto [g, l, b] = seen.growth_m_s;
  if (!(g > -most_growth_m_s && g < most_growth_m_s)) return;
  const float by_lean_m =
      seen.farther_m - g * by_lean_s_rad_[now] - l * by_lean_s_rad_[last] - b * by_lean_s_rad_[before];
  const float variance_m2 =
      seen.variance_m2 + seen.common_variance_m2 + height_variance_m2(seen.growth_m_s) + lean_.variance(by_lean_m);
  const float above_m2 = square(seen.above_m - lean_.mean(by_lean_m));
  if (above_m2 <= gate * variance_m2) {
    seen_.add(seen);
    return;
  }
  const float by_step_m2 = prior_variance_s2_ * square(known(last) ? g : g + l + b);
  if (above_m2 <= gate * (variance_m2 + by_step_m2)) stepped_.add(seen);
}

TiltLatency::Correction TiltLatency::end_line(float tilt_rate_rad_s) {
  Correction correction;
  const auto seen = observation(seen_, tilt_rate_rad_s);
  const bool agrees = seen && update(*seen, correction);
  if (agrees && seen_.points >= stepped_.points) {
    lines_suspected_ = 0;
  } else {
    seen_.add(stepped_);
    if (const auto all = observation(seen_, tilt_rate_rad_s)) suspect(*all);
  }
  seen_ = stepped_ = Sums{};
  correction.later_s.last -= approach_s_;
  correction.later_s.before += approach_s_;
  approach_s_ = 0.0f;
  return correction;
}

/// The observation of a whole line, with the variance that all its points share: time and angle of the readings next to
/// it, pose, slope of the ground. Nothing if it tells nothing.
std::optional<TiltLatency::Observation> TiltLatency::observation(const Sums& sums, float tilt_rate_rad_s) const {
  if (!(sums.precision > 0.0f)) return std::nullopt;
  const float growth = sums.growth / sums.points, height_m2 = height_variance_m2_ + sums.common_m2 / sums.points;
  const float common_s2 = time_variance_s2_ + angle_variance_ / square(tilt_rate_rad_s) + height_m2 / (growth * growth);
  const float variance_s2 = 1.0f / sums.precision + common_s2;
  if (!(variance_s2 < most_variance_s2)) return std::nullopt;  // NaN too
  return Observation{sums.weighted / sums.precision, variance_s2, sums.last / sums.precision,
                     sums.before / sums.precision, sums.farther / sums.precision};
}

/// Kalman update; false if the observation disagrees with the estimate.
bool TiltLatency::update(const Observation& seen, Correction& correction) {
  States cross{};  // covariance of each state and the observation
  for (std::size_t a = 0; a < states; ++a) cross[a] = seen.sum(covariance_[a]);
  const float variance_s2 = seen.sum(cross) + seen.variance_s2;
  const float by_lean = seen.sum(by_lean_s_rad_) - seen.farther_share;
  const float off_s2 = square(seen.missing_s - lean_.mean(by_lean));
  if (!(off_s2 <= gate * (variance_s2 + lean_.variance(by_lean)))) return false;  // NaN too
  // The ground is that of a line or two, which err as much as this one. The offsets are made to fit it all the same.
  lean_.observe(by_lean, seen.missing_s, variance_s2 + seen.variance_s2);
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
  correction.later_s = {offset_s_ - before_s, cross[last] * weight, cross[before] * weight};
  take_off_lean(correction);
  mended_s_ += correction.later_s.last;
  other_.offset_s += correction.later_s.last;
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
  BySweep& later_s = correction.later_s;
  later_s = {later_s.now + offset_s_ - before_s, later_s.last + bent_s(last), later_s.before + bent_s(before)};
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
  for (const State state : {constant, now, last, before}) open[state] = !known(state);
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
  const float of_other_s2 = (known(last) ? other_.variance_s2 : p[now][now]) + by_lot_s2;
  const float share = of_other_s2 / (of_this_s2 + of_other_s2);
  return {share * offset_s_ + (1.0f - share) * other_.offset_s, square_root(share * of_this_s2)};
}

float TiltLatency::latest_offset_s() const {
  const float next_s = drives_ ? constant_s_ : other_.offset_s;
  return std::max(next_s, offset_s_);
}

}  // namespace curbline
