// Which planes are ground, drawn as cross-sections.
#include "curbline/planes/ground.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <utility>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::small_limits;
using test::small_settings;
using test::Stages;

/// The number of different planes that cells of the window have as labels, once these have settled.
std::size_t label_count_of(Stages<small_limits>& stages) {
  stages.settle();
  std::set<int> labels;
  stages.dem.for_each_valid([&](int i, int j, int) { labels.insert(stages.label_at(i, j)); });
  return labels.size();
}

template <typename Height>
std::size_t label_count_from(const Viewpoint& view, Height&& height_m) {
  Stages<small_limits> stages(small_settings());
  stages.view = view;
  fill(stages.dem, height_m);
  return label_count_of(stages);
}

template <typename Height>
std::size_t label_count(Height&& height_m, float laser_z_m = 1.0f) {
  return label_count_from({0.0f, 0.0f, laser_z_m}, height_m);
}

/// For a map of this ground: REQUIREs that there is a plane at a position. Returns whether it is ground that may be a
/// veil.
template <typename Height>
bool may_be_veil(const Viewpoint& view, double x_m, double y_m, Height&& height_m) {
  Stages<small_limits> stages(small_settings());
  stages.view = view;
  fill(stages.dem, height_m);
  stages.settle();
  const Label label =
      stages.mixture.region_label(stages.dem.slot_within(static_cast<float>(x_m), static_cast<float>(y_m)));
  REQUIRE(label != no_label);
  return stages.mixture.ground(label) && stages.mixture.may_be_veil(label);
}

//           ______
//          |           the cells at 1.1 m contain points of both sides
//  ________|
TEST_CASE("ground: the cells in which a curb's face stands are left to both sides") {
  CHECK(label_count([](double x, double) { return x < 1.15 ? 0.0 : 0.12; }) == 2);
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
  CHECK(label_count(post(1.2)) == 2);
  CHECK(label_count(post(0.9)) == 2);
}

//           ______
//         /            a strip of three cells, on ground as even as a floor, by a laser with noise of 1 cm
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
    stages.settle();
    return stages.mixture.on_ground(stages.dem.slot(12, 12));
  };
  CHECK(is_ground(1.0));
  CHECK_FALSE(is_ground(1.2));  // a cell wide
}

//             ______
//       _____|         a strip of three cells, level
//  ____|
TEST_CASE("ground: a strip that has cells of its own is ground") {
  CHECK(label_count([](double x, double) { return x < 1.0 ? 0.0 : x < 1.3 ? 0.07 : 0.14; }) == 3);
}

//         |
//         | .          a wall of which the laser sees 40 cm, at the end of the window; or a hedge
//  _______|_
TEST_CASE("ground: an obstacle, thin or wide, is left to the ground before it") {
  const auto until = [](double begin) {
    return [=](double x, double y) {
      return x >= begin ? 0.2 + (static_cast<int>(y * 100) % 10 < 5 ? -0.15 : 0.15) : 0.0;
    };
  };
  CHECK(label_count(until(2.3)) == 1);
  CHECK(label_count(until(1.2)) == 1);
}

//
//           .:'.:'       grass of 10 cm, or rubble; an edging as low as that; a hedge
//  ________|
TEST_CASE("ground: wide ground is ground however rough it is, as long as it is lower than a step, no wall is as wide") {
  const auto rough = [](double begin, double end, double half_m) {
    return [=](double x, double y) {
      return x < begin || x >= end ? 0.0 : 0.05 + (static_cast<int>(y * 100) % 10 < 5 ? -half_m : half_m);
    };
  };
  CHECK(label_count(rough(1.2, 2.4, 0.05)) == 2);
  CHECK(label_count(rough(1.2, 2.1, 0.05)) == 2);
  CHECK(label_count(rough(1.2, 1.6, 0.05)) == 1);
  CHECK(label_count(rough(1.2, 2.4, 0.12)) == 1);
}

//           |
//           /
//         _/           the foot of a wall and the ground before it, mixed in one reading
//  ______/
TEST_CASE(
    "ground: a strip of mixed readings at the foot of an obstacle is left to the ground before it, a curb is none") {
  const auto wall = [](double x, double y) {
    return 0.5 + 0.6 * (x - 1.2) + (static_cast<int>(y * 100) % 10 < 5 ? -0.5 : 0.5);
  };
  const auto before_wall = [&](double strip_m, double lean) {
    return [=](double x, double y) { return x >= 1.2 ? wall(x, y) : x < 1.0 ? 0.0 : strip_m + lean * (x - 1.1); };
  };
  CHECK(label_count(before_wall(0.04, 0.2)) == 1);
  CHECK(label_count(before_wall(0.4, 0.0)) == 1);    // the box itself
  CHECK(label_count(before_wall(0.08, 0.0)) == 2);   // a pavement
  CHECK(label_count(before_wall(-0.04, 0.2)) == 2);  // a gutter
  CHECK(label_count([](double x, double) { return x < 1.0 ? 0.0 : x < 1.2 ? 0.04 : 0.16; }) == 3);
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
  CHECK(label_count(bank(0.3)) == 1);
  CHECK(label_count(bank(0.4)) == 2);
  const auto verge = [=](double width_m) {
    return [=](double x, double y) { return x >= 1.6 ? 0.12 : x < 1.6 - width_m ? 0.0 : one_of(y, 0.034, 0.086); };
  };
  CHECK(label_count(verge(0.3)) == 2);
  CHECK(label_count(verge(0.4)) == 3);
}

