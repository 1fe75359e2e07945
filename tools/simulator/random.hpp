// Random numbers with the same bits from every standard library: std::mt19937_64 is defined to the bit, the standard
// distributions are not.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace curbline::tools {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}

  /// In [0, 1).
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }

  /// Mean 0, standard deviation 1 (Marsaglia's polar method).
  double normal() {
    while (true) {
      const double u = 2 * uniform() - 1, v = 2 * uniform() - 1;
      const double s = u * u + v * v;
      if (s > 0 && s < 1) {
        return u * std::sqrt(-2 * std::log(s) / s);
      }
    }
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace curbline::tools
