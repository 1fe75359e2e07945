// By how much a laser looks farther down than its mount and poses say.
#include "curbline/intake/laser_lean.hpp"

#include <catch2/catch.hpp>

#include "support/terrain.hpp"

namespace curbline {
namespace {

constexpr float sd_rad = 0.005f;

LaserLean started() {
  LaserLean lean;
  lean.init(sd_rad);
  return lean;
}

/// A sweep of 40 observations, each of which lacks as much as ground 1 m farther away, in seconds at 1 m/s. Returns
/// what is taken off.
float sweep(LaserLean& lean, float left_rad, test::Noise& noise) {
  lean.begin_sweep();
  float taken_rad = 0.0f;
  for (int line = 0; line < 40; ++line) {
    lean.observe(1.0f, left_rad - taken_rad + 0.003f * static_cast<float>(noise.normal()), 0.003f * 0.003f);
    taken_rad += lean.take_off();
  }
  return taken_rad;
}

TEST_CASE("laser lean: one observation leaves the mean of prior and observation, and their common variance") {
  LaserLean lean = started();
  lean.observe(2.0f, 0.01f, 4.0f * sd_rad * sd_rad);
  CHECK(lean.mean(1.0f) == Approx(0.0025));
  CHECK(lean.mean(-3.0f) == Approx(-0.0075));
  CHECK(lean.variance(1.0f) == Approx(0.5 * sd_rad * sd_rad));
  CHECK(lean.variance(-2.0f) == Approx(2.0 * sd_rad * sd_rad));
}

TEST_CASE("laser lean: it is taken off at the beginning of a sweep, once it is known, and the rest in the next ones") {
  LaserLean lean = started();
  test::Noise noise(1);
  const float true_rad = GENERATE(-0.009f, 0.009f);
  CHECK(sweep(lean, true_rad, noise) == 0.0f);
  for (int k = 0; k < 3; ++k) sweep(lean, true_rad - lean.taken_off_rad(), noise);
  CHECK(lean.taken_off_rad() == Approx(true_rad).margin(0.001));
}

TEST_CASE("laser lean: what may be chance is not taken off") {
  LaserLean lean = started();
  test::Noise noise(2);
  for (int k = 0; k < 20; ++k) CHECK(sweep(lean, 0.0f, noise) == 0.0f);
}

TEST_CASE("laser lean: it stays within five standard deviations, whatever is seen") {
  LaserLean lean = started();
  test::Noise noise(3);
  const float sign = GENERATE(-1.0f, 1.0f);
  for (int k = 0; k < 30; ++k) sweep(lean, sign * 0.01f, noise);
  CHECK(lean.taken_off_rad() == Approx(sign * 5.0 * sd_rad));
}

TEST_CASE("laser lean: with a prior of none it is not estimated") {
  LaserLean lean;
  lean.init(0.0f);
  test::Noise noise(4);
  for (int k = 0; k < 5; ++k) CHECK(sweep(lean, 0.02f, noise) == 0.0f);
  CHECK(lean.variance(1.0f) == 0.0f);
}

TEST_CASE("laser lean: forgotten, it begins again, and what was taken off stays so") {
  LaserLean lean = started();
  test::Noise noise(5);
  for (int k = 0; k < 4; ++k) sweep(lean, 0.009f - lean.taken_off_rad(), noise);
  const float taken_rad = lean.taken_off_rad();
  lean.observe(1.0f, 0.01f, 1e-9f);
  lean.begin_sweep();
  lean.forget();
  CHECK(lean.take_off() == 0.0f);
  CHECK(lean.mean(1.0f) == 0.0f);
  CHECK(lean.variance(1.0f) == Approx(sd_rad * sd_rad));
  CHECK(lean.taken_off_rad() == taken_rad);
}

}  // namespace
}  // namespace curbline
