// The line through a chain of border points.
#include "curbline/curbs/line_fit.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace curbline {
namespace {

TEST_CASE("line fit: a line through points lies within them, whatever its direction") {
  const double turn = GENERATE(0.0, 0.5, 1.5707963, 2.0, 3.0);
  LineFit fit;
  const double ux = std::cos(turn), uy = std::sin(turn);
  for (int k = -5; k <= 5; ++k) {
    const double off = k % 2 == 0 ? 0.01 : -0.01;
    fit.add(static_cast<float>(3.0 + 0.1 * k * ux - off * uy), static_cast<float>(-1.0 + 0.1 * k * uy + off * ux));
  }
  const auto s = fit.segment(static_cast<float>(3.0 - 0.5 * ux), static_cast<float>(-1.0 - 0.5 * uy),
                             static_cast<float>(3.0 + 0.5 * ux), static_cast<float>(-1.0 + 0.5 * uy), 0.05f);
  CHECK(s.x0_m == Approx(3.0 - 0.55 * ux).margin(0.005));
  CHECK(s.y0_m == Approx(-1.0 - 0.55 * uy).margin(0.005));
  CHECK(s.x1_m == Approx(3.0 + 0.55 * ux).margin(0.005));
  CHECK(s.y1_m == Approx(-1.0 + 0.55 * uy).margin(0.005));
  CHECK(std::abs(s.normal_x * ux + s.normal_y * uy) < 0.01);
}

TEST_CASE("line fit: the normal points to the left, looking from the first end to the second") {
  LineFit fit;
  for (int k = -4; k <= 4; ++k) fit.add(0.3f * static_cast<float>(k), 0.1f * static_cast<float>(k));
  const auto left = [](const LineFit::Segment& s) {
    return s.normal_y * (s.x1_m - s.x0_m) - s.normal_x * (s.y1_m - s.y0_m);
  };
  CHECK(left(fit.segment(-1.2f, -0.4f, 1.2f, 0.4f, 0.05f)) > 2.4f);
  CHECK(left(fit.segment(1.2f, 0.4f, -1.2f, -0.4f, 0.05f)) > 2.4f);
  CHECK(left(LineFit::across(1.0f, 2.0f, 3.0f, -4.0f, 0.5f)) == Approx(1.0));
}

TEST_CASE("line fit: a line reaches a margin beyond a point outside its ends, and is not changed by one within") {
  LineFit fit;
  for (int k = 0; k <= 4; ++k) fit.add(static_cast<float>(k), 0.0f);
  for (const bool turned : {false, true}) {
    auto s = turned ? fit.segment(3.0f, 0.0f, 1.0f, 0.0f, 0.1f) : fit.segment(1.0f, 0.0f, 3.0f, 0.0f, 0.1f);
    const auto before = s;
    s.reach(2.0f, 0.5f, 0.1f);
    CHECK(s.x0_m == before.x0_m);
    CHECK(s.x1_m == before.x1_m);
    s.reach(4.0f, 0.5f, 0.1f);
    s.reach(-1.0f, 0.0f, 0.1f);
    CHECK((turned ? s.x1_m : s.x0_m) == Approx(-1.1));
    CHECK((turned ? s.x0_m : s.x1_m) == Approx(4.1));
    CHECK(s.y0_m == Approx(0.0).margin(1e-6));
  }
}

TEST_CASE("line fit: points count by their weight, and no more once they are removed") {
  LineFit fit, weighed;
  for (const float x : {0.0f, 1.0f, 2.0f, 3.0f}) fit.add(x, x < 1.5f ? 0.01f : -0.01f);
  const float before = fit.squares();
  fit.add(4.0f, 0.3f, 2.0f);
  CHECK(fit.squares() > 2 * before);
  for (int k = 0; k < 2; ++k) weighed.add(4.0f, 0.3f);
  for (const float x : {0.0f, 1.0f, 2.0f, 3.0f}) weighed.add(x, x < 1.5f ? 0.01f : -0.01f);
  CHECK(fit.squares() == Approx(weighed.squares()).epsilon(1e-4));
  fit.remove(4.0f, 0.3f, 2.0f);
  CHECK(fit.squares() == Approx(before).epsilon(0.01));
  CHECK(before == Approx(4 * 0.01 * 0.01 * 0.2).epsilon(0.01));  // (1, 1, -1, -1) around its slope: a fifth is left
}

TEST_CASE("line fit: a line is known the less, the farther from its points") {
  LineFit fit;
  for (const float x : {0.0f, 1.0f, 2.0f, 3.0f}) fit.add(x, 0.0f);
  CHECK(fit.grown(1.5f, 0.0f) == Approx(1.0));
  CHECK(fit.grown(4.5f, 0.0f) == Approx(1 + 4 * 9 / 5.0));  // n d^2 over the scatter
}

TEST_CASE("line fit: points in one place have no direction and stay that place") {
  LineFit fit;
  for (int k = 0; k < 3; ++k) fit.add(1.0f, 2.0f);
  const auto s = fit.segment(1.0f, 2.0f, 1.0f, 2.0f, 0.05f);
  CHECK(s.x0_m == 1.0f);
  CHECK(s.y1_m == 2.0f);
  CHECK_FALSE(s.has_direction());
}

TEST_CASE("line fit: a line across ways that cancel lies across x, and is one") {
  const auto s = LineFit::across(1.0f, 2.0f, 0.0f, 0.0f, 0.5f);
  CHECK(s.normal_x == -1.0f);
  CHECK(s.x0_m == 1.0f);
  CHECK(s.y1_m - s.y0_m == Approx(1.0));
}

TEST_CASE("line fit: a line of a single place lies across the way that is asked for") {
  const auto s = LineFit::across(1.0f, 2.0f, 3.0f, -4.0f, 0.5f);
  CHECK(s.has_direction());
  CHECK(s.normal_x == Approx(-0.6));
  CHECK(s.normal_y == Approx(0.8));
  CHECK((s.x1_m - s.x0_m) * 3.0f - (s.y1_m - s.y0_m) * 4.0f == Approx(0.0).margin(1e-6));
  CHECK(std::hypot(s.x1_m - s.x0_m, s.y1_m - s.y0_m) == Approx(1.0));
  CHECK(0.5f * (s.x0_m + s.x1_m) == Approx(1.0));
}

}  // namespace
}  // namespace curbline