//  o_
//    --_                laser; rays pass the edge of a box, and mix it with what they hit behind
//      |--_
//  ____|___--____
TEST_CASE(
    "ground: a veil behind an obstacle's edge is left to the ground around it, the same slope seen from above is "
    "none") {
  const auto veil = [](double x, double) { return x < 1.2 || x > 1.8 ? 0.0 : 1.0 - x / 1.8; };
  CHECK(label_count(veil, 1.0f) == 2);  // the ground before it and behind
  CHECK(label_count(veil, 1.04f) == 2);
  CHECK(label_count(veil, 1.1f) == 3);  // ten standard deviations off the rays
  CHECK(label_count(veil, 3.0f) == 3);
}

//        ___
//   ____|   |_____     the same from above: 60 cm long and wide
TEST_CASE("ground: the top of a box is an obstacle, but one lower than a stair, or a metre wide at the window's end") {
  const auto block = [](double height_m, double from_x_m, double width_m = 0.6) {
    return [=](double x, double y) {
      return x > from_x_m && x < from_x_m + 0.6 && y > 0.9 && y < 0.9 + width_m ? height_m : 0.0;
    };
  };
  CHECK(label_count(block(0.28, 0.9)) == 1);
  CHECK(label_count(block(0.16, 0.9)) == 2);
  CHECK(label_count(block(0.28, 1.8)) == 1);
  CHECK(label_count(block(0.28, 1.8, 1.2)) == 2);  // may be a way
}

//        ___
//   ____.   .____     its sides: readings of the top, of the ground, and of what is between
TEST_CASE("ground: the cells around a box are an obstacle, as wide a patch of such cells is rough ground") {
  const auto one_of = [](double y) { return static_cast<int>(y * 100) % 10 < 5 ? 0.04 : 0.18; };
  const auto box = [=](double x, double y) {
    const double away_m = std::max(std::abs(x - 1.25), std::abs(y - 1.25));
    return away_m < 0.35 ? 0.22 : away_m < 0.45 ? one_of(y) : 0.0;
  };
  CHECK(label_count(box) == 1);
  CHECK(label_count([=](double x, double y) { return box(x, y) > 0.0 ? one_of(y) : 0.0; }) == 2);
}

//     ||  wall, from end to end of the window     ___|  platform beyond it     ___   platform under the robot, which
//  ___||___                                   ___|                                |___ which sees only its edge
TEST_CASE("ground: what is narrower than shoulders is a wall, unless it may go on where nothing is seen") {
  const auto strip = [](double from_y_m, double to_y_m) {
    return [=](double, double y) { return y > from_y_m && y < to_y_m ? 0.28 : 0.0; };
  };
  CHECK(label_count(strip(0.9, 1.2)) == 2);  // the ground on both sides
  CHECK(label_count(strip(0.9, 1.6)) == 3);
  CHECK(label_count(strip(2.0, 9.0)) == 2);
  const auto aslant = [](double x, double y) { return y - 0.3 * x > 0.6 && y - 0.3 * x < 0.95 ? 0.28 : 0.0; };
  CHECK(label_count(aslant) == 2);
  const auto underfoot = [](double x, double) { return x < 0.6 ? std::nan("") : x < 0.9 ? 0.28 : 0.0; };
  CHECK(label_count_from({0.0f, 1.2f, 1.0f}, underfoot) == 2);
}

//       __ . . .       a pavement of which the laser has seen only the front so far; a wall and what it hides
//  ____|
TEST_CASE("ground: a high pavement of which the laser has seen the front alone, up to now, is no wall") {
  const auto seen = [](double from_x_m, double to_x_m) {
    return [=](double x, double) {
      return x < 1.2 ? 0.0 : x < 1.5 ? 0.22 : x < from_x_m || x > to_x_m ? 0.0 : std::nan("");
    };
  };
  const Viewpoint driving{0.0f, 1.2f, 1.0f, 2.4f, 2.4f}, standing{0.0f, 1.2f, 1.0f};
  CHECK(label_count_from(driving, seen(1.5, 9.0)) == 2);
  CHECK(label_count_from(driving, seen(1.5, 2.0)) == 2);  // the ground before it and behind
  CHECK(label_count_from(standing, seen(1.5, 9.0)) ==
        1);  // it has looked everywhere: a wall that hides what is behind it
}

//             ______
//          __|         between two walls, 1.2 m apart
//  _______|
TEST_CASE("ground: the steps of a stair are as small as boxes, and the next one lies higher") {
  CHECK(label_count([](double x, double y) {
          if (x < 0.9 || y < 0.6 || y > 1.8) return 0.0;
          return x < 1.2 ? 0.14 : x < 1.5 ? 0.28 : 0.42;
        }) == 4);
}

