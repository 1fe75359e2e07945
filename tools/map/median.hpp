// The median.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

namespace curbline::tools {

/// The upper of the two middle values; there must be one at least. O(n).
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace curbline::tools
