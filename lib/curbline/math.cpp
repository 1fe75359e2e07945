#include "curbline/math.hpp"

#include <cmath>

namespace curbline {

float square_root(float x) {
  return std::sqrt(x);
}

float to_float(std::int64_t x) {
  const auto magnitude = x < 0 ? 0 - static_cast<std::uint64_t>(x) : static_cast<std::uint64_t>(x);
  const int below = 32 - std::countl_zero(static_cast<std::uint32_t>(magnitude >> 32));  // bits beyond 32
  // A sticky bit stands for those dropped below, so that it rounds as if all were there.
  const bool rest = (magnitude & ((std::uint64_t{1} << below) - 1)) != 0;
  const float rounded = static_cast<float>(static_cast<std::uint32_t>(magnitude >> below) | (rest ? 1u : 0u)) *
                        std::bit_cast<float>(static_cast<std::uint32_t>(below + 127) << 23);
  return x < 0 ? -rounded : rounded;
}

float exp(float x) {
  if (x > 80.0f) x = 80.0f;
  if (x < -80.0f) x = -80.0f;
  // x = k ln 2 + r, |r| <= ln 2 / 2; ln 2 in two parts, so that k times the first is exact.
  const std::int32_t k = round_to_int(x * 1.44269504f);
  const float n = static_cast<float>(k);
  const float r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
  // Taylor to r^6: the rest is below 1.2e-7.
  const float p =
      1.0f + r * (1.0f + r * (1.0f / 2 + r * (1.0f / 6 + r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720))))));
  return p * std::bit_cast<float>(static_cast<std::uint32_t>(k + 127) << 23);
}

float log(float x) {
  // x = 2^k m with m in [sqrt(1/2), sqrt(2)); ln m = 2 artanh((m - 1) / (m + 1)).
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const std::int32_t k = static_cast<std::int32_t>((bits - 0x3F3504F3u) >> 23 << 23) >> 23;
  const float m = std::bit_cast<float>(bits - (static_cast<std::uint32_t>(k) << 23));
  const float s = (m - 1.0f) / (m + 1.0f);
  const float s2 = s * s;
  const float series = s * (2.0f + s2 * (2.0f / 3 + s2 * (2.0f / 5 + s2 * (2.0f / 7 + s2 * (2.0f / 9)))));
  return series + static_cast<float>(k) * 0.693147181f;
}

float log_gamma(float x) {
  // Gamma(x) = Gamma(x + n) / (x (x + 1) ... (x + n - 1)), then Stirling's series.
  float product = 1.0f;
  for (; x < 4.0f; x += 1.0f) product *= x;
  const float inverse = 1.0f / x;
  const float series = inverse * (1.0f / 12 - inverse * inverse * (1.0f / 360));
  return (x - 0.5f) * log(x) - x + 0.918938533f + series - (product > 1.0f ? log(product) : 0.0f);
}

SinCos sin_cos(float x) {
  // x = k pi / 2 + r, |r| <= pi / 4; pi / 2 in two parts.
  const std::int32_t k = round_to_int(x * 0.636619772f);
  const float n = static_cast<float>(k);
  const float r = (x - n * 1.5703125f) - n * 4.83826794e-4f;
  const float r2 = r * r;
  const float s = r * (1.0f - r2 * (1.0f / 6 - r2 * (1.0f / 120 - r2 * (1.0f / 5040 - r2 * (1.0f / 362880)))));
  const float c = 1.0f - r2 * (1.0f / 2 - r2 * (1.0f / 24 - r2 * (1.0f / 720 - r2 * (1.0f / 40320))));
  switch (k & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

}  // namespace curbline
