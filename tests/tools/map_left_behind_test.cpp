// What a window that moves has left behind of the curbs in it.
#include "map/left_behind.hpp"

#include <catch2/catch.hpp>
#include <span>

namespace curbline::tools {
namespace {

/// 4 x 4 m, cells of 0.1 m.
Grid window_at(double x_m, double y_m) {
  return {.x0_m = x_m, .y0_m = y_m, .rows = 40, .cols = 40};
}

MapCurb along(double x0_m, double y0_m, double x1_m, double y1_m) {
  return {.x0_m = x0_m, .y0_m = y0_m, .x1_m = x1_m, .y1_m = y1_m, .height_m = 0.1, .kind = "step_up"};
}

//   -2          2  y
//    ------------  a curb across the way, from side to side of the window, which then moves ahead in x
TEST_CASE("left behind: a curb across the way is kept to both sides of the window") {
  LeftBehind left(window_at(0, -2));
  const MapCurb across = along(0.2, -2, 0.3, 2);
  left.follow(window_at(0.4, -2), std::span(&across, 1));
  REQUIRE(left.curbs().size() == 1);
  CHECK(left.curbs()[0].y0_m == Approx(-2));
  CHECK(left.curbs()[0].y1_m == Approx(2));
}

TEST_CASE("left behind: a curb along the way is kept once, piece by piece") {
  LeftBehind left(window_at(0, -2));
  double next_m = 0;
  for (int k = 1; k <= 4; ++k) {
    // As found before the move: up to the window's ends.
    const MapCurb curb = along(0.4 * (k - 1), 1, 0.4 * (k - 1) + 4, 1);
    left.follow(window_at(0.4 * k, -2), std::span(&curb, 1));
    REQUIRE(left.curbs().size() == static_cast<std::size_t>(k));
    const MapCurb& part = left.curbs().back();
    CHECK(part.x0_m == Approx(next_m));
    next_m = 0.4 * k + 0.1;  // the row at the window's end may have lost one side of the curb
    CHECK(part.x1_m == Approx(next_m));
  }
}

TEST_CASE("left behind: a turn leaves nothing out and keeps nothing twice") {
  LeftBehind left(window_at(0, 0));
  MapCurb curb = along(0, 2, 4, 2);
  left.follow(window_at(0.4, 0), std::span(&curb, 1));
  curb = along(0.4, 2, 4.4, 2);
  left.follow(window_at(0.4, 2.4), std::span(&curb, 1));  // now the whole curb is left, to the side
  REQUIRE(left.curbs().size() == 2);
  CHECK(left.curbs()[0].x1_m == Approx(0.5));
  CHECK(left.curbs()[1].x0_m == Approx(0.5));
  CHECK(left.curbs()[1].x1_m == Approx(4.4));
}

TEST_CASE("left behind: what a window that comes back finds anew is kept anew") {
  LeftBehind left(window_at(0, 0));
  const MapCurb curb = along(0.1, 1, 0.1, 3);
  for (const double x_m : {0.4, 0.0, 0.4}) left.follow(window_at(x_m, 0), std::span(&curb, 1));
  CHECK(left.curbs().size() == 2);
}

TEST_CASE("left behind: a window that stays leaves nothing") {
  LeftBehind left(window_at(0, 0));
  const MapCurb curb = along(-0.1, 1, 4.1, 1);
  left.follow(window_at(0, 0), std::span(&curb, 1));
  CHECK(left.curbs().empty());
}

}  // namespace
}  // namespace curbline::tools
