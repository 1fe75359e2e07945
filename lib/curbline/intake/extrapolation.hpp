// How a track of samples goes on beyond its ends. Two samples a moment apart differ by their errors: poses of two
// sources, a servo's frame that has waited on the bus and is stamped just before the next. Carried on at the rate
// between them, that would grow as many times as the moment is shorter than the way.
#pragma once

#include <cstdint>

namespace curbline {

/// Of `size` samples at rising or falling times time_of(k), the one that tells the rate at `end` for a time beyond it:
/// the nearest on the way `inward`, 1 or -1, that lies at least half as far from it as that time does. -1 if none does.
/// O(size), as a rule one look.
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
