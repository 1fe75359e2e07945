// Curbs beside each other: which of them are one edge.
#include "curbline/curbs/duplicates.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstddef>
#include <utility>

namespace curbline {
namespace {

Curb step(float x_m, float length_m) {
  return {.x0_m = x_m, .y0_m = 0.0f, .x1_m = x_m, .y1_m = length_m, .kind = CurbKind::step_up};
}

TEST_CASE("duplicates: of parallel steps the longest is reported, in any order, and of equal ones one") {
  std::array<Curb, 3> curbs{step(1.0f, 3.0f), step(1.08f, 2.0f), step(1.16f, 1.0f)};
  const auto by_x = [](const Curb& a, const Curb& b) { return a.x0_m < b.x0_m; };
  do {
    std::array<bool, 3> is_duplicate{};
    find_duplicates(curbs, 0.1f, is_duplicate);
    for (std::size_t k = 0; k < curbs.size(); ++k) CHECK(is_duplicate[k] == (curbs[k].x0_m > 1.0f));
  } while (std::next_permutation(curbs.begin(), curbs.end(), by_x));
  std::array<bool, 2> is_duplicate{};
  find_duplicates(std::array{step(1.0f, 2.0f), step(1.05f, 2.0f)}, 0.1f, is_duplicate);
  CHECK_FALSE(is_duplicate[0]);
  CHECK(is_duplicate[1]);
}

TEST_CASE("duplicates: a step is told beside a longer crease, and of two far apart each") {
  std::array<Curb, 2> curbs{step(0.0f, 1.0f)};
  curbs[0].kind = CurbKind::step_down;
  const auto shorter_is_told = [&](CurbKind kind, float x_m) {
    curbs[1] = step(x_m, 2.0f);
    curbs[1].kind = kind;
    std::array<bool, 2> is_duplicate{};
    find_duplicates(curbs, 0.1f, is_duplicate);
    CHECK_FALSE(is_duplicate[1]);
    return !is_duplicate[0];
  };
  CHECK_FALSE(shorter_is_told(CurbKind::step_up, 0.05f));
  CHECK(shorter_is_told(CurbKind::step_up, 0.15f));
  CHECK(shorter_is_told(CurbKind::crease, 0.05f));
  CHECK(shorter_is_told(CurbKind::ramp_edge, 0.05f));
  curbs[0].kind = CurbKind::crease;
  CHECK(shorter_is_told(CurbKind::step_up, 0.05f));  // two creases are both told
}

TEST_CASE("duplicates: a step of one cell or less is told, unless a longer one is beside it") {
  const auto is_told = [](float x_m, float y_m, float cell_m) {
    Curb shorter = step(x_m, cell_m);
    shorter.y0_m += y_m;
    shorter.y1_m += y_m;  // rounded: about as long as a cell
    std::array<bool, 2> is_duplicate{};
    find_duplicates(std::array{shorter, step(3.5f, 3.0f)}, 0.1f, is_duplicate);
    return !is_duplicate[0];
  };
  for (int k = 0; k < 100; ++k) {
    const float y_m = 0.0137f * static_cast<float>(k);
    CHECK(is_told(1.0f, y_m, 0.1f));
    CHECK(is_told(1.0f, y_m, 0.075f));
    CHECK_FALSE(is_told(3.45f, y_m, 0.1f));
  }
}

TEST_CASE("duplicates: a step with ground on both sides is told beside a longer brink, and alone beside one as long") {
  for (const float brink_m : {1.05f, 2.0f}) {
    std::array<Curb, 2> curbs{step(1.0f, 1.0f), step(1.05f, brink_m)};
    curbs[1].far_label = no_label;
    for (const std::size_t brink : {1u, 0u}) {
      std::array<bool, 2> is_duplicate{};
      find_duplicates(curbs, 0.1f, is_duplicate);
      CHECK_FALSE(is_duplicate[1 - brink]);
      CHECK(is_duplicate[brink] == (brink_m < 1.1f));
      std::swap(curbs[0], curbs[1]);
    }
  }
}

}  // namespace
}  // namespace curbline