//             ___
//          __|            the last one that is seen
//  _______|
TEST_CASE("ground: the highest step of a stair that is seen is no top of a box, but one that stands apart is") {
  const auto steps = [](double gap_m) {
    return [=](double x, double y) {
      if (x < 0.9 || y < 0.6 || y > 1.8) return 0.0;
      if (x > 1.8 + gap_m) return std::nan("");  // not seen
      return x < 1.2 ? 0.14 : x < 1.5 ? 0.28 : x < 1.5 + gap_m ? 0.0 : 0.42;
    };
  };
  CHECK(label_count(steps(0.0)) == 4);
  CHECK(label_count(steps(0.3)) == 2);
}

//               ___
//            __/          two cells deep, beside a face across which readings spread by 20 cm
//         __|
//  ______|
TEST_CASE("ground: a step of a stair beside a face that is blurred is no fringe of it") {
  CHECK(label_count([](double x, double y) {
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
  CHECK(label_count(down(0.4)) == 2);
  CHECK(label_count(down(0.2)) == 3);  // less than half as steep as the rays
  CHECK(label_count(down(0.0)) == 3);
  CHECK(label_count([](double x, double) {
          return x < 1.4 ? -0.2 : x < 1.7 ? -0.1 + 0.4 * (x - 1.55) : 0.0;
        }) == 3);  // upward, seen from below
  CHECK(label_count([](double x, double) {
          return x < 1.4 ? 0.0 : x < 1.9 ? -0.44 * (x - 1.4) : -0.22;
        }) == 3);  // wider
}

TEST_CASE(
    "ground: readings that a robot took in the shadow of a step before it drove up to it are left to both sides") {
  const auto down = [](double x, double) { return x < 1.4 ? 0.0 : x < 1.7 ? -0.1 - 0.4 * (x - 1.55) : -0.2; };
  const auto ramp = [](double x, double) { return x < 1.4 ? 0.0 : x < 1.9 ? -0.4 * (x - 1.4) : -0.2; };
  Viewpoint view{0.8f, 1.2f, 1.0f};
  CHECK(label_count_from(view, down) == 3);  // had it always been there: the shadow is narrower
  view.end_x_m = view.end_y_m = 2.4f;
  CHECK(label_count_from(view, down) == 2);
  CHECK(label_count_from(view, ramp) == 3);
}

//     ____ o ->          the robot has driven over the edge and no longer sees it
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
    return label_count_of(stages);
  };
  CHECK(borne_after(0.0f) == 2);
  CHECK(borne_after(1.55f) == 2);
  CHECK(borne_after(2.2f) == 2);
}

/// A position after the window has been turned by `quarters` quarter turns.
std::pair<double, double> turned(double x, double y, int quarters) {
  for (int k = 0; k < quarters; ++k) std::swap(x, y), x = 2.4 - x;
  return {x, y};
}
Viewpoint turned(const Viewpoint& view, int quarters) {
  const auto [x, y] = turned(static_cast<double>(view.x_m), static_cast<double>(view.y_m), quarters);
  return {static_cast<float>(x), static_cast<float>(y), view.z_m, view.end_x_m, view.end_y_m};
}
template <typename Height>
auto turned_ground(Height height_m, int quarters) {
  return [=](double x, double y) {
    const auto [u, v] = turned(x, y, 4 - quarters);
    return height_m(u, v);
  };
}

TEST_CASE(
    "ground: what a robot has seen in a shadow stays so, though it sees what lies before the edge from beside it") {
  const int quarters = GENERATE(0, 1, 2, 3);
  const auto borne_after = [=](float robot_x_m) {
    Stages<small_limits> stages(small_settings());
    const auto look_from = [&](float x_m) {
      stages.view = turned({x_m, 1.2f, 1.0f, 2.4f, 2.4f}, quarters);
      stages.dem.look_from(stages.view.x_m, stages.view.y_m);
    };
    const auto see = [&](bool before) {
      const auto ground = [=](double x, double) {
        if ((x < 1.4) != before) return std::nan("");
        return x < 1.4 ? 0.0 : x < 1.7 ? -0.1 - 0.4 * (x - 1.55) : -0.2;
      };
      fill(stages.dem, turned_ground(ground, quarters));
    };
    look_from(0.0f);
    see(false);
    look_from(robot_x_m);
    see(true);
    return label_count_of(stages);
  };
  CHECK(borne_after(0.0f) == 2);
  CHECK(borne_after(2.2f) == 2);
}

TEST_CASE("ground: the face of a curb is one in a window that is longer than wide, or wider than long") {
  const auto borne_in = [](int rows, int cols) {
    Stages<small_limits> stages(small_settings(rows, cols));
    const auto ground = [](double along, double across) {
      return (along < 0.55 ? 0.0 : 0.05) + (along > 1.2 && across > 0.55 ? 0.05 : 0.0);
    };
    fill(stages.dem, [&](double x, double y) { return rows > cols ? ground(x, y) : ground(y, x); });
    return label_count_of(stages);
  };
  CHECK(borne_in(24, 12) == 3);
  CHECK(borne_in(12, 24) == 3);
}

//           ______
//          /           across the way or along it, one row in four is seen, and the cells of the face at 1.1 m
//  _______/
TEST_CASE(
    "ground: the face of a curb is one where scan lines are so sparse that most of its cells lie beside nothing") {
  const auto kerb = [](double x) { return 0.08 * std::clamp((x - 1.12) / 0.08, 0.0, 1.0); };
  const auto in_cell = [](double place_m, int cell) { return static_cast<int>(place_m * 10.0) % 4 == cell; };
  const auto on_face = [](double x) { return x > 1.1 && x < 1.2; };
  CHECK(label_count([&](double x, double y) { return in_cell(y, 0) || on_face(x) ? kerb(x) : std::nan(""); }) == 2);
  CHECK(label_count([&](double x, double) { return in_cell(x, 3) || on_face(x) ? kerb(x) : std::nan(""); }) == 2);
}

//           ______
//     ?    /           as a road is seen, a cell wide, beside what a parked car hides
TEST_CASE("ground: a strip beside hidden ground on one side is no face, where most of it is beside that") {
  const auto kerb = [](double x) { return 0.08 * std::clamp((x - 1.12) / 0.08, 0.0, 1.0); };
  CHECK(label_count([&](double x, double y) { return x < 1.1 && y > 0.6 ? std::nan("") : kerb(x); }) == 3);
}

TEST_CASE("ground: the shadow of a step across the grid is as wide as the laser is far from its edge") {
  CHECK(label_count([](double x, double y) {
          const double d = x + y;
          return d < 2.0 ? 0.0 : d < 2.35 ? -0.1 - 0.36 * (d - 2.175) : -0.2;
        }) == 2);
}

//   ___                seen from above: an edge that bends around the laser. Its veil leans in all directions and is
//  /  o |              level on the whole
TEST_CASE("ground: the veil of an edge that bends about the laser is left to both sides, a stair there is ground") {
  const auto down = [](double slope) {
    return [=](double x, double y) {
      const double r = std::hypot(x, y - 1.2);
      return r < 1.4 ? 0.0 : r < 1.7 ? -0.15 - slope * (r - 1.55) : -0.3;
    };
  };
  CHECK(label_count(down(0.5)) == 2);
  CHECK(label_count(down(0.0)) == 3);
}

//  _____
//       `-._           a tread of a flight down, of which little is seen: its cells hold something of those beside it
//           `-___
TEST_CASE("ground: a tread that falls less than half as steeply as the rays is no veil, not even near the laser") {
  const auto tread = [](double from_x_m, double slope) {
    return [=](double x, double) {
      const double beyond_m = x - from_x_m;
      return beyond_m < 0.0 ? 0.0 : beyond_m < 0.3 ? -0.15 - slope * (beyond_m - 0.15) : -0.3;
    };
  };
  CHECK(label_count(tread(1.4, 0.25)) == 3);  // the rays fall by 0.71
  CHECK(label_count(tread(0.9, 0.42)) == 3);  // by 1.11
  CHECK(label_count(tread(1.4, 0.4)) == 2);
  CHECK(label_count(tread(0.9, 0.6)) == 2);
}

//  _____
//       _              one cell wide: its slope is not known
//        ______
TEST_CASE(
    "ground: a strip of a cell in the shadow of a step down is left to both sides, seen from below it is ground") {
  CHECK(label_count([](double x, double) { return x < 1.4 ? 0.0 : x < 1.5 ? -0.1 : -0.2; }) == 2);
  CHECK(label_count([](double x, double) { return x < 1.4 ? -0.2 : x < 1.5 ? -0.1 : 0.0; }) == 3);
}

TEST_CASE("ground: a row of cells at the window's end, of which the slope is not known, is no veil") {
  CHECK(label_count([](double x, double) { return x < 2.3 ? 0.0 : 0.1; }) == 2);
}

//  o
//    `- . _ _         the first scan lines on a cambered road, each in a plane through the laser
//  -  -  -  - -
TEST_CASE("ground: a single scan line on bent ground is no plane of it, more of them are") {
  const auto labelled = [](int lines) {
    Stages<Limits{}> stages(Settings{});
    stages.view.z_m = 1.15f;
    for (int line = 0; line < lines; ++line) {
      for (double y = -1.99; y < 2.0; y += 0.0125) {
        const double z = -0.01 * y * y, x = (3.3 + 0.13 * line) * (1.0 - z / 1.15);  // from the laser above x = 0
        stages.dem.add({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), 1e-4f});
      }
    }
    stages.settle();
    int cells = 0;
    stages.dem.for_each_valid([&](int i, int j, int) { cells += stages.label_at(i, j) != no_label; });
    return cells;
  };
  CHECK(labelled(1) == 0);
  CHECK(labelled(2) > 60);
}

