// Which planes are ground, drawn as cross-sections.
#include "curbline/ground.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::small_limits;
using test::small_settings;
using test::Stages;

/// How many planes there are that cells of the window bear.
template <typename Height>
std::size_t borne_from(const Viewpoint& view, Height&& height_m) {
  Stages<small_limits> stages(small_settings());
  stages.view = view;
  fill(stages.dem, height_m);
  for (int pass = 0; pass < 3; ++pass) stages.infer(true);
  std::set<int> labels;
  stages.dem.for_each_valid([&](int i, int j, int) { labels.insert(stages.label_at(i, j)); });
  return labels.size();
}

template <typename Height>
std::size_t borne(Height&& height_m, float laser_z_m = 1.0f) {
  return borne_from({0.0f, 0.0f, laser_z_m}, height_m);
}

//           ______
//          |           the cells at 1.1 m hold points of both sides
//  ________|
TEST_CASE("ground: the cells in which a curb's face stands are left to both sides") {
  CHECK(borne([](double x, double) { return x < 1.15 ? 0.0 : 0.12; }) == 2);
}

//           |
//           |______
//          |           a post stands beside the face
//  ________|
TEST_CASE("ground: the cells in which a curb's face stands are left to both sides beside a post, too") {
  const auto post = [](double from_x_m) {
    return [=](double x, double y) {
      if (x >= from_x_m && x < from_x_m + 0.2 && y >= 0.5 && y < 0.7)
        return static_cast<int>(y * 100) % 10 < 5 ? 0.5 : 2.0;
      return x < 1.15 ? 0.0 : 0.06;
    };
  };
  CHECK(borne(post(1.2)) == 2);
  CHECK(borne(post(0.9)) == 2);
}

//           ______
//         /            a strip of three cells, on ground as even as a floor, by a laser of 1 cm
//  ______/
TEST_CASE("ground: a strip that rises is ground, not the face of a curb, however much the laser's readings spread") {
  const auto is_ground = [](double from_x_m) {
    Settings settings = small_settings();
    settings.planes.prior.common_share = 0.01f;
    Stages<small_limits> stages(settings);
    const auto rising = [&](double x, double) {
      return x < from_x_m ? 0.0 : x < 1.3 ? 0.05 * (x - from_x_m) / (1.3 - from_x_m) : 0.05;
    };
    for (int scan = 0; scan < 16; ++scan) fill(stages.dem, rising, 0.01);
    for (int pass = 0; pass < 3; ++pass) stages.infer(true);
    return stages.mixture.on_ground(stages.dem.slot(12, 12));
  };
  CHECK(is_ground(1.0));
  CHECK_FALSE(is_ground(1.2));  // a cell wide
}

//             ______
//       _____|         a strip of three cells, level
//  ____|
TEST_CASE("ground: a strip that has cells of its own is ground") {
  CHECK(borne([](double x, double) { return x < 1.0 ? 0.0 : x < 1.3 ? 0.07 : 0.14; }) == 3);
}

//         |
//         | .          a wall of which the laser sees 40 cm, at the end of the window; a hedge
//  _______|_
TEST_CASE("ground: an obstacle, thin or wide, is left to the ground before it") {
  const auto until = [](double begin) {
    return [=](double x, double y) {
      return x >= begin ? 0.2 + (static_cast<int>(y * 100) % 10 < 5 ? -0.15 : 0.15) : 0.0;
    };
  };
  CHECK(borne(until(2.3)) == 1);
  CHECK(borne(until(1.2)) == 1);
}

//           |
//           /
//         _/           the foot of a wall and the ground before it, in one reading
//  ______/
TEST_CASE(
    "ground: a strip of mixed readings at the foot of an obstacle is left to the ground before it, a kerb is none") {
  const auto wall = [](double x, double y) {
    return 0.5 + 0.6 * (x - 1.2) + (static_cast<int>(y * 100) % 10 < 5 ? -0.5 : 0.5);
  };
  const auto before_wall = [&](double strip_m, double lean) {
    return [=](double x, double y) { return x >= 1.2 ? wall(x, y) : x < 1.0 ? 0.0 : strip_m + lean * (x - 1.1); };
  };
  CHECK(borne(before_wall(0.04, 0.2)) == 1);
  CHECK(borne(before_wall(0.4, 0.0)) == 1);    // the box itself
  CHECK(borne(before_wall(0.08, 0.0)) == 2);   // a pavement
  CHECK(borne(before_wall(-0.04, 0.2)) == 2);  // a gutter
  CHECK(borne([](double x, double) { return x < 1.0 ? 0.0 : x < 1.2 ? 0.04 : 0.16; }) == 3);
}

