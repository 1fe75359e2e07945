// Chains of borders: where a second line begins.
#include "curbline/curbs/corner.hpp"

#include <catch2/catch.hpp>
#include <vector>

namespace curbline {
namespace {

struct Chain {
  std::vector<Border> borders{};
  std::vector<Border::Index> order{};

  void add(float x_m, float y_m, float half_gap_m, bool open = false) {
    order.push_back(static_cast<Border::Index>(borders.size()));
    Border border{};
    border.x_m = x_m;
    border.y_m = y_m;
    border.half_gap_m = half_gap_m;
    border.open = open;
    borders.push_back(border);
  }
  int corner() const { return corner_of({borders.data(), order, {true, true}}); }
};

/// Residuals of a third of half a gap, this way and that.
float off_m(int k, float half_gap_m) {
  return (k * 7 % 5 < 2 ? 0.33f : -0.33f) * half_gap_m;
}

TEST_CASE("corner: borders about one line have none, at any angle") {
  for (const float slope : {-1.0f, 0.0f, 0.3f, 2.0f}) {
    Chain chain;
    for (int k = 0; k < 40; ++k) {
      const float x_m = 0.1f * static_cast<float>(k);
      chain.add(x_m, 0.5f + slope * x_m + off_m(k, 0.05f), 0.05f);
    }
    CHECK(chain.corner() == -1);
  }
}

//    . . . . . . .    x: along y up to the 20th border, then
//    .                along x
//    .
TEST_CASE("corner: of two lines the first ends where the second begins") {
  Chain chain;
  for (int k = 0; k < 20; ++k) chain.add(1.0f + off_m(k, 0.05f), 0.1f * static_cast<float>(k), 0.05f);
  for (int k = 0; k < 20; ++k) chain.add(1.0f + 0.1f * static_cast<float>(k), 2.0f + off_m(k, 0.05f), 0.05f);
  CHECK(chain.corner() == Approx(19).margin(1));
}

TEST_CASE("corner: fewer than six borders have none") {
  Chain chain;
  for (int k = 0; k < 3; ++k) chain.add(1.0f, 0.1f * static_cast<float>(k), 0.05f);
  for (int k = 1; k < 3; ++k) chain.add(1.0f + 0.1f * static_cast<float>(k), 0.2f, 0.05f);
  CHECK(chain.corner() == -1);
}

// Behind a car, borders may lie anywhere in their gaps, all off alike.
TEST_CASE("corner: open borders aside of the others' line make none, closed ones do") {
  for (const bool open : {true, false}) {
    Chain chain;
    for (int k = 0; k < 40; ++k) {
      const bool aside = k >= 15 && k < 30;
      chain.add(0.1f * static_cast<float>(k), 1.0f + (aside ? 0.2f : off_m(k, 0.05f)), aside ? 0.2f : 0.05f,
                aside && open);
    }
    CHECK((chain.corner() == -1) == open);
  }
}

}  // namespace
}  // namespace curbline