//           o______     the origin of a cloud, on the pavement's plane; no laser has seen it from there
//  ________|
TEST_CASE("ground: a plane through the laser is ground if it is no higher above the ground than a curb") {
  const auto pavement = [](double kerb_m) { return [=](double x, double) { return x < 1.4 ? -kerb_m : 0.0; }; };
  CHECK(label_count(pavement(0.12), 0.0f) == 2);
  CHECK(label_count(pavement(0.28), 0.0f) == 2);
  CHECK(label_count(pavement(0.32), 0.0f) == 1);  // higher than any curb: a veil
}

//  o
//  ------____
//            ------____     a pavement on a hill, of which a robot sees little: 30 cm, from afar
TEST_CASE("ground: what leans as the hill does is no blurred edge, though it is steeper than a ramp") {
  const auto may_blur = [](double hill, double strip) {
    return may_be_veil({-8.0f, 1.2f, 6.0f, 8.0f, 8.0f}, 2.25, 1.25,
                       [=](double x, double) { return x < 2.1 ? -hill * x : -hill * 2.1 + 0.06 - strip * (x - 2.1); });
  };
  CHECK(may_blur(0.0, 0.15));
  CHECK_FALSE(may_blur(0.12, 0.15));
  CHECK(may_blur(0.12, 0.27));
  CHECK(may_blur(0.04, 0.15));  // a street
}

