// Synthetic ground for tests: noisy points of a height field, the same in every run and with every standard library.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "curbline/point.hpp"

namespace curbline::test {

/// Random numbers. Normal ones are sums of twelve uniform ones, because std::normal_distribution differs between
/// libraries.
class Noise {
 public:
  explicit Noise(std::uint32_t seed = 1) : engine_(seed) {}

  /// In (0, 1).
  double uniform() { return (static_cast<double>(engine_()) + 0.5) * 0x1p-32; }
  /// Mean 0, variance 1.
  double normal() {
    double sum = -6.0;
    for (int k = 0; k < 12; ++k) sum += uniform();
    return sum;
  }

 private:
  std::mt19937 engine_;
};

/// A rectangle of the map, metres.
struct Patch {
  double x0_m, x1_m, y0_m, y1_m;
};

/// One random point in each square of a grid over the patch, row by row away from x0, with Gaussian noise in height.
template <typename Height>
std::vector<Point> sample(const Patch& patch, double spacing_m, double noise_sd_m, Noise& noise, Height&& height_m) {
  std::vector<Point> points;
  for (double x0 = patch.x0_m; x0 < patch.x1_m - 1e-9; x0 += spacing_m) {
    for (double y0 = patch.y0_m; y0 < patch.y1_m - 1e-9; y0 += spacing_m) {
      const double x = x0 + spacing_m * noise.uniform(), y = y0 + spacing_m * noise.uniform();
      const double z = height_m(x, y) + noise_sd_m * noise.normal();
      points.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z),
                        static_cast<float>(noise_sd_m * noise_sd_m)});
    }
  }
  return points;
}

}  // namespace curbline::test