//           |                               ______
//           |
//         _/           bank before a wall   .:.:         rough verge between road and pavement
//  ______/                            _____
TEST_CASE("ground: a bank before an obstacle, or a rough verge, that is wider than three cells is ground") {
  const auto one_of = [](double y, double low_m, double high_m) {
    return static_cast<int>(y * 100) % 10 < 5 ? low_m : high_m;
  };
  const auto bank = [=](double width_m) {
    return [=](double x, double y) {
      if (x >= 1.6) return one_of(y, 0.2, 1.2);
      return x < 1.6 - width_m ? 0.0 : 0.2 * (x - 1.6 + width_m);
    };
  };
  CHECK(borne(bank(0.3)) == 1);
  CHECK(borne(bank(0.4)) == 2);
  const auto verge = [=](double width_m) {
    return [=](double x, double y) { return x >= 1.6 ? 0.12 : x < 1.6 - width_m ? 0.0 : one_of(y, 0.034, 0.086); };
  };
  CHECK(borne(verge(0.3)) == 2);
  CHECK(borne(verge(0.4)) == 3);
}

//  o_
//    --_                laser; rays past the edge of a box, and what they hit, mixed
//      |--_
//  ____|___--____
TEST_CASE(
    "ground: a veil behind an obstacle's edge is left to the ground around it, the same slope seen from above is "
    "none") {
  const auto veil = [](double x, double) { return x < 1.2 || x > 1.8 ? 0.0 : 1.0 - x / 1.8; };
  CHECK(borne(veil, 1.0f) == 2);  // before it and behind
  CHECK(borne(veil, 1.04f) == 2);
  CHECK(borne(veil, 1.1f) == 3);  // as far as ten standard deviations beside it
  CHECK(borne(veil, 3.0f) == 3);
}

//        ___
//   ____|   |_____     from above, too: 60 cm long and wide
TEST_CASE("ground: the top of a box is an obstacle; lower than a stair, or at the window's end, it may be a way") {
  const auto block = [](double height_m, double from_x_m) {
    return
        [=](double x, double y) { return x > from_x_m && x < from_x_m + 0.6 && y > 0.9 && y < 1.5 ? height_m : 0.0; };
  };
  CHECK(borne(block(0.28, 0.9)) == 1);
  CHECK(borne(block(0.16, 0.9)) == 2);
  CHECK(borne(block(0.28, 1.8)) == 2);
}

//     ||  wall, from end to end of the window     ___|  platform beyond it     ___   platform under the robot, which
//  ___||___                                   ___|                                |___ sees only its edge
TEST_CASE("ground: what is narrower than shoulders is a wall, unless it may go on where nothing is seen") {
  const auto strip = [](double from_y_m, double to_y_m) {
    return [=](double, double y) { return y > from_y_m && y < to_y_m ? 0.28 : 0.0; };
  };
  CHECK(borne(strip(0.9, 1.2)) == 2);  // the ground on both sides
  CHECK(borne(strip(0.9, 1.6)) == 3);
  CHECK(borne(strip(2.0, 9.0)) == 2);
  const auto aslant = [](double x, double y) { return y - 0.3 * x > 0.6 && y - 0.3 * x < 0.95 ? 0.28 : 0.0; };
  CHECK(borne(aslant) == 2);
  const auto underfoot = [](double x, double) { return x < 0.6 ? std::nan("") : x < 0.9 ? 0.28 : 0.0; };
  CHECK(borne_from({0.0f, 1.2f, 1.0f}, underfoot) == 2);
}