//  o          --__
//                 |____      a kerb stone between a road and a bed, 30 cm, seen from afar
//  ___________|
TEST_CASE("ground: what is higher than the ground on both its sides is no blurred edge") {
  const auto may_blur = [](double road_m) {
    return may_be_veil({-8.0f, 1.2f, 6.0f, 8.0f, 8.0f}, 1.55, 1.25, [=](double x, double) {
      return x < 1.4 ? road_m : x < 1.7 ? -0.15 * (x - 1.4) : -0.09;
    });
  };
  CHECK_FALSE(may_blur(-0.12));
  CHECK(may_blur(0.0));
}

//  o    ____
//           `--.___
//                  |____      a tread of a flight down, seen from afar, tilted by cells that hold something of the next
TEST_CASE("ground: what falls by little of the step between the planes beside it is a tread, no blurred edge") {
  const auto may_blur = [](double slope) {
    return may_be_veil({-8.0f, 1.2f, 6.0f, 8.0f, 8.0f}, 1.55, 1.25, [=](double x, double) {
      return x < 1.4 ? 0.0 : x < 1.7 ? -0.09 - slope * (x - 1.55) : -0.18;
    });
  };
  CHECK_FALSE(may_blur(0.13));
  CHECK(may_blur(0.17));
}

TEST_CASE("ground: what is ground is so whatever way the window lies, and on whatever side of it the laser stands") {
  const int quarters = GENERATE(1, 2, 3);
  const auto borne_turned = [=](const Viewpoint& view, auto&& height_m) {
    return label_count_from(turned(view, quarters), turned_ground(height_m, quarters));
  };
  const auto one_of = [](double y, double low_m, double high_m) {
    return static_cast<int>(y * 100) % 10 < 5 ? low_m : high_m;
  };
  const Viewpoint afar{0.0f, 0.0f, 1.0f}, near_by{0.8f, 1.2f, 1.0f};
  const auto down = [](double x, double) { return x < 1.4 ? 0.0 : x < 1.7 ? -0.1 - 0.4 * (x - 1.55) : -0.2; };
  CHECK(borne_turned(afar, down) == 2);  // a veil
  CHECK(borne_turned(near_by, down) == 3);
  CHECK(borne_turned({0.8f, 1.2f, 1.0f, 2.4f, 2.4f}, down) == 2);  // seen from afar
  CHECK(borne_turned(afar, [](double x, double y) {                // oblique
          const double d = x + y;
          return d < 2.0 ? 0.0 : d < 2.35 ? -0.1 - 0.36 * (d - 2.175) : -0.2;
        }) == 2);
  CHECK(borne_turned({0.0f, 1.2f, 1.0f}, [](double x, double y) {  // around the laser
          const double r = std::hypot(x, y - 1.2);
          return r < 1.4 ? 0.0 : r < 1.7 ? -0.15 - 0.5 * (r - 1.55) : -0.3;
        }) == 2);
  for (const double lean : {0.2, 0.0}) {  // a fringe, a pavement
    CHECK(borne_turned(afar, [=](double x, double y) {
            if (x >= 1.2) return 0.5 + 0.6 * (x - 1.2) + one_of(y, -0.5, 0.5);
            return x < 1.0 ? 0.0 : (lean > 0.0 ? 0.04 : 0.08) + lean * (x - 1.1);
          }) == (lean > 0.0 ? 1 : 2));
  }
  for (const double post_m : {0.9, 1.2}) {  // beside a curb's face
    CHECK(borne_turned(afar, [=](double x, double y) {
            if (x >= post_m && x < post_m + 0.2 && y >= 0.5 && y < 0.7) return one_of(y, 0.5, 2.0);
            return x < 1.15 ? 0.0 : 0.06;
          }) == 2);
  }
  CHECK(borne_turned({0.0f, 1.2f, 1.0f}, [](double x, double) {  // a platform under the robot
          return x < 0.6 ? std::nan("") : x < 0.9 ? 0.28 : 0.0;
        }) == 2);
}

