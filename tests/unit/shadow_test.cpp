// Where the edge lies that casts a shadow.
#include "curbline/curbs/shadow.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

namespace curbline {
namespace {

/// A line perpendicular to the direction `angle`, `away` from the origin.
LineFit::Segment line_at(double angle, double away) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto at = [&](double along) {
    return std::array{static_cast<float>(away * c - along * s), static_cast<float>(away * s + along * c)};
  };
  return {at(0.5)[0], at(0.5)[1], at(2.0)[0], at(2.0)[1], static_cast<float>(c), static_cast<float>(s)};
}

TEST_CASE("shadow: a line in the middle of the shadow moves to the edge that casts it, in any direction") {
  for (const double angle : {0.0, 0.7, 2.0, -1.9}) {
    const double edge = 1.5, width = edge * 0.12 / 0.9;
    LineFit::Segment line = line_at(angle, edge + width / 2);
    CHECK(move_before_shadow(line, {0.0f, 0.0f, 1.0f}, {0.12f, 0.9f, 1.0f}) == Approx(width));
    const LineFit::Segment expected = line_at(angle, edge);
    CHECK(line.x0_m == Approx(expected.x0_m).margin(1e-5));
    CHECK(line.y0_m == Approx(expected.y0_m).margin(1e-5));
    CHECK(line.x1_m == Approx(expected.x1_m).margin(1e-5));
    CHECK(line.y1_m == Approx(expected.y1_m).margin(1e-5));
  }
}

TEST_CASE("shadow: the side to which a line's normal points does not matter") {
  LineFit::Segment line = line_at(0.0, 1.6);
  line.normal_x = -1.0f;
  CHECK(move_before_shadow(line, {0.0f, 0.0f, 1.0f}, {0.12f, 0.9f, 1.0f}) == Approx(0.2));
  CHECK(line.x0_m == Approx(1.5));
}

TEST_CASE("shadow: a drop deeper than the laser is high casts one, too") {
  LineFit::Segment line = line_at(0.0, 2.75);
  CHECK(move_before_shadow(line, {0.0f, 0.0f, 1.0f}, {1.5f, 0.9f, 4.0f}) == Approx(2.5));
  CHECK(line.x0_m == Approx(1.5));
}

TEST_CASE("shadow: none is wider than the gap, and there is none for a laser no higher above than a low step falls") {
  LineFit::Segment line = line_at(0.0, 2.0);
  CHECK(move_before_shadow(line, {0.0f, 0.0f, 1.0f}, {0.3f, 0.2f, 0.4f}) == 0.0f);
  CHECK(move_before_shadow(line, {0.0f, 0.0f, 1.0f}, {0.3f, -0.1f, 0.4f}) == 0.0f);
  CHECK(line.x0_m == Approx(2.0));
  CHECK(move_before_shadow(line, {0.0f, 0.0f, 1.0f}, {0.3f, 0.5f, 0.4f}) == Approx(0.4));
  CHECK(line.x0_m == Approx(1.8));
}

}  // namespace
}  // namespace curbline