//       __ . . .       a pavement along the front of which the laser has looked up to now; a wall, and what it hides
//  ____|
TEST_CASE("ground: a high pavement of which the laser has seen the front alone, up to now, is no wall") {
  const auto seen = [](double from_x_m, double to_x_m) {
    return [=](double x, double) {
      return x < 1.2 ? 0.0 : x < 1.5 ? 0.22 : x < from_x_m || x > to_x_m ? 0.0 : std::nan("");
    };
  };
  CHECK(borne_from({0.0f, 1.2f, 1.0f}, seen(1.5, 9.0)) == 2);
  CHECK(borne_from({0.0f, 1.2f, 1.0f}, seen(1.5, 2.0)) == 2);  // the ground before it and behind
}

//             ______
//          __|         between two walls, 1.2 m apart
//  _______|
TEST_CASE("ground: the steps of a stair are as small as boxes, and the next one lies higher") {
  CHECK(borne([](double x, double y) {
          if (x < 0.9 || y < 0.6 || y > 1.8) return 0.0;
          return x < 1.2 ? 0.14 : x < 1.5 ? 0.28 : 0.42;
        }) == 4);
}

//             ___
//          __|            the last that is seen
//  _______|
TEST_CASE("ground: the highest step of a stair that is seen is no top of a box, but one that stands apart is") {
  const auto steps = [](double gap_m) {
    return [=](double x, double y) {
      if (x < 0.9 || y < 0.6 || y > 1.8) return 0.0;
      if (x > 1.8 + gap_m) return std::nan("");  // not seen
      return x < 1.2 ? 0.14 : x < 1.5 ? 0.28 : x < 1.5 + gap_m ? 0.0 : 0.42;
    };
  };
  CHECK(borne(steps(0.0)) == 4);
  CHECK(borne(steps(0.3)) == 2);
}

//               ___
//            __/          two cells deep, beside a face over which readings spread by 20 cm
//         __|
//  ______|
TEST_CASE("ground: a step of a stair beside a face that is blurred is no fringe of it") {
  CHECK(borne([](double x, double y) {
          if (x < 0.9 || y < 0.6 || y > 1.8) return 0.0;
          if (x > 1.8) return std::nan("");  // not seen
          const double blur_m = static_cast<int>(y * 100) % 10 < 5 ? -0.1 : 0.1;
          return x < 1.2 ? 0.16 : x < 1.4 ? 0.32 : x < 1.5 ? 0.4 + blur_m : 0.48;
        }) == 4);
}

//  o
//  ____________
//              --__       the edge and the road behind, mixed, in the shadow of the step
//                  |___
TEST_CASE("ground: readings in the shadow of a step down are left to both sides, a stair there is ground") {
  const auto down = [](double slope) {
    return [=](double x, double) { return x < 1.4 ? 0.0 : x < 1.7 ? -0.1 - slope * (x - 1.55) : -0.2; };
  };
  CHECK(borne(down(0.4)) == 2);
  CHECK(borne(down(0.2)) == 2);  // less than half as steep as the rays, as where the edge is bent
  CHECK(borne(down(0.0)) == 3);
  CHECK(borne([](double x, double) {
          return x < 1.4 ? -0.2 : x < 1.7 ? -0.1 + 0.4 * (x - 1.55) : 0.0;
        }) == 3);  // up: seen from below
  CHECK(borne([](double x, double) { return x < 1.4 ? 0.0 : x < 1.9 ? -0.44 * (x - 1.4) : -0.22; }) == 3);  // wider
}

TEST_CASE(
    "ground: readings that a robot took in the shadow of a step before it drove up to it are left to both sides") {
  const auto down = [](double x, double) { return x < 1.4 ? 0.0 : x < 1.7 ? -0.1 - 0.4 * (x - 1.55) : -0.2; };
  const auto ramp = [](double x, double) { return x < 1.4 ? 0.0 : x < 1.9 ? -0.4 * (x - 1.4) : -0.2; };
  Viewpoint view{0.8f, 1.2f, 1.0f};
  CHECK(borne_from(view, down) == 3);  // stood there always: the shadow is narrower
  view.end_x_m = view.end_y_m = 2.4f;
  CHECK(borne_from(view, down) == 2);
  CHECK(borne_from(view, ramp) == 3);
}