//  ______                       _
//        |      __        _____| `-|
//        |_`-__|                   |____       lower than the road behind it: a gutter; higher than the pavement: a
//                                              curb stone
TEST_CASE("ground: what lies in the shadow of a step down, but not between both sides, is no veil of it") {
  const auto strip = [](double z_m) {  // falls more than half as steeply as the rays
    return [=](double x, double) { return x < 1.4 ? 0.0 : x < 1.7 ? z_m - 0.4 * (x - 1.4) : -0.2; };
  };
  CHECK(label_count(strip(-0.08)) == 2);  // a veil
  CHECK(label_count(strip(-0.23)) == 3);  // a gutter
  CHECK(label_count(strip(0.15)) == 3);   // a curb stone
}

//  ______        ______
//        |_    /
//          `-_|        a channel, of which one side is in the shadow and the other steep
TEST_CASE("ground: the floor of a channel is no veil, as beyond it there is a side of the channel, not ground") {
  CHECK(label_count([](double x, double) {
          if (x < 1.4 || x >= 2.0) return 0.0;
          return x < 1.7 ? -0.1 - 0.2 * (x - 1.55) : -0.4 + 2.0 * (x - 1.7);
        }) == 3);
}

TEST_CASE("ground: a strip in the shadow of a step down is a veil however high the ground lies in the map") {
  const int quarters = GENERATE(0, 2);
  const auto down = [](double x, double) { return x < 1.4 ? 5.0 : x < 1.7 ? 4.9 - 0.4 * (x - 1.55) : 4.8; };
  const auto seen_from = [&](float z_m) {
    return label_count_from(turned({0.0f, 0.0f, z_m}, quarters), turned_ground(down, quarters));
  };
  CHECK(seen_from(6.0f) == 2);
  CHECK(seen_from(7.0f) == 3);  // from higher up the shadow is narrower
}

TEST_CASE("ground: a level strip in the shadow of a step down is a tread, if it is but a cell wide, too") {
  CHECK(label_count([](double x, double y) {
          const bool wider = static_cast<int>(y * 10) % 3 == 0;
          return x < 1.4 ? 0.0 : x < 1.5 || (wider && x < 1.6) ? -0.1 : -0.2;
        }) == 3);
}

TEST_CASE("ground: a step that the laser is straight above has no shadow") {
  const auto down = [](double x, double) { return x < 1.4 ? 0.0 : x < 1.7 ? -0.1 : -0.2; };
  CHECK(label_count_from({1.55f, 1.2f, 1.0f}, down) == 3);
}

//  ________
//             \\         what separates a strip from the planes beside it is not seen
//                 .
//                     _____
TEST_CASE("ground: between sparse scan lines a veil is one up to five cells from a step's sides") {
  const auto apart = [](double before_m, double behind_m) {
    return [=](double x, double) {
      if (x > 1.4 - before_m && x < 1.4) return std::nan("");
      if (x > 1.7 && x < 1.7 + behind_m) return std::nan("");
      return x < 1.4 ? 0.0 : x < 1.7 ? -0.1 - 0.4 * (x - 1.55) : -0.2;
    };
  };
  CHECK(label_count(apart(0.1, 0.1)) == 2);
  CHECK(label_count(apart(0.4, 0.0)) == 2);
  CHECK(label_count(apart(0.0, 0.4)) == 2);
  CHECK(label_count(apart(0.5, 0.0)) == 3);
  CHECK(label_count(apart(0.0, 0.5)) == 3);
}

TEST_CASE("ground: an uneven row at the window's end is no face: what lies beyond it is not known") {
  const auto row = [](bool first) {
    return [=](double x, double y) {
      return (first ? x < 0.1 : x > 2.3) ? 0.06 + (static_cast<int>(y * 100) % 10 < 5 ? -0.02 : 0.02) : 0.12;
    };
  };
  CHECK(label_count(row(true)) == 2);
  CHECK(label_count(row(false)) == 2);
}

TEST_CASE("ground: on a street that leans, too, a pavement before a wall is no fringe of it") {
  CHECK(label_count([](double x, double y) {
          const double street_m = 0.08 * x + 0.08 * y;
          if (x >= 1.2) return 0.7 + (static_cast<int>(y * 100) % 10 < 5 ? -0.5 : 0.5);
          return x < 1.0 ? street_m : street_m + 0.08;
        }) == 2);
}

//             |
//          __ |           a ledge before a wall, 20 cm deep; the ground before it is not seen
//  ______     |
TEST_CASE("ground: level readings on a wall, higher than any curb, are assigned to the ground") {
  const auto ledge = [](double ledge_m) {
    return [=](double x, double y) {
      if (x >= 1.2) return 0.5 + (static_cast<int>(y * 100) % 10 < 5 ? -0.5 : 0.5);
      return x < 0.8 ? 0.0 : x < 1.0 ? std::nan("") : ledge_m;
    };
  };
  CHECK(label_count(ledge(0.4)) == 1);
  CHECK(label_count(ledge(0.25)) == 2);
}

