// Curbs beside each other: which of them are one edge. Names of the kinds.
#include "curbline/curbs/curb.hpp"

#include <algorithm>
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

TEST_CASE("curb: of parallel steps the longest is reported, in any order, and of equal ones one") {
  const auto step = [](float x_m, float length_m) {
    return Curb{.x0_m = x_m, .y0_m = 0.0f, .x1_m = x_m, .y1_m = length_m, .kind = CurbKind::step_up};
  };
  std::array<Curb, 3> curbs{step(1.0f, 3.0f), step(1.08f, 2.0f), step(1.16f, 1.0f)};
  const auto by_x = [](const Curb& a, const Curb& b) { return a.x0_m < b.x0_m; };
  do {
    std::array<bool, 3> told{};
    told_by_longer(curbs, 0.1f, told);
    for (std::size_t k = 0; k < curbs.size(); ++k) CHECK(told[k] == (curbs[k].x0_m > 1.0f));
  } while (std::next_permutation(curbs.begin(), curbs.end(), by_x));
  std::array<bool, 2> told{};
  told_by_longer(std::array{step(1.0f, 2.0f), step(1.05f, 2.0f)}, 0.1f, told);
  CHECK_FALSE(told[0]);
  CHECK(told[1]);
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

TEST_CASE("curb: a step is told beside a longer crease, and of two far apart each") {
  const Way way{0.0, 0.0, 0.0};
  std::array<Curb, 2> curbs{way.piece(0.0, 1.0, 0.0), way.piece(0.0, 2.0, 0.05)};
  curbs[0].kind = CurbKind::step_down;
  const auto shorter_is_told = [&](CurbKind kind, double left) {
    curbs[1] = way.piece(0.0, 2.0, left);
    curbs[1].kind = kind;
    std::array<bool, 2> by_longer{};
    told_by_longer(curbs, 0.1f, by_longer);
    CHECK_FALSE(by_longer[1]);
    return !by_longer[0];
  };
  CHECK_FALSE(shorter_is_told(CurbKind::step_up, 0.05));
  CHECK(shorter_is_told(CurbKind::step_up, 0.15));
  CHECK(shorter_is_told(CurbKind::crease, 0.05));
  CHECK(shorter_is_told(CurbKind::ramp_edge, 0.05));
  curbs[0].kind = CurbKind::crease;
  CHECK(shorter_is_told(CurbKind::step_up, 0.05));  // two creases are both told
}

TEST_CASE("curb: each kind has a word of its own") {
  CHECK(std::string(to_string(CurbKind::step_up)) == "step_up");
  CHECK(std::string(to_string(CurbKind::step_down)) == "step_down");
  CHECK(std::string(to_string(CurbKind::crease)) == "crease");
  CHECK(std::string(to_string(CurbKind::ramp_edge)) == "ramp_edge");
}

}  // namespace
}  // namespace curbline