//     ____ o ->          the robot has driven over the edge, and looks at it no more
//    o ->   --__
//              |___
TEST_CASE("ground: readings in the shadow of a step stay what they are when the robot has driven over it") {
  const auto borne_after = [](float robot_x_m) {
    Stages<small_limits> stages(small_settings());
    stages.view = {0.0f, 1.2f, 1.0f, 2.4f, 2.4f};
    stages.dem.look_from(0.0f, 1.2f);
    fill(stages.dem, [](double x, double) { return x < 1.4 ? 0.0 : x < 1.7 ? -0.1 - 0.4 * (x - 1.55) : -0.2; });
    stages.dem.look_from(robot_x_m, 1.2f);
    stages.view.x_m = robot_x_m;
    for (int pass = 0; pass < 3; ++pass) stages.infer(true);
    std::set<int> labels;
    stages.dem.for_each_valid([&](int i, int j, int) { labels.insert(stages.label_at(i, j)); });
    return labels.size();
  };
  CHECK(borne_after(0.0f) == 2);
  CHECK(borne_after(1.55f) == 2);
  CHECK(borne_after(2.2f) == 2);
}

TEST_CASE("ground: the shadow of a step across the grid is as wide as the laser is far from its edge") {
  CHECK(borne([](double x, double y) {
          const double d = x + y;
          return d < 2.0 ? 0.0 : d < 2.35 ? -0.1 - 0.36 * (d - 2.175) : -0.2;
        }) == 2);
}

//   ___                seen from above: an edge that bends about the laser. Its veil leans this way and that, and is
//  /  o |              level on the whole
TEST_CASE("ground: the veil of an edge that bends about the laser is left to both sides, a stair there is ground") {
  const auto down = [](double slope) {
    return [=](double x, double y) {
      const double r = std::hypot(x, y - 1.2);
      return r < 1.4 ? 0.0 : r < 1.7 ? -0.15 - slope * (r - 1.55) : -0.3;
    };
  };
  CHECK(borne(down(0.5)) == 2);
  CHECK(borne(down(0.0)) == 3);
}

//  _____
//       _              one cell of them: its slope is not known
//        ______
TEST_CASE(
    "ground: a strip of a cell in the shadow of a step down is left to both sides, seen from below it is ground") {
  CHECK(borne([](double x, double) { return x < 1.4 ? 0.0 : x < 1.5 ? -0.1 : -0.2; }) == 2);
  CHECK(borne([](double x, double) { return x < 1.4 ? -0.2 : x < 1.5 ? -0.1 : 0.0; }) == 3);
}

TEST_CASE("ground: a row of cells at the window's end, of which the slope is not known, is no veil") {
  CHECK(borne([](double x, double) { return x < 2.3 ? 0.0 : 0.1; }) == 2);
}

//           o______     the origin of a cloud, on the pavement's plane: no laser has seen it from there
//  ________|
TEST_CASE("ground: a plane that holds the laser is ground where that is no higher above the ground than a kerb") {
  const auto pavement = [](double kerb_m) { return [=](double x, double) { return x < 1.4 ? -kerb_m : 0.0; }; };
  CHECK(borne(pavement(0.12), 0.0f) == 2);
  CHECK(borne(pavement(0.28), 0.0f) == 2);
  CHECK(borne(pavement(0.32), 0.0f) == 1);  // higher than any kerb: a veil
}

//  o
//  ------____
//            ------____     a pavement on a hill, of which a robot sees little: 40 cm, from afar
TEST_CASE("ground: what leans as the hill does is no blurred edge, though it is steeper than a ramp") {
  const auto may_blur = [](double hill, double strip) {
    Stages<small_limits> stages(small_settings());
    stages.view = {0.0f, 1.2f, 1.0f, 8.0f, 8.0f};
    fill(stages.dem, [=](double x, double) { return x < 2.0 ? -hill * x : -hill * 2.0 + 0.06 - strip * (x - 2.0); });
    for (int pass = 0; pass < 3; ++pass) stages.infer(true);
    return stages.mixture.may_be_veil(stages.label_at(22, 12));
  };
  CHECK(may_blur(0.0, 0.15));
  CHECK_FALSE(may_blur(0.12, 0.15));
  CHECK(may_blur(0.12, 0.27));
  CHECK(may_blur(0.04, 0.15));  // a street
}

TEST_CASE("ground: a slope that a robot can stand on is ground") {
  CHECK(borne([](double x, double) { return x < 1.0 ? 0.0 : 0.3 * (x - 1.0); }) == 2);
}

}  // namespace
}  // namespace curbline