TEST_CASE("ground: a strip that does not touch an obstacle is no fringe of it") {
  const auto one_of = [](double y) { return static_cast<int>(y * 100) % 10 < 5 ? 0.0 : 1.2; };
  const auto before = [=](double gap_m) {
    return [=](double x, double y) {
      if (x >= 1.2 + gap_m) return one_of(y);
      return x >= 1.2 ? std::nan("") : x < 1.0 ? 0.0 : 0.04 + 0.2 * (x - 1.1);
    };
  };
  const auto behind = [=](double gap_m) {
    return [=](double x, double y) {
      if (x < 1.0 - gap_m) return one_of(y);
      return x < 1.0 ? std::nan("") : x > 1.2 ? 0.0 : 0.04 - 0.2 * (x - 1.1);
    };
  };
  CHECK(label_count(before(0.0)) == 1);
  CHECK(label_count(before(0.1)) == 2);
  CHECK(label_count_from({2.4f, 0.0f, 1.0f}, behind(0.0)) == 1);
  CHECK(label_count_from({2.4f, 0.0f, 1.0f}, behind(0.1)) == 2);
}

TEST_CASE("ground: of a cloud whose origin lies on the ground a fringe is left to it, too") {
  CHECK(label_count(
            [](double x, double y) {
              if (x >= 1.2) return 0.5 + (static_cast<int>(y * 100) % 10 < 5 ? -0.5 : 0.5);
              return x < 1.0 ? 0.0 : 0.04 + 0.2 * (x - 1.1);
            },
            0.0f) == 1);
}

TEST_CASE("ground: what falls half as steeply as the rays from any height may be a veil, a flatter slope is none") {
  const auto falls = [](double slope) {
    return [=](double x, double) { return x < 1.4 ? 0.0 : x < 1.7 ? -slope * (x - 1.4) : std::nan(""); };
  };
  for (const double laser_m : {0.7, 1.0, 2.0}) {
    const double rays = laser_m / 1.4;
    CHECK(may_be_veil({0.0f, 1.2f, static_cast<float>(laser_m)}, 1.55, 1.25, falls(0.65 * rays)));
    CHECK_FALSE(may_be_veil({0.0f, 1.2f, static_cast<float>(laser_m)}, 1.55, 1.25, falls(0.35 * rays)));
  }
}

//  ____
//      ----____        40 cm: as long as the spot and the shadow of its own fall, longer than the spot alone
TEST_CASE("ground: a slope that is no longer than the shadow of its own fall is no blurred edge for that") {
  CHECK_FALSE(may_be_veil({1.2f, -3.3f, 1.3f}, 1.25, 1.45, [](double, double y) {
    return y < 1.2 ? 0.0 : y < 1.6 ? -0.135 * (y - 1.2) : -0.054;
  }));
}

TEST_CASE("ground: from afar, too, a slope that is no steeper than a ramp is no blurred edge") {
  const auto falls = [](double slope) {
    return may_be_veil({1.2f, -5.0f, 2.0f}, 1.25, 1.75, [=](double, double y) {
      return y < 1.6 ? 0.0 : y > 1.9 ? std::nan("") : -slope * (y - 1.6);
    });
  };
  CHECK(falls(0.14));
  CHECK_FALSE(falls(0.11));
}

TEST_CASE("ground: a strip before a wall that leans by more than 1 in 20 is a fringe and covers the ground") {
  const auto covered = [](const Viewpoint& view, double lean) {
    Stages<small_limits> stages(small_settings());
    stages.view = view;
    fill(stages.dem, [=](double x, double y) {
      if (x >= 1.2) return 0.5 + (static_cast<int>(y * 100) % 10 < 5 ? -0.5 : 0.5);
      return x < 0.9 ? 0.0 : 0.05 + lean * (x - 1.05);
    });
    stages.settle();
    REQUIRE(stages.mixture.region_label(stages.dem.slot(10, 12)) != no_label);
    return stages.mixture.covered(stages.dem.slot(10, 12));
  };
  const Viewpoint before{0.0f, 1.2f, 1.0f}, low{0.0f, 1.2f, 0.31f};
  CHECK(covered(before, 0.063));
  CHECK_FALSE(covered(before, 0.038));
  CHECK(covered(before, 0.2));
  CHECK(covered(low, -0.11));          // falls as the rays do, but no more steeply than a ramp
  CHECK_FALSE(covered(before, -0.5));  // a veil, which shows where an edge lies
}

//   ||
//   ||  ....          the ground that a wall hides is not seen
//  _||______
TEST_CASE("ground: a wall, whatever way it runs, is left to the ground, also if nothing is seen behind it") {
  const int quarters = GENERATE(0, 1, 2, 3);
  const auto wall = [=](double hidden_m) {
    return label_count_from(turned({0.0f, 1.2f, 1.0f}, quarters), turned_ground(
                                                                      [=](double x, double) {
                                                                        if (x > 1.2 && x < 1.2 + hidden_m)
                                                                          return std::nan("");
                                                                        return x > 0.9 && x < 1.2 ? 0.28 : 0.0;
                                                                      },
                                                                      quarters));
  };
  CHECK(wall(0.0) == 2);
  CHECK(wall(0.4) == 2);
}

