// The few mathematical functions that the algorithm needs, in float and with the same bits on every target: no libm but
// the square root, only +, -, *, / and bit patterns. tests/unit/math_test.cpp measures their errors.
#pragma once

#include <bit>
#include <cstdint>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "curbline keeps its bits and drops what is not finite: build without -ffast-math and -ffinite-math-only"
#elif defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)  // gcc's; clang does not say that it reorders
#error "curbline keeps its bits: build without -funsafe-math-optimizations and its parts"
#elif __FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2
#error "curbline keeps its bits: build for arithmetic in float, on x86 with -msse2 -mfpmath=sse"
#endif

namespace curbline {

inline constexpr float pi = 3.14159265f;

/// Three standard deviations, squared: the gate of outliers. Exceeded by chance once in 370.
inline constexpr float gate = 9.0f;

constexpr float square(float x) {
  return x * x;
}

constexpr float magnitude(float x) {
  return x < 0.0f ? -x : x;
}

/// Nearest integer, halves away from zero; the float just below a half counts as one. |x| < 2^22.
constexpr std::int32_t round_to_int(float x) {
  return static_cast<std::int32_t>(x < 0.0f ? x - 0.5f : x + 0.5f);
}

/// Largest integer not above x. |x| < 2^31.
constexpr std::int32_t floor_to_int(float x) {
  const auto truncated = static_cast<std::int32_t>(x);
  return static_cast<float>(truncated) > x ? truncated - 1 : truncated;
}

/// True if x is neither NaN nor infinite, whatever the compiler's flags.
constexpr bool is_finite(float x) {
  return (std::bit_cast<std::uint32_t>(x) & 0x7F800000u) != 0x7F800000u;
}

/// The nearest float, as by conversion. A 32-bit core has no instruction for it, and the compiler's own function links
/// the additions of soft-float: 500 bytes of flash.
float to_float(std::int64_t x);

/// Whole nanoseconds, toward 0. |seconds| <= 9e9.
constexpr std::int64_t to_ns(float seconds) {
  return static_cast<std::int64_t>(seconds * 1e9f);
}

/// Correctly rounded, from the hardware or the compiler's soft-float.
float square_root(float x);

/// e^x, relative error below 4e-7 for x in [-80, 80]; beyond, the value at that end.
float exp(float x);

/// Natural logarithm, error below 2e-7 (1 + |ln x|) for normal x > 0.
float log(float x);

/// ln Gamma(x), error below 1e-5 + 1e-6 |ln Gamma(x)|, x >= 1.
float log_gamma(float x);

struct SinCos {
  float sin;
  float cos;
};

/// Error below 2e-7 for |x| <= 4 pi.
SinCos sin_cos(float x);

/// The same for angles that change little from call to call: within 2 mrad of the last one computed in full, by a
/// Taylor series of second order, whose remainder is below 2e-9.
class NearSinCos {
 public:
  SinCos at(float x) {
    const float d = x - x_;
    if (!(d < 0.002f && d > -0.002f)) {
      x_ = x;
      return last_ = sin_cos(x);
    }
    const float half_square = 0.5f * d * d;
    return {last_.sin + d * last_.cos - half_square * last_.sin, last_.cos - d * last_.sin - half_square * last_.cos};
  }

 private:
  float x_ = 0.0f;
  SinCos last_{0.0f, 1.0f};
};

}  // namespace curbline
