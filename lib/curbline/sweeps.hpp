// The latest three sweeps of the tilt. A cell's ground may be of all of them, and each is late in its own way.
#pragma once

namespace curbline {

/// A value each for this sweep, the last one, and the one before that, which went the same way as this one.
struct BySweep {
  float now = 0.0f, last = 0.0f, before = 0.0f;
};

/// How fast the sweeps were that have mapped the ground: by this, a cell's growth is divided between their directions
/// (Dem::growths_m_s()).
struct SweepRates {
  float last_rad_s = 0.0f;  ///< mean of the last sweep, w
  float this_share = 0.5f;  ///< v / (v - w), v the mean of the sweep before it; a half if it is not known
};

/// Covariance of the sweeps' latencies, s^2, and the rates by which a cell's growth is divided between them.
struct LatencyDoubt {
  BySweep variance_s2{};
  float now_last_s2 = 0.0f, now_before_s2 = 0.0f, last_before_s2 = 0.0f;
  SweepRates rates{};

  /// Variance of a height, or a difference of two, that grows so with the latency of each sweep.
  float height_variance_m2(const BySweep& growth_m_s) const {
    const auto [g, l, b] = growth_m_s;
    return g * (g * variance_s2.now + 2.0f * (l * now_last_s2 + b * now_before_s2)) +
           l * (l * variance_s2.last + 2.0f * b * last_before_s2) + b * b * variance_s2.before;
  }
};

}  // namespace curbline