TEST_CASE("ground: a block is no obstacle if a robot has room on it, if it leans, or if it goes on beyond the window") {
  const auto block = [](double height_m, double from_x_m, double size_m, double lean = 0.0) {
    return [=](double x, double y) {
      const bool on_it = x > from_x_m && x < from_x_m + size_m && y > 0.6 && y < 0.6 + size_m;
      return on_it ? height_m + lean * (x - from_x_m) : 0.0;
    };
  };
  CHECK(label_count(block(0.28, 0.6, 0.9)) == 1);
  CHECK(label_count(block(0.28, 0.6, 1.1)) == 2);  // more than a square metre
  CHECK(label_count(block(0.28, 0.6, 0.8, 0.2)) == 2);
  for (const int quarters : {0, 1, 2, 3}) {
    CHECK(label_count(turned_ground(block(0.28, 1.8, 1.1), quarters), 3.0f) == 2);
    CHECK(label_count(turned_ground(block(0.28, 1.8, 0.9), quarters), 3.0f) == 1);
  }
}

//        ___ . . .
//   ____|     . . .        the same in the middle of the window, of which the laser has not seen more yet
TEST_CASE("ground: raised ground is no obstacle as long as the laser has not seen it end") {
  const auto raised = [](double seen_to_m) {
    return [=](double x, double y) {
      if (x > seen_to_m) return std::nan("");
      return x > 0.8 && x < 1.6 && y > 0.6 && y < 1.8 ? 0.28 : 0.0;
    };
  };
  for (const int quarters : {0, 1, 2, 3}) {
    CHECK(label_count(turned_ground(raised(1.6), quarters), 3.0f) == 2);
    CHECK(label_count(turned_ground(raised(1.9), quarters), 3.0f) == 1);
  }
}

//              _____
//     _  _    |           two boxes of about the same height lead nowhere; beside a platform they are low steps on it
//  __| || |___|
TEST_CASE("ground: boxes beside each other are obstacles, low steps on a platform are ways") {
  const auto steps = [](double platform_m) {
    return [=](double x, double y) {
      if (y < 1.2 || y > 1.7) return x > 1.8 ? platform_m : 0.0;
      if (x > 1.4 && x < 1.8) return 0.28;
      return x > 0.9 && x < 1.4 ? 0.35 : x > 1.8 ? platform_m : 0.0;
    };
  };
  CHECK(label_count(steps(0.0)) == 1);
  CHECK(label_count(steps(0.22)) == 4);
}

TEST_CASE("ground: the next step of a stair may lie behind a face of two cells, whatever way the stair goes") {
  const int quarters = GENERATE(0, 1, 2, 3);
  const auto steps = [](double face_m) {
    return [=](double x, double y) {
      if (x < 0.9 || y < 0.6 || y > 1.8) return 0.0;
      if (x > 1.8 + face_m) return std::nan("");  // not seen
      return x < 1.2 ? 0.14 : x < 1.5 ? 0.28 : x < 1.5 + face_m ? 0.0 : 0.42;
    };
  };
  CHECK(label_count_from(turned({0.0f, 0.0f, 1.0f}, quarters), turned_ground(steps(0.2), quarters)) == 4);
  CHECK(label_count_from(turned({0.0f, 0.0f, 1.0f}, quarters), turned_ground(steps(0.3), quarters)) == 2);
}

TEST_CASE("ground: a bank before rough grass that is lower than a curb is no fringe of it, before a hedge it is") {
  const auto before = [](double rough_m) {
    return [=](double x, double y) {
      if (x >= 1.2) return 0.15 + (static_cast<int>(y * 100) % 10 < 5 ? -rough_m : rough_m);
      return x < 1.0 ? 0.0 : 0.04 + 0.2 * (x - 1.1);
    };
  };
  CHECK(label_count(before(0.075)) == 3);  // together with the grass
  CHECK(label_count(before(0.1)) == 1);
}

TEST_CASE("ground: what stands on the ground is measured against the largest plane, whichever was there first") {
  Stages<small_limits> stages(small_settings());
  const auto box_and_platform = [](double x, double y) {
    if (x < 0.4) return 0.28;
    return x > 1.2 && x < 1.8 && y > 0.9 && y < 1.5 ? 0.28 : 0.0;
  };
  fill(stages.dem, [&](double x, double y) { return x < 0.4 ? box_and_platform(x, y) : std::nan(""); });
  stages.infer(true);
  const int platform = stages.label_at(2, 12);
  fill(stages.dem, [&](double x, double y) { return x < 0.4 ? std::nan("") : box_and_platform(x, y); });
  stages.settle();
  CHECK(stages.label_at(2, 12) == platform);
  REQUIRE(stages.label_at(20, 2) != platform);
  CHECK(stages.label_at(15, 12) == stages.label_at(20, 2));  // the box's cells have the road's label
}

TEST_CASE("ground: a slope that a robot can stand on is ground") {
  CHECK(label_count([](double x, double) { return x < 1.0 ? 0.0 : 0.3 * (x - 1.0); }) == 2);
}

}  // namespace
}  // namespace curbline
