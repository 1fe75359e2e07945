// Cells that the edges of steps cross.
#include "curbline/curbs/crossed_cells.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::Noise;
using test::small_limits;

class CrossedCellsTest {
 public:
  CrossedCellsTest() { dem_.init(test::small_settings().window, PlanePrior{}); }

  static Curb step(double x0_m, double y0_m, double x1_m, double y1_m) {
    Curb curb;
    curb.x0_m = static_cast<float>(x0_m);
    curb.y0_m = static_cast<float>(y0_m);
    curb.x1_m = static_cast<float>(x1_m);
    curb.y1_m = static_cast<float>(y1_m);
    curb.kind = CurbKind::step_up;
    curb.near_label = 0;
    curb.far_label = 1;
    return curb;
  }
  std::vector<int> crossed_by(const Curb& curb) const {
    std::vector<int> slots;
    crossed_cells(dem_, std::span(&curb, 1)).for_each([&](int slot) { slots.push_back(slot); });
    return slots;
  }

 protected:
  Dem<small_limits> dem_;
};

TEST_CASE_METHOD(CrossedCellsTest, "crossed cells: those in which a part of the curb lies, of any way it goes") {
  Noise noise;
  const auto within = [&] { return -0.4 + 3.2 * noise.uniform(); };  // the window's 2.4 m, and beyond
  for (int k = 0; k < 200; ++k) {
    const double x0 = within(), y0 = within(), x1 = within(), y1 = within();
    const auto crossed = crossed_by(step(x0, y0, x1, y1));
    std::vector<int> walked;
    const int steps = 100000;
    for (int n = 0; n <= steps; ++n) {
      const double x = x0 + (x1 - x0) * n / steps, y = y0 + (y1 - y0) * n / steps;
      if (x < 0.0 || y < 0.0 || x >= 2.4 || y >= 2.4) continue;
      const int slot = dem_.slot(static_cast<int>(x / 0.1), static_cast<int>(y / 0.1));
      if (walked.empty() || walked.back() != slot) walked.push_back(slot);
    }
    std::sort(walked.begin(), walked.end());
    INFO(x0 << ' ' << y0 << " to " << x1 << ' ' << y1);
    CHECK(std::includes(crossed.begin(), crossed.end(), walked.begin(), walked.end()));
    CHECK(crossed.size() <= walked.size() + 1);  // a corner that it only touches
  }
}

TEST_CASE_METHOD(CrossedCellsTest,
                 "crossed cells: also those that the curb may cross, by the deviation of its position") {
  const auto columns_of = [this](Curb curb, double position_sd_m) {
    curb.position_sd_m = static_cast<float>(position_sd_m);
    return crossed_by(curb).size() / 10;
  };
  // Between two columns of cells, and in the middle of one.
  const Curb between = step(1.301, 0.501, 1.301, 1.499), within = step(1.35, 0.501, 1.35, 1.499);
  const Curb row_between = step(0.501, 1.301, 1.499, 1.301);
  CHECK(columns_of(between, 0.0) == 1);
  CHECK(columns_of(between, 0.03) == 2);
  CHECK(columns_of(row_between, 0.03) == 2);
  CHECK(columns_of(within, 0.03) == 1);
  CHECK(columns_of(within, 0.06) == 3);
  CHECK(columns_of(within, INFINITY) == 3);  // at most a cell
  CHECK(columns_of(within, NAN) == 3);
}

TEST_CASE_METHOD(CrossedCellsTest, "crossed cells: the same wherever the window lies in the map") {
  const std::vector<int> expected = crossed_by(step(0.53, 0.17, 1.31, 1.88));
  REQUIRE(expected.size() > 17);
  WindowSettings window = test::small_settings().window;
  window.origin_x_m = 16.0f;
  window.origin_y_m = -8.0f;
  dem_.init(window, PlanePrior{});
  CHECK(crossed_by(step(16.53, -7.83, 17.31, -6.12)) == expected);
}

TEST_CASE_METHOD(CrossedCellsTest, "crossed cells: none of a crease, nor of a brink, of which no far side is seen") {
  Curb crease = step(0.5, 0.5, 1.5, 0.5), brink = crease;
  CHECK(crossed_by(crease).size() == 11);
  crease.kind = CurbKind::crease;
  brink.far_label = no_label;
  CHECK(crossed_by(crease).empty());
  CHECK(crossed_by(brink).empty());
}

TEST_CASE_METHOD(CrossedCellsTest, "crossed cells: a curb that is as long as a point lies in one") {
  CHECK(crossed_by(step(1.25, 0.75, 1.25, 0.75)).size() == 1);
}

TEST_CASE_METHOD(CrossedCellsTest, "crossed cells: none of a curb of which an end is beyond all maps") {
  const double away = GENERATE(-1e9, 1e9);
  CHECK(crossed_by(step(away, 0.5, 1.5, 0.5)).empty());
  CHECK(crossed_by(step(0.5, away, 0.5, 1.5)).empty());
  CHECK(crossed_by(step(0.5, 0.5, away, 0.5)).empty());
  CHECK(crossed_by(step(0.5, 0.5, 0.5, away)).empty());
}

}  // namespace
}  // namespace curbline
