// Extrapolation beyond the ends of a track of samples. Two samples a moment apart differ mostly by their errors: poses
// of two sources, or a servo's frame that waited on the bus and is stamped just before the next. Extrapolated at the
// rate between them, these errors would grow by the ratio of the time beyond to the time between them.
#pragma once

#include <cstdint>

namespace curbline {

/// Which of `size` samples, at rising or falling times time_of(k), gives the rate at sample `end` for a time beyond it:
/// the nearest in direction `inward`, 1 or -1, at least half as far from it as that time is. -1 if there is none.
/// O(size), as a rule one step.
template <typename TimeOf>
int sample_for_rate(std::int64_t time_ns, int end, int inward, int size, TimeOf&& time_of) {
  const auto apart = [](std::int64_t a, std::int64_t b) { return a < b ? b - a : a - b; };
  const std::int64_t end_ns = time_of(end), beyond_ns = apart(time_ns, end_ns);
  for (int k = end + inward; k >= 0 && k < size; k += inward) {
    if (apart(time_of(k), end_ns) >= beyond_ns - beyond_ns / 2) return k;
  }
  return -1;
}

}  // namespace curbline
