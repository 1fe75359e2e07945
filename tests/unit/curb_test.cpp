// Curbs beside each other: which are one edge, and their kinds' names.
#include "curbline/curb.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
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

TEST_CASE("curb: of steps along each other the longest is told, whatever their order, of equals one") {
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

TEST_CASE("curb: each kind has a word of its own") {
  CHECK(std::string(to_string(CurbKind::step_up)) == "step_up");
  CHECK(std::string(to_string(CurbKind::step_down)) == "step_down");
  CHECK(std::string(to_string(CurbKind::crease)) == "crease");
  CHECK(std::string(to_string(CurbKind::ramp_edge)) == "ramp_edge");
}

}  // namespace
}  // namespace curbline
