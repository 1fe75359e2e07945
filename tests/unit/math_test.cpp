// Errors of the library's own functions against std:: in double precision, over the ranges that math.hpp states.
#include "curbline/math.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <vector>

namespace curbline {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// Visits every `stride`-th float from low to high, both positive.
template <typename Visit>
void for_each_float(float low, float high, std::uint32_t stride, Visit&& visit) {
  const auto last = std::bit_cast<std::uint32_t>(high);
  for (auto bits = std::bit_cast<std::uint32_t>(low); bits <= last; bits += stride) visit(std::bit_cast<float>(bits));
}

TEST_CASE("math: exp has a relative error below 4e-7 in [-80, 80]") {
  double worst = 0.0;
  for (int k = -800000; k <= 800000; ++k) {
    const auto x = static_cast<float>(k * 1e-4);
    const double truth = std::exp(static_cast<double>(x));
    worst = std::max(worst, std::abs(static_cast<double>(exp(x)) - truth) / truth);
  }
  CHECK(worst < 4e-7);
}

TEST_CASE("math: exp beyond 80 stands still, so that it is never zero nor infinite") {
  CHECK(exp(1e9f) == exp(80.0f));
  CHECK(exp(-1e9f) == exp(-80.0f));
  CHECK(exp(-1e9f) > 0.0f);
  CHECK(is_finite(exp(std::numeric_limits<float>::infinity())));
}

TEST_CASE("math: log has an error below 2e-7 (1 + |ln x|) over all normal floats") {
  double worst = 0.0;
  for_each_float(std::numeric_limits<float>::min(), std::numeric_limits<float>::max(), 1009, [&](float x) {
    const double truth = std::log(static_cast<double>(x));
    worst = std::max(worst, std::abs(static_cast<double>(log(x)) - truth) / (1.0 + std::abs(truth)));
  });
  CHECK(worst < 2e-7);
  CHECK(log(1.0f) == 0.0f);
}

TEST_CASE("math: log_gamma has an error below 1e-5 + 1e-6 |ln Gamma| from 1 to ten million") {
  double worst = 0.0;
  for_each_float(1.0f, 1e7f, 211, [&](float x) {
    const double truth = std::lgamma(static_cast<double>(x));
    worst = std::max(worst, std::abs(static_cast<double>(log_gamma(x)) - truth) / (1e-5 + 1e-6 * std::abs(truth)));
  });
  CHECK(worst < 1.0);
}

TEST_CASE("math: sine and cosine have an error below 2e-7 within two turns") {
  double worst = 0.0;
  for (double t = -2 * two_pi; t <= 2 * two_pi; t += 1e-5) {
    const auto x = static_cast<float>(t);
    const SinCos s = sin_cos(x);
    worst = std::max({worst, std::abs(static_cast<double>(s.sin) - std::sin(static_cast<double>(x))),
                      std::abs(static_cast<double>(s.cos) - std::cos(static_cast<double>(x)))});
  }
  CHECK(worst < 2e-7);
}

TEST_CASE("math: rounding goes to the nearest integer, halves away from zero") {
  CHECK(round_to_int(2.4f) == 2);
  CHECK(round_to_int(2.5f) == 3);
  CHECK(round_to_int(-2.4f) == -2);
  CHECK(round_to_int(-2.5f) == -3);
  CHECK(round_to_int(4194303.0f) == 4194303);
}

TEST_CASE("math: floor goes down on both sides of zero") {
  CHECK(floor_to_int(2.9f) == 2);
  CHECK(floor_to_int(2.0f) == 2);
  CHECK(floor_to_int(-2.0f) == -2);
  CHECK(floor_to_int(-2.1f) == -3);
  CHECK(floor_to_int(-1e-20f) == -1);
}

TEST_CASE("math: 64 bits become the float that a conversion makes of them") {
  std::vector<std::int64_t> values{0, 1, -1, INT32_MAX, INT32_MIN, INT64_MAX, INT64_MIN};
  std::uint64_t bits = 1;
  for (int n = 0; n < 100'000; ++n) {
    bits = bits * 6364136223846793005u + 1442695040888963407u;
    values.push_back(static_cast<std::int64_t>(bits) >> n % 64);
  }
  for (int n = 24; n < 63; ++n) {  // halfway between two floats, and one more or less
    const std::int64_t half = (std::int64_t{1} << n) + (std::int64_t{1} << (n - 24));
    for (const std::int64_t x : {half - 1, half, half + 1, 3 * (half / 3)}) values.push_back(x), values.push_back(-x);
  }
  for (const std::int64_t x : values) {
    if (to_float(x) != static_cast<float>(x)) FAIL(x);
  }
}

TEST_CASE("math: seconds become whole nanoseconds, toward 0") {
  CHECK(to_ns(0.0f) == 0);
  CHECK(to_ns(0.05f) == 50'000'000);
  CHECK(to_ns(-10.0f) == -10'000'000'000);
  CHECK(to_ns(1.9e-9f) == 1);
  CHECK(to_ns(-1.9e-9f) == -1);
  CHECK(to_ns(9e9f) == Approx(9e18));
}

TEST_CASE("math: NaN and infinities are not finite, everything else is") {
  using Float = std::numeric_limits<float>;
  for (const float x : {0.0f, -0.0f, Float::denorm_min(), Float::max(), Float::lowest()}) CHECK(is_finite(x));
  for (const float x : {Float::infinity(), -Float::infinity(), Float::quiet_NaN(), -Float::quiet_NaN()})
    CHECK_FALSE(is_finite(x));
}

}  // namespace
}  // namespace curbline
