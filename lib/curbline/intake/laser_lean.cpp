#include "curbline/intake/laser_lean.hpp"

#include <algorithm>

#include "curbline/math.hpp"

namespace curbline {
namespace {

/// Share of the prior deviation by which it may change from sweep to sweep.
constexpr float change_share = 0.2f;

}  // namespace

void LaserLean::init(float sd_rad) {
  *this = LaserLean{};
  prior_variance_ = variance_ = square(sd_rad);
  largest_rad_ = 5.0f * sd_rad;
}

/// Few lasers lean: the first deviation must not be one of chance, or of a step of the latency. Once there has been a
/// lean, one standard deviation of what is left is as likely its rest as not.
void LaserLean::begin_sweep() {
  due_ = square(found_rad_) > (taken_off_rad_ == 0.0f ? gate : 1.0f) * variance_;
  variance_ = std::min(variance_ + square(change_share) * prior_variance_, prior_variance_);
}

void LaserLean::forget() {
  found_rad_ = 0.0f;
  variance_ = prior_variance_;
  due_ = false;
}

void LaserLean::observe(float by, float missing, float variance_without) {
  const float total = variance_without + variance(by);
  found_rad_ += by * variance_ / total * (missing - mean(by));
  variance_ *= variance_without / total;
}

float LaserLean::take_off() {
  if (!due_) return 0.0f;
  due_ = false;
  const float before_rad = taken_off_rad_;
  taken_off_rad_ = std::clamp(before_rad + found_rad_, -largest_rad_, largest_rad_);
  found_rad_ = 0.0f;
  return taken_off_rad_ - before_rad;
}

}  // namespace curbline
