// A histogram of durations: four buckets per doubling from 1 us to 67 s, so that the ends of a bucket differ by at most
// a quarter. Fixed size, a few operations a sample. To be used from one context.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace curbline::daemon {

class LatencyHistogram {
 public:
  static constexpr std::size_t buckets = 4 * 25;

  void add(std::int64_t duration_ns) {
    const std::uint64_t us = duration_ns > 0 ? static_cast<std::uint64_t>(duration_ns) / 1000 : 0;
    ++counts_[bucket_of(us)];
    ++samples_;
    sum_us_ += us;
    if (us > longest_us_) longest_us_ = us;
  }

  std::uint64_t samples() const { return samples_; }
  std::uint64_t mean_us() const { return samples_ == 0 ? 0 : sum_us_ / samples_; }
  std::uint64_t longest_us() const { return longest_us_; }

  /// Upper bound of this many thousandths of the samples, the longest at most; 0 without samples.
  std::uint64_t quantile_us(std::uint64_t per_mille) const {
    const std::uint64_t wanted = (samples_ * per_mille + 999) / 1000;
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < buckets && samples_ > 0; ++i) {
      seen += counts_[i];
      if (seen >= wanted) return std::min(end_us(i), longest_us_);
    }
    return 0;
  }

  std::uint64_t count(std::size_t bucket) const { return counts_[bucket]; }
  /// The samples of a bucket are below this, and at or above the end of the previous bucket.
  static constexpr std::uint64_t end_us(std::size_t bucket) {
    if (bucket < 4) return bucket + 1;
    return (std::uint64_t{5} + bucket % 4) << (bucket / 4 - 1);
  }

 private:
  static constexpr std::size_t bucket_of(std::uint64_t us) {
    if (us < 4) return static_cast<std::size_t>(us);
    const auto octave = static_cast<std::size_t>(std::bit_width(us)) - 3;  // 4 us to 7 us: 0
    const std::size_t bucket = 4 * (octave + 1) + (us >> octave & 3);
    return bucket < buckets ? bucket : buckets - 1;
  }

  std::array<std::uint64_t, buckets> counts_{};
  std::uint64_t samples_ = 0, sum_us_ = 0, longest_us_ = 0;
};

}  // namespace curbline::daemon
