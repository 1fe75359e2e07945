// Times that must rise: of readings, poses and scan lines. One that is not later than the newest is refused. After 15
// refused in a row whose own times rise, the next one that goes on rising is taken: the newest was wrong (a damaged
// stamp, or a clock set back since), as no queue before the pipeline holds so many in order. O(1); one context.
#pragma once

#include <cstdint>
#include <limits>

namespace curbline {

class RisingTimes {
 public:
  static constexpr int most_refused = 15;  ///< in a row that rise
  /// 126 years either way: the difference of two such times, and a little more, does not overflow. A time beyond is
  /// damaged.
  static constexpr std::int64_t furthest_ns = 4'000'000'000'000'000'000;
  /// What stands for a time as long as there is none: earlier than all.
  static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::min();

  static constexpr bool is_time(std::int64_t time_ns) { return time_ns <= furthest_ns && time_ns >= -furthest_ns; }

  /// May this time follow the newest? Counts it if not.
  bool admits(std::int64_t time_ns) {
    if (!is_time(time_ns)) return false;
    if (time_ns > newest_ns_) return true;
    refused_ = refused_ > 0 && time_ns > last_refused_ns_ ? refused_ + 1 : 1;
    last_refused_ns_ = time_ns;
    return refused_ > most_refused;
  }
  /// Makes it the newest.
  void take(std::int64_t time_ns) {
    newest_ns_ = time_ns;
    refused_ = 0;
  }

 private:
  std::int64_t newest_ns_ = none, last_refused_ns_ = 0;
  int refused_ = 0;  ///< in a row that rise
};

}  // namespace curbline
