// How places and other curbs lie to a curb. Names of the kinds.
#include "curbline/curbs/curb.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

namespace curbline {
namespace {

TEST_CASE("curb: the overlap of two pieces is what of the one lies along the other") {
  const Curb before{.x0_m = 1.0f, .y0_m = 0.0f, .x1_m = 1.0f, .y1_m = 2.0f};
  const auto piece = [](float x, float y0, float y1) { return Curb{.x0_m = x, .y0_m = y0, .x1_m = x, .y1_m = y1}; };
  CHECK(overlap_m(piece(1.05f, 0.5f, 1.5f), before, 0.2f) == Approx(1.0));
  CHECK(overlap_m(piece(1.05f, 1.5f, 0.5f), before, 0.2f) == Approx(1.0));
  CHECK(overlap_m(piece(1.0f, 1.5f, 3.5f), before, 0.2f) == Approx(0.5));
  CHECK(overlap_m(piece(1.0f, 2.5f, 3.5f), before, 0.2f) <= 0.0f);
  CHECK(overlap_m(piece(1.3f, 0.5f, 1.5f), before, 0.2f) == 0.0f);
}

/// A line from (x, y) in a direction. Pieces are given along it and to its left.
struct Way {
  double x, y, angle;

  Curb piece(double from, double to, double left) const {
    const auto at = [&](double along) {
      const double c = std::cos(angle), s = std::sin(angle);
      return std::array{static_cast<float>(x + along * c - left * s), static_cast<float>(y + along * s + left * c)};
    };
    return Curb{.x0_m = at(from)[0], .y0_m = at(from)[1], .x1_m = at(to)[0], .y1_m = at(to)[1]};
  }
};

TEST_CASE("curb: distance to the far side and overlap do not depend on a curb's direction") {
  const double angle = GENERATE(0.0, 0.5236, 1.5708, 2.4, -2.0);
  const Way way{1.0, 3.0, angle};
  const Curb curb = way.piece(0.0, 2.0, 0.0);
  const auto to_far_m = [&](double along, double left) {
    const Curb place = way.piece(along, along, left);
    return to_far_side_m(curb, place.x0_m, place.y0_m);
  };
  CHECK(to_far_m(0.5, 0.3) == Approx(0.3));
  CHECK(to_far_m(1.5, -0.2) == Approx(-0.2));
  CHECK(std::isinf(to_far_m(-0.1, 0.1)));
  CHECK(std::isinf(to_far_m(2.1, 0.1)));
  CHECK(overlap_m(way.piece(0.5, 1.5, 0.1), curb, 0.2f) == Approx(1.0));
  CHECK(overlap_m(way.piece(1.5, 4.5, -0.1), curb, 0.2f) == Approx(0.5));
  CHECK(overlap_m(way.piece(0.5, 1.5, 0.25), curb, 0.2f) == 0.0f);
  CHECK(overlap_m(way.piece(0.5, 1.5, -0.25), curb, 0.2f) == 0.0f);
  CHECK(overlap_m(curb, way.piece(1.0, 1.0, 0.0), 0.2f) == 0.0f);  // a point
}

TEST_CASE("curb: found again is the curb that runs the same way, of several the one that lies nearest") {
  const Way way{1.0, 3.0, GENERATE(0.0, 0.5236, 1.5708, 2.4, -2.0)};
  const Curb now = way.piece(0.0, 2.0, 0.0);
  const float of_itself_m = likeness_m(now, way.piece(0.2, 2.0, 0.02), 0.4f);
  CHECK(of_itself_m > 1.5f);
  CHECK(likeness_m(now, way.piece(2.0, 0.2, 0.02), 0.4f) == Approx(of_itself_m));  // the robot has crossed it
  CHECK(likeness_m(now, way.piece(-2.0, 4.0, 0.38), 0.4f) < 0.1f * of_itself_m);
  const Way across{1.0 + std::cos(way.angle), 3.0 + std::sin(way.angle), way.angle + 1.5};
  CHECK(likeness_m(now, across.piece(-1.0, 1.0, 0.0), 0.4f) <= 0.0f);
  CHECK(likeness_m(across.piece(-0.1, 0.2, 0.0), now, 0.4f) <= 0.0f);
}

TEST_CASE("curb: each kind has a word of its own") {
  CHECK(std::string(to_string(CurbKind::step_up)) == "step_up");
  CHECK(std::string(to_string(CurbKind::step_down)) == "step_down");
  CHECK(std::string(to_string(CurbKind::crease)) == "crease");
  CHECK(std::string(to_string(CurbKind::ramp_edge)) == "ramp_edge");
}

}  // namespace
}  // namespace curbline
