// Border points, how they are chained, and what a part of a chain weighs. Where they are found: border_finder_test.cpp.
#include "curbline/borders/borders.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::small_limits;
using test::small_settings;
using test::Stages;

TEST_CASE("borders: one that lies before the window or beyond it is found from its neighbour") {
  Stages<small_limits> stages(small_settings());
  Borders<small_limits> borders;
  const float before = -0.12f, beyond = 2.52f;
  for (const float x : {before, beyond}) {
    borders.clear();
    for (const float y : {0.05f, 0.15f}) {
      Border border{};
      border.x_m = y < 0.1f ? x : x < 0.0f ? 0.02f : 2.38f;
      border.y_m = y;
      border.other = 1;
      REQUIRE(borders.add(stages.dem, border));
    }
    CHECK(borders.chain(stages.dem, 0, 5) == 2);
  }
}

TEST_CASE("borders: a chain goes on to the next border within reach, of the same planes alone") {
  Stages<small_limits> stages(small_settings());
  Borders<small_limits> borders;
  const auto chained = [&](const std::vector<std::array<double, 2>>& places, bool of_others) {
    borders.clear();
    for (const auto& [x, y] : places) {
      Border border{};
      border.x_m = static_cast<float>(x);
      border.y_m = static_cast<float>(y);
      border.one = of_others && borders.size() == 1 ? 1 : 0;
      border.other = 2;
      REQUIRE(borders.add(stages.dem, border));
    }
    return borders.chain(stages.dem, 0, 5);
  };
  for (const bool along_x : {false, true}) {
    for (const double from : {0.35, 1.95}) {
      const auto two = [&](double apart, bool of_others = false) {
        const double to = from < 1.0 ? from + apart : from - apart;
        using Places = std::vector<std::array<double, 2>>;
        return chained(along_x ? Places{{from, 1.25}, {to, 1.25}} : Places{{1.25, from}, {1.25, to}}, of_others);
      };
      CHECK(two(0.1) == 2);
      CHECK(two(0.5) == 2);
      CHECK(two(0.6) == 1);
      CHECK(two(1.6) == 1);
      CHECK(two(0.1, true) == 1);
      // One between them, from which the chain starts: what is beyond the reach of one end does not belong to it.
      const double toward = from < 1.0 ? 0.1 : -0.1, next = from + toward, away = from + 7.0 * toward;
      using Places = std::vector<std::array<double, 2>>;
      CHECK(chained(along_x ? Places{{next, 1.25}, {from, 1.25}, {away, 1.25}}
                            : Places{{1.25, next}, {1.25, from}, {1.25, away}},
                    false) == 2);
    }
  }
}

//  B . 3 . B    Between two borders of A and B lies one of A and 3 alone, or also one of 3 and B, or one found along
//  them. A . A . A
TEST_CASE("borders: the edge is another where one of their planes borders on others, not along a strip of those") {
  Stages<small_limits> stages(small_settings());
  const bool along_x = GENERATE(false, true);
  const auto cells_of_other = [&](double apart, bool other_side, bool across, Label third = 3,
                                  bool other_height = true) {
    Borders<small_limits> borders;
    borders.clear();
    const auto add = [&](double along, double aside, Label one, Label other, bool axis_y) {
      Border border{};
      border.x_m = static_cast<float>(along_x ? along : aside);
      border.y_m = static_cast<float>(along_x ? aside : along);
      border.one = one;
      border.other = other;
      border.axis = axis_y ? 1 : 0;
      REQUIRE(borders.add(stages.dem, border));
    };
    add(0.35, 1.25, 0, 1, along_x);
    add(0.35 + apart, 1.25, 0, 1, along_x);
    add(0.35 + apart / 2, 1.22, 0, third, across ? along_x : !along_x);
    if (other_side) add(0.35 + apart / 2, 1.32, 1, 3, along_x);
    REQUIRE(borders.chain(stages.dem, 0, 5) == 2);
    return borders.other_edge_after(stages.dem, 0, [&](const auto&) { return other_height; });
  };
  for (const double apart : {0.3, 0.4, 0.5}) {
    CHECK(cells_of_other(apart, false, true) == static_cast<int>(std::lround(apart * 10)) - 1);
    CHECK(cells_of_other(apart, true, true) == 0);
    CHECK(cells_of_other(apart, false, false) == 0);
    CHECK(cells_of_other(apart, false, true, no_label) == 0);  // a brink
    CHECK(cells_of_other(apart, false, true, 3, false) == 0);
  }
  CHECK(cells_of_other(0.2, false, true) == 0);  // within two cells: a single column that bears another label
}

TEST_CASE("borders: those that one obstacle leaves open count as one observation, unless a curb has no others") {
  Stages<small_limits> stages(small_settings());
  Borders<small_limits> borders;
  const auto observations = [&](int clear, int open) {
    borders.clear();
    for (int k = 0; k < clear + open; ++k) {
      Border border{};
      border.x_m = 1.25f;
      border.y_m = 0.05f + 0.1f * static_cast<float>(k);
      border.other = 1;
      border.open = k >= clear;
      REQUIRE(borders.add(stages.dem, border));
    }
    const int length = borders.chain(stages.dem, 0, 5);
    REQUIRE(length == clear + open);
    return borders.part(0, length - 1).observations();
  };
  CHECK(observations(6, 0) == 6.0f);
  CHECK(observations(6, 1) == 7.0f);
  CHECK(observations(6, 5) == Approx(7.0));
  CHECK(observations(0, 5) == 5.0f);
}

}  // namespace
}  // namespace curbline
