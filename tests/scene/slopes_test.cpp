// Slopes without steps: ramps, creases and gutters.
#include <catch2/catch.hpp>

#include "scene.hpp"

namespace curbline::test {
namespace {

//                                _/
//                           __/
//                      __/          6 %
//  ______________ __/
//  0                               4 m   (the whole window on the ramp)
TEST_CASE("scene: a ramp without a curb has none") {
  const double slope = GENERATE(0.06, -0.06, 0.15);
  const auto pipeline = seen([&](double x, double) { return slope * x; });
  CHECK(pipeline->curbs().empty());
}

//                         ____/
//                 ____/             12 %
//  ______________/
//  0             2                4 m
TEST_CASE("scene: the foot of a ramp is the edge of a ramp, not a step") {
  const auto pipeline = seen([](double x, double) { return x < 2.0 ? 0.0 : 0.12 * (x - 2.0); });
  REQUIRE_FALSE(pipeline->curbs().empty());
  for (const Curb& c : pipeline->curbs()) {
    CHECK(c.kind == CurbKind::ramp_edge);
    CHECK(c.x0_m == Approx(2.0).margin(0.3));  // heights good to 2 mm tell slopes 12 % apart after two cells
    CHECK(std::abs(c.height_m) < 0.12 * 0.3);
  }
}

//  _                                 _
//    ‾‾--__                   __--‾‾
//          ‾‾--__       __--‾‾          8 % from both sides
//                ‾‾---‾‾
//  0               2                4 m
TEST_CASE("scene: a gutter is a crease, and both its sides are planes") {
  const auto pipeline = seen([](double x, double) { return 0.08 * std::abs(x - 2.0); });
  REQUIRE_FALSE(pipeline->curbs().empty());
  for (const Curb& c : pipeline->curbs()) {
    CHECK(c.kind == CurbKind::crease);
    CHECK(c.x0_m == Approx(2.0).margin(0.2));
  }
  const auto& near = pipeline->plane(pipeline->label(5, 20));
  const auto& far = pipeline->plane(pipeline->label(35, 20));
  CHECK(near.slope_x == Approx(-0.08).margin(0.01));
  CHECK(far.slope_x == Approx(0.08).margin(0.01));
}

//          y < 0:         ________        y > 0:
//                        |                           ____
//  ______________________|             ____________/        lowered: a ramp of 12 cm over 1 m
//  0                     2             0           2  3
TEST_CASE("scene: where a curb is lowered there is no step, beside it there is") {
  const auto pipeline = seen([](double x, double y) {
    return x < 2.0 ? 0.0 : y < 0.0 ? 0.12 : x < 3.0 ? 0.12 * (x - 2.0) : 0.12;
  });
  double step_length = 0.0;
  for (const Curb& c : across_the_window(pipeline->curbs(), 2.0)) {
    const bool beside = std::max(c.y0_m, c.y1_m) < 0.3f;
    if (c.kind == CurbKind::step_up && beside) step_length += length_m(c);
    if (!beside) CHECK(std::abs(c.height_m) < 0.03);
  }
  CHECK(step_length > 1.7);
}

//  ______________________________
//  0                             4 m
TEST_CASE("scene: flat ground has no curb, whatever the noise") {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const auto pipeline = seen([](double, double) { return 0.0; }, seed);
    CHECK(pipeline->curbs().empty());
  }
}

}  // namespace
}  // namespace curbline::test
