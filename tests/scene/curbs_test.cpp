// Steps across the robot's path, up and down, high and low.
#include <catch2/catch.hpp>

#include "scene.hpp"

namespace curbline::test {
namespace {

//                 _______________ 0.12
//                |
//  ______________|
//  0             2                4 m
TEST_CASE("scene: a straight curb is one line with its place and height") {
  const double x = GENERATE(2.0, 2.03, 2.05, 2.08);
  const auto pipeline = seen([&](double px, double) { return px < x ? 0.0 : 0.12; });
  check_curb_at(pipeline->curbs(), x, 0.12, CurbKind::step_up);
  CHECK(pipeline->curbs().size() == 1);
  CHECK(pipeline->curbs()[0].probability > 0.9f);
}

//  ______________ 0
//                |
//                |_______________ -0.15
//  0             2                4 m
TEST_CASE("scene: a step down is told as one") {
  const auto pipeline = seen([](double x, double) { return x < 2.0 ? 0.0 : -0.15; });
  check_curb_at(pipeline->curbs(), 2.0, -0.15, CurbKind::step_down);
  CHECK(pipeline->curbs().size() == 1);
}

//                 _______________ 0.03
//  ______________|
//  0             2                4 m
TEST_CASE("scene: a low curb of 3 cm is found") {
  const auto pipeline = seen([](double x, double) { return x < 2.0 ? 0.0 : 0.03; });
  check_curb_at(pipeline->curbs(), 2.0, 0.03, CurbKind::step_up);
  CHECK(pipeline->curbs().size() == 1);
}

//                 _______________ 0.12
//                |
//  _____________ |
//               \|  -0.03
//  0          1.7 2               4 m
TEST_CASE("scene: a curb's height is measured from the bottom of a gutter too narrow for a plane") {
  const double x = GENERATE(2.0, 2.03, 2.05, 2.08);
  const auto height_m = [&](double px, double) { return px < x - 0.3 ? 0.0 : px < x ? 0.1 * (x - 0.3 - px) : 0.12; };
  const auto pipeline = seen(height_m);
  check_curb_at(pipeline->curbs(), x, 0.15, CurbKind::step_up);
  for (const Curb& curb : across_the_window(pipeline->curbs(), x)) CHECK(curb.height_m == Approx(0.15).margin(0.01));
}

//       ########     a street that falls by 2 %, with an oblique curb of 18 mm and nothing else:
//     ##########     while one plane covers all of it, its cells have errors in common
TEST_CASE("scene: a curb of 2 cm is found where there is nothing else") {
  const auto pipeline = seen([](double x, double y) { return -0.02 * x + (x + y < 2.0 ? 0.0 : 0.018); });
  double found_m = 0.0;
  for (const Curb& c : pipeline->curbs()) {
    if (c.kind != CurbKind::step_up) continue;
    CHECK(std::abs(c.x0_m + c.y0_m - 2.0) < 2 * half_cell_m);
    CHECK(c.height_m == Approx(0.018).margin(0.005));  // low: cells with points of both sides do not show it
    found_m += length_m(c);
  }
  CHECK(found_m > 5.0);
}

//                                  __ 0.30
//                        _________|
//              _________| 0.15
//  ___________|
//  0          1.2       2.4       4 m    (a flat step of 1.2 m, then one more)
TEST_CASE("scene: two steps are two curbs, each with its own height") {
  const auto pipeline = seen([](double x, double) { return x < 1.2 ? 0.0 : x < 2.4 ? 0.15 : 0.30; });
  check_curb_at(pipeline->curbs(), 1.2, 0.15, CurbKind::step_up);
  check_curb_at(pipeline->curbs(), 2.4, 0.15, CurbKind::step_up);
  CHECK(pipeline->curbs().size() == 2);
}

//                ____________
//               |            |         an island in the road
//  _____________|            |_______
//  0            1.5          2.7      4 m
TEST_CASE("scene: an island goes up and down again") {
  const auto pipeline = seen([](double x, double) { return x > 1.5 && x < 2.7 ? 0.14 : 0.0; });
  check_curb_at(pipeline->curbs(), 1.5, 0.14, CurbKind::step_up);
  check_curb_at(pipeline->curbs(), 2.7, -0.14, CurbKind::step_down);
}

//                 ______________  falls by 2 % to the road for the rain to run off
//   ____________ |
//  /            \|                road: crown in the middle, falls by 3 %; the street climbs by 5 % along y
TEST_CASE("scene: a sloping street has the curb of a flat one") {
  const auto pipeline =
      seen([](double x, double y) { return 0.05 * y + (x < 2.0 ? -0.03 * x : -0.06 + 0.12 + 0.02 * (x - 2.0)); });
  const auto curbs = across_the_window(pipeline->curbs(), 2.0);
  CHECK(total_length_m(curbs) > 3.8);
  for (const Curb& c : curbs) {
    CHECK(c.kind == CurbKind::step_up);
    CHECK(c.height_m == Approx(0.12).margin(4 * c.height_sd_m));
  }
}

//          map:  . . . . ######
//                . . ##########   an oblique border, 30 degrees from the robot's path
//                ##############
TEST_CASE("scene: an oblique curb lies on its line") {
  const double nx = std::cos(0.6), ny = std::sin(0.6);
  const auto off = [&](double x, double y) { return nx * (x - 2.0) + ny * y; };
  const auto pipeline = seen([&](double x, double y) { return off(x, y) < 0.0 ? 0.0 : 0.12; });
  double length = 0.0;
  for (const Curb& c : pipeline->curbs()) {
    CHECK(std::abs(off(c.x0_m, c.y0_m)) <= 2 * half_cell_m);
    CHECK(std::abs(off(0.5 * (c.x0_m + c.x1_m), 0.5 * (c.y0_m + c.y1_m))) <= half_cell_m);
    CHECK(c.height_m == Approx(0.12).margin(4 * c.height_sd_m));
    length += length_m(c);
  }
  CHECK(length == Approx(4.0 / nx).margin(0.4));
}

}  // namespace
}  // namespace curbline::test
