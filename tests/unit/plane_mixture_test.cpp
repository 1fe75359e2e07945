// Labels of planes over time: which planes keep their label, appear or disappear, and which win when there are too
// many.
#include "curbline/planes/plane_mixture.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <set>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::Noise;
using test::Patch;
using test::small_limits;
using test::small_settings;
using test::Stages;

template <typename S, typename Height>
void add_points(S& stages, const Patch& patch, Noise& noise, Height&& height_m) {
  for (const Point& p : test::sample(patch, 0.05, 0.003, noise, height_m)) stages.dem.add(p);
}

template <typename S>
int alive(const S& stages) {
  int count = 0;
  for (int l = 0; l < stages.mixture.capacity; ++l) count += stages.mixture.plane(l).alive();
  return count;
}

TEST_CASE("plane mixture: each large region becomes a plane with its level and slopes") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  add_points(*stages, {0, 2.4, 0, 2.4}, noise, [](double x, double y) { return y < 1.2 ? 0.05 * x : 0.12 - 0.02 * y; });
  stages->infer();
  REQUIRE(alive(*stages) == 2);
  const Plane& low = stages->mixture.plane(stages->label_at(12, 3));
  const Plane& high = stages->mixture.plane(stages->label_at(12, 20));
  // 288 cells of 4 points with noise of 3 mm; the heights of cells ignore the slope within them.
  CHECK(low.height_m(1.2f, 0.6f) == Approx(0.06).margin(4 * 0.003 / std::sqrt(4 * 288.0)));
  CHECK(low.slope_x == Approx(0.05).margin(0.001));
  CHECK(high.slope_y == Approx(-0.02).margin(0.002));
  CHECK(low.cells == 288.0f);
}

//             ____     a pavement of which the window contains a strip; the cells at its edge also contain the road
//            |
//  __________|
TEST_CASE("plane mixture: cells that hold both sides of a step do not tilt the plane of a small region") {
  for (const double edge : {2.03, 2.05, 2.07}) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    Noise noise;
    for (const Point& p :
         test::sample({0, 2.4, 0, 2.4}, 0.02, 0.003, noise, [&](double x, double) { return x < edge ? 0.0 : 0.06; }))
      stages->dem.add(p);
    stages->infer();
    const Plane& strip = stages->mixture.plane(stages->mixture.region_label(stages->dem.slot(22, 12)));
    CHECK(strip.height_m(static_cast<float>(edge), 1.2f) == Approx(0.06).margin(0.002));
    CHECK(strip.slope_x == Approx(0.0).margin(0.02));
  }
}

// The corner of a pavement in the corner of the window: three of its eight cells contain nothing else, four of a longer
// one.
TEST_CASE("plane mixture: few cells tell the plane of a corner, if one is sure to hold nothing else") {
  const auto corner = [](double pitch_m, double from_y_m = 2.05) {
    auto stages = std::make_unique<Stages<>>(small_settings());
    Noise noise;
    const auto ground = [=](double x, double y) { return x < 2.25 || y < from_y_m ? 0.0 : 0.06; };
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, pitch_m, 0.003, noise, ground)) stages->dem.add(p);
    stages->infer();
    return stages->mixture.plane(stages->mixture.region_label(stages->dem.slot(23, 22)));
  };
  const Plane told = corner(0.02);
  CHECK(told.cells == 3.0f);
  CHECK(told.height_m(2.25f, 2.2f) == Approx(0.06).margin(0.003));
  CHECK(square(told.slope_x) + square(told.slope_y) < square(least_ramp));
  CHECK(corner(0.05).cells > 3.0f);  // four points of a cell may be on one side by chance
  CHECK(corner(0.05, 1.95).cells == 4.0f);
}

//               .:'.    a pavement overgrown with grass, of which the window contains a strip
//              |
//  ____________|
TEST_CASE("plane mixture: ground that is rough all over is told by all of its cells, not by the few that look even") {
  double squares_m2 = 0.0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    Noise noise(seed);
    const auto ground = [&](double x, double) { return x < 2.0 ? 0.0 : 0.08 + 0.03 * noise.normal(); };
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.003, noise, ground)) stages->dem.add(p);
    stages->infer();
    const Plane& strip = stages->mixture.plane(stages->mixture.region_label(stages->dem.slot(22, 12)));
    CHECK(strip.cells > 80.0f);  // of 96
    CHECK(strip.rough_m2 == Approx(0.03 * 0.03).epsilon(0.2));
    squares_m2 += square(strip.height_m(2.2f, 1.2f) - 0.08f);
  }
  // From 96 cells with 25 points each.
  CHECK(squares_m2 / 20.0 < 2.0 * 0.03 * 0.03 / (96 * 25));
}

TEST_CASE("plane mixture: what holds both sides of a step makes no ground rough") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  for (const Point& p :
       test::sample({0, 2.4, 0, 2.4}, 0.02, 0.003, noise, [](double x, double) { return x < 2.05 ? 0.0 : 0.06; }))
    stages->dem.add(p);
  stages->infer();
  CHECK(stages->mixture.plane(stages->mixture.region_label(stages->dem.slot(22, 12))).rough_m2 == 0.0f);
  CHECK(stages->mixture.plane(stages->mixture.region_label(stages->dem.slot(4, 12))).rough_m2 == 0.0f);
}

TEST_CASE("plane mixture: of a strip that a step crosses aslant nothing is taken for roughness") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  const auto ground = [](double x, double y) { return x < 2.2 + 0.1 * y ? 0.0 : 0.05; };
  for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.003, noise, ground)) stages->dem.add(p);
  stages->infer();
  int strips = 0;
  for (int l = 0; l < small_limits.planes; ++l) {
    const Plane& plane = stages->mixture.plane(l);
    strips += plane.alive() && plane.x_m > 2.3f;
    CHECK(plane.rough_m2 < 1e-6f);
  }
  CHECK(strips > 0);
}

//  o
//  ____________
//              |_       the first of two rows behind the edge: too high, because of readings that mix it and the road
//                |__
TEST_CASE("plane mixture: what lies too high beside a step down does not tilt the strip behind") {
  const auto strip_seen_from = [](float x_m) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    fill(stages->dem, [](double x, double) { return x < 2.2 ? 0.06 : x < 2.3 ? 0.016 : 0.0; });
    stages->view.x_m = x_m;
    stages->infer();
    return stages->mixture.plane(stages->mixture.region_label(stages->dem.slot(23, 12)));
  };
  const Plane behind = strip_seen_from(0.0f), before = strip_seen_from(3.0f);
  CHECK(before.slope_x == Approx(-0.16).margin(0.01));
  CHECK(std::abs(behind.slope_x) < 0.08f);
  CHECK(behind.height_m(2.35f, 1.2f) == Approx(0.0).margin(0.004));
  CHECK(behind.height_variance_m2(2.25f, 1.2f) > 2.0f * behind.height_variance_m2(2.35f, 1.2f));
}

TEST_CASE("plane mixture: cells that bear another plane do not tilt their region's if they lie nearer to that one") {
  const auto tilt_where_the_last_row_lies = [](double z_m) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    const auto ground = [=](double x, double) { return x < 1.1 ? 0.0 : x < 1.2 ? z_m : 0.025; };
    fill(stages->dem, ground, 0.008);
    stages->infer(true);
    const auto low = stages->mixture.region_label(stages->dem.slot(4, 12)),
               high = stages->mixture.region_label(stages->dem.slot(20, 12));
    REQUIRE(low != high);
    REQUIRE(stages->mixture.region_label(stages->dem.slot(11, 12)) == low);
    stages->dem.add({0.05f, 0.05f, 0.0f, 1e-4f});
    stages->segment();
    stages->mixture.update(
        stages->dem, *stages->segmented, stages->view, {},
        [&](int slot) { return slot / small_settings().window.cols < 11 ? low : high; }, stages->counters);
    return stages->mixture.plane(low).slope_x;
  };
  CHECK(tilt_where_the_last_row_lies(0.014) < 0.001f);
  CHECK(tilt_where_the_last_row_lies(0.011) > 0.003f);  // nearer to the plane of its region: the label will follow
}

/// Of the ground from row 12 to 15, once labels have settled: is it ground, in a finished map in which its first row
/// has the label of the plane before it? REQUIREs that it has a plane, and is ground when that row has its own label.
template <typename Height>
bool is_ground_without_first_row(Stages<>& stages, Height&& height_m) {
  stages.view = {0.0f, 1.2f, 1.0f};
  fill(stages.dem, height_m);
  stages.settle();
  const auto region_in = [&](int i) { return stages.mixture.region_label(stages.dem.slot(i, 12)); };
  const Label before = region_in(4), strip = region_in(14), beyond = region_in(20);
  REQUIRE(before != strip);
  REQUIRE(region_in(12) == strip);
  const auto refine = [&](int first_row) {
    stages.mixture.refine(stages.dem, stages.view, {}, [&](int slot) {
      const int row = slot / small_settings().window.cols;
      return row < first_row ? before : row < 16 ? strip : beyond;
    });
  };
  refine(12);
  REQUIRE(stages.mixture.ground(strip));
  refine(13);
  return stages.mixture.ground(strip);
}

//            |                               ______
//            |
//         __/        bank before a wall      .:.:        rough verge between road and pavement
//  ______/                             _____
TEST_CASE("plane mixture: in a finished map what labels leave of a bank before a wall may be a fringe of it") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  const auto bank = [](double x, double y) {
    if (x >= 1.6) return static_cast<int>(y * 100) % 10 < 5 ? 0.2 : 1.2;
    return x < 1.2 ? 0.0 : 0.2 * (x - 1.2);
  };
  CHECK_FALSE(is_ground_without_first_row(*stages, bank));
  const auto slot = [&](int i) { return stages->dem.slot(i, 12); };
  CHECK(stages->mixture.covered(slot(14)));
  CHECK_FALSE(stages->mixture.covered(slot(12)));
  CHECK(stages->mixture.region_label(slot(12)) == stages->mixture.region_label(slot(4)));
}

TEST_CASE("plane mixture: in a finished map three rows that labels leave of a rough verge are no face of a curb") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  const auto verge = [](double x, double y) {
    if (x < 1.2 || x >= 1.6) return x < 1.2 ? 0.0 : 0.12;
    return (x < 1.3 ? 0.02 : 0.06) + (static_cast<int>(y * 100) % 10 < 5 ? -0.026 : 0.026);
  };
  CHECK(is_ground_without_first_row(*stages, verge));
}

TEST_CASE("plane mixture: a face whose cells all spread is fitted all the same") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.02, noise, [](double x, double) { return 0.8 * x; }))
    stages->dem.add(p);
  stages->infer();
  const Plane& plane = stages->mixture.plane(stages->mixture.region_label(stages->dem.slot(12, 12)));
  CHECK(plane.slope_x == Approx(0.8).margin(0.01));
  CHECK(plane.cells > 0.0f);
}

TEST_CASE("plane mixture: labels stay with their planes while regions grow") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  const auto ground = [](double x, double y) { return y < 0.8 ? 0.0 : y < 1.6 ? 0.12 : 0.06 + 0.05 * x; };
  add_points(*stages, {0, 0.4, 0, 2.4}, noise, ground);
  stages->infer();
  const auto a = stages->label_at(1, 2), b = stages->label_at(1, 12), c = stages->label_at(1, 22);
  REQUIRE(std::set<int>{a, b, c}.size() == 3);
  for (int row = 4; row < 24; ++row) {
    const double x = 0.1 * row;
    add_points(*stages, {x, x + 0.1, 0, 2.4}, noise, ground);
    stages->infer();
    CHECK(stages->label_at(1, 2) == a);
    CHECK(stages->label_at(1, 12) == b);
    CHECK(stages->label_at(1, 22) == c);
  }
  CHECK(stages->label_at(23, 2) == a);
  CHECK(stages->label_at(23, 12) == b);
  CHECK(stages->label_at(23, 22) == c);
}

TEST_CASE("plane mixture: a region takes the label that most of its cells bore") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  stages->segment();
  // In the lower region 5 rows had label 0 and 7 rows label 3; in the upper one all had label 0.
  std::array<int, decltype(stages->dem)::capacity> old{};
  for (int i = 5; i < 12; ++i) {
    for (int j = 0; j < 24; ++j) old[static_cast<std::size_t>(stages->dem.slot(i, j))] = 3;
  }
  stages->mixture.update(
      stages->dem, *stages->segmented, stages->view, {},
      [&](int slot) { return static_cast<Label>(old[static_cast<std::size_t>(slot)]); }, stages->counters);
  CHECK(stages->mixture.region_label(stages->dem.slot(0, 0)) == 3);
  CHECK(stages->mixture.region_label(stages->dem.slot(23, 0)) == 0);
}

TEST_CASE("plane mixture: a plane is born with a fresh label and keeps those of others") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  add_points(*stages, {0, 1.2, 0, 2.4}, noise, [](double, double) { return 0.0; });
  stages->infer();
  const int first = stages->label_at(0, 0);
  CHECK(stages->mixture.fresh(first));
  add_points(*stages, {1.2, 2.4, 0, 2.4}, noise, [](double, double) { return 0.12; });
  stages->infer();
  const int second = stages->label_at(23, 0);
  CHECK(second != first);
  CHECK(stages->label_at(0, 0) == first);
  CHECK(stages->mixture.fresh(second));
  CHECK_FALSE(stages->mixture.fresh(first));
  CHECK(stages->mixture.relabelled(stages->dem.slot(23, 0)));
  CHECK_FALSE(stages->mixture.relabelled(stages->dem.slot(0, 0)));
  CHECK(stages->mixture.region_label(stages->dem.slot(23, 0)) == second);
}

TEST_CASE("plane mixture: a plane whose cells still wait for their labels is not born again") {
  Settings settings = small_settings();
  settings.labels.max_messages = 400;
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  stages->infer();
  REQUIRE(stages->counters.cells_deferred > 0);
  stages->infer();
  for (int l = 0; l < stages->mixture.capacity; ++l) CHECK_FALSE(stages->mixture.fresh(l));
}

TEST_CASE("plane mixture: a plane dies when two become one, and its label is told as fresh") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  // Two patches out of reach of each other until the ground between them is seen.
  const auto flat = [](double, double) { return 0.0; };
  add_points(*stages, {0, 0.6, 0, 2.4}, noise, flat);
  add_points(*stages, {1.7, 2.4, 0, 2.4}, noise, flat);
  stages->infer();
  REQUIRE(alive(*stages) == 2);
  add_points(*stages, {0.6, 1.7, 0, 2.4}, noise, flat);
  stages->infer(true);
  REQUIRE(alive(*stages) == 1);
  const int survivor = stages->label_at(0, 0), dead = 1 - survivor;
  CHECK(stages->mixture.plane(survivor).alive());
  CHECK_FALSE(stages->mixture.fresh(survivor));
  CHECK(stages->mixture.fresh(dead));
  for (int i = 0; i < 24; ++i) CHECK(stages->label_at(i, 12) == survivor);
}

TEST_CASE("plane mixture: regions smaller than the bound are no planes") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  add_points(*stages, {0, 1.2, 0, 1.2}, noise, [](double, double) { return 0.0; });
  add_points(*stages, {1.2, 1.5, 0, 0.1}, noise, [](double, double) { return 0.5; });    // three cells
  add_points(*stages, {1.8, 2.0, 1.8, 2.0}, noise, [](double, double) { return 0.5; });  // four
  stages->infer();
  CHECK(alive(*stages) == 2);
  CHECK(stages->mixture.region_label(stages->dem.slot(13, 0)) == no_label);
  CHECK(stages->mixture.region_label(stages->dem.slot(18, 18)) != no_label);
}

TEST_CASE("plane mixture: with more regions than planes the largest win and the others are counted") {
  constexpr Limits two{.rows = 24, .cols = 24, .planes = 2};
  const auto stages = std::make_unique<Stages<two>>(small_settings());
  // Strips across the window, each 20 cm higher than the one before, with these numbers of rows.
  const std::array<int, 4> rows = GENERATE(std::array{4, 5, 6, 9}, std::array{9, 4, 6, 5}, std::array{9, 6, 5, 4});
  const auto strip = [&](double x_m) {
    int k = 0;
    for (double left_m = x_m; left_m > 0.1 * rows.at(static_cast<std::size_t>(k)); ++k)
      left_m -= 0.1 * rows.at(static_cast<std::size_t>(k));
    return k;
  };
  fill(stages->dem, [&](double x, double) { return 0.2 * strip(x); });
  stages->segment();
  stages->mix();
  CHECK(stages->counters.planes_full == 2);
  CHECK(alive(*stages) == 2);
  for (int i = 0; i < 24; ++i) {
    const float x_m = 0.1f * static_cast<float>(i) + 0.05f;
    const int k = strip(static_cast<double>(x_m));
    const Label label = stages->mixture.region_label(stages->dem.slot(i, 0));
    REQUIRE((label != no_label) == (rows.at(static_cast<std::size_t>(k)) >= 6));
    if (label != no_label) CHECK(stages->mixture.plane(label).height_m(x_m, 1.2f) == Approx(0.2 * k).margin(1e-3));
  }
}

TEST_CASE("plane mixture: when the window moves planes move against it") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double x, double y) { return 0.1 * x - 0.05 * y; });
  stages->infer();
  const int label = stages->label_at(0, 0);
  const float before = stages->mixture.plane(label).height_m(1.0f, 1.0f);
  stages->mixture.shift(0.4f, -0.8f);
  CHECK(stages->mixture.plane(label).height_m(1.0f - 0.4f, 1.0f + 0.8f) == Approx(before).margin(1e-6));
}

TEST_CASE("plane mixture: the M-step fits planes to cells by their responsibilities") {
  Settings settings = small_settings();
  settings.planes.update = PlaneUpdate::responsibilities;
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  stages->infer(true);
  const int low = stages->label_at(0, 0), high = stages->label_at(23, 0);
  REQUIRE(low != high);
  // A quarter of the responsibility for half of the upper plane's cells goes to the lower one.
  stages->mixture.maximise(stages->dem, [&](int i, int j, auto&& visit) {
    if (i < 12) return visit(low, 1.0f);
    const float share = j < 12 ? 0.25f : 0.0f;
    if (share > 0.0f) visit(low, share);
    visit(high, 1.0f - share);
  });
  // The mean of 288 cells at 0 and 144 quarters at 0.12.
  const Plane& plane = stages->mixture.plane(low);
  CHECK(plane.z_m == Approx(0.12 * 36.0 / 324.0).margin(1e-5));
  CHECK(plane.cells == Approx(324.0f));
  CHECK(stages->mixture.plane(high).z_m == Approx(0.12).margin(1e-5));
  CHECK(stages->mixture.plane(high).cells == Approx(252.0f));
}

TEST_CASE("plane mixture: ground is as rough to the M-step as to its region") {
  Settings settings = small_settings();
  settings.planes.update = PlaneUpdate::responsibilities;
  const auto stages = std::make_unique<Stages<>>(settings);
  Noise noise;
  const auto ground = [&](double, double) { return 0.03 * noise.normal(); };
  for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.003, noise, ground)) stages->dem.add(p);
  stages->infer(true);
  const int label = stages->label_at(0, 0);
  const float rough_m2 = stages->mixture.plane(label).rough_m2;
  stages->mixture.maximise(stages->dem, [&](int, int, auto&& visit) { visit(label, 1.0f); });
  CHECK(rough_m2 > 0.0f);
  CHECK(stages->mixture.plane(label).rough_m2 == rough_m2);
}

TEST_CASE("plane mixture: the same share of every cell leaves a plane and its noise as they are") {
  Settings settings = small_settings();
  settings.planes.update = PlaneUpdate::responsibilities;
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(
      stages->dem, [](double x, double) { return 0.1 * x; }, 0.02);
  stages->infer(true);
  const int label = stages->label_at(0, 0);
  const auto variance = [&](float share) {
    stages->mixture.maximise(stages->dem, [&](int, int, auto&& visit) { visit(label, share); });
    return stages->mixture.plane(label).variance_m2;
  };
  const float whole = variance(1.0f);
  CHECK(whole > 1.5f * settings.planes.prior.noise_m2);
  CHECK(variance(0.3f) == Approx(whole).epsilon(1e-3));
}

TEST_CASE("plane mixture: parameters from responsibilities are not overwritten by the regions") {
  Settings settings = small_settings();
  settings.planes.update = PlaneUpdate::responsibilities;
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double, double) { return 0.0; });
  stages->infer(true);
  const int label = stages->label_at(0, 0);
  stages->mixture.maximise(stages->dem, [&](int i, int, auto&& visit) { visit(label, i < 12 ? 1.0f : 0.5f); });
  const float before = stages->mixture.plane(label).x_m;
  CHECK(before < 1.2f);
  stages->infer(true);
  CHECK(stages->mixture.plane(label).x_m == before);
}

TEST_CASE("plane mixture: a plane that hardly a cell answers for keeps its parameters") {
  Settings settings = small_settings();
  settings.planes.update = PlaneUpdate::responsibilities;
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double, double) { return 0.3; });
  stages->infer(true);
  const int label = stages->label_at(0, 0);
  stages->mixture.maximise(stages->dem,
                           [&](int i, int j, auto&& visit) { visit(label, i == 0 && j == 0 ? 1.0f : 0.0f); });
  CHECK(stages->mixture.plane(label).z_m == Approx(0.3).margin(1e-4));
}

TEST_CASE("plane mixture: the largest ground is no wall, however large, and whichever plane was there first") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  CHECK_FALSE(stages->mixture.largest_ground().alive());
  const auto ground = [](double x, double y) {
    if (x > 1.2) return 0.5 + (static_cast<int>(y * 100) % 10 < 5 ? -0.5 : 0.5);
    return y < 0.4 ? 0.12 : 0.0;
  };
  fill(stages->dem, [&](double x, double y) { return y < 0.4 ? ground(x, y) : std::nan(""); });
  stages->infer(true);
  CHECK(stages->mixture.largest_ground().z_m == Approx(0.12).margin(0.005));
  fill(stages->dem, [&](double x, double y) { return y < 0.4 ? std::nan("") : ground(x, y); });
  stages->infer(true);
  CHECK(stages->mixture.largest_ground().z_m == Approx(0.0).margin(0.005));
  CHECK(stages->mixture.largest_ground().cells > 200.0f);
}

TEST_CASE("plane mixture: something stands where a box's level top is, and where heights spread, not on a curb") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double x, double y) {
    if (x > 0.9 && x < 1.5 && y > 0.9 && y < 1.5) return 0.28;
    if (x > 1.8 && x < 2.0 && y > 0.4 && y < 0.6) return static_cast<int>(y * 100) % 10 < 5 ? 0.0 : 0.3;
    return y < 1.8 ? 0.0 : 0.12;
  });
  stages->settle();
  const auto obstructed = [&](int i, int j) { return stages->mixture.obstructed(stages->dem, stages->dem.slot(i, j)); };
  CHECK(obstructed(12, 12));
  CHECK(obstructed(18, 4));
  CHECK_FALSE(obstructed(12, 20));
  CHECK_FALSE(obstructed(2, 2));
}

TEST_CASE("plane mixture: what lies too high beside a step down does not tilt the strip behind, from any side") {
  const bool along_y = GENERATE(false, true), mirrored = GENERATE(false, true);
  const auto strip_seen_from = [=](double laser_m) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    fill(stages->dem, [=](double x, double y) {
      const double along = mirrored ? 2.4 - (along_y ? y : x) : (along_y ? y : x);
      return along < 2.2 ? 0.06 : along < 2.3 ? 0.016 : 0.0;
    });
    const auto at = static_cast<float>(mirrored ? 2.4 - laser_m : laser_m);
    (along_y ? stages->view.y_m : stages->view.x_m) = at;
    (along_y ? stages->view.x_m : stages->view.y_m) = 1.2f;
    stages->infer();
    const int last = mirrored ? 0 : 23;
    const Plane plane = stages->mixture.plane(
        stages->mixture.region_label(along_y ? stages->dem.slot(12, last) : stages->dem.slot(last, 12)));
    return (mirrored ? -1.0f : 1.0f) * (along_y ? plane.slope_y : plane.slope_x);
  };
  CHECK(strip_seen_from(3.0) == Approx(-0.16).margin(0.01));
  CHECK(std::abs(strip_seen_from(0.0)) < 0.08f);
}

/// A plane of this ground, after a step was said to cross the cells of row 14.
template <typename Height>
Plane with_crossed_row(Height&& height_m, int i, double spread_m = 0.002) {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, height_m, spread_m);
  stages->infer(true);
  CellSet<test::small_limits> crossed;
  for (int j = 0; j < 24; ++j) crossed.insert(stages->dem.slot(14, j));
  stages->dem.add({0.05f, 0.05f, 0.0f, 1e-4f});
  stages->segment();
  stages->mixture.update(
      stages->dem, *stages->segmented, stages->view, crossed, [&](int slot) { return stages->field.label(slot); },
      stages->counters);
  return stages->mixture.plane(stages->mixture.region_label(stages->dem.slot(i, 12)));
}

TEST_CASE(
    "plane mixture: wide planes do without the cells that a step crosses, to small ones they are one observation") {
  const auto cells_of_strip = [](double step_m) {  // of two rows, one of them crossed
    return with_crossed_row([=](double x, double) { return x < 1.4   ? 0.0
                                                           : x < 1.6 ? step_m
                                                                     : std::nan(""); }, 15)
        .cells;
  };
  for (const double step_m : {0.06, -0.06}) {
    CHECK(cells_of_strip(step_m) > 24.0f);
    CHECK(cells_of_strip(step_m) < 26.0f);
  }
  CHECK(cells_of_strip(0.03) > cells_of_strip(0.06));  // they deviate less
  CHECK(with_crossed_row([](double x, double) { return x < 1.4 ? 0.0 : 0.06; }, 20).cells == 9.0f * 24.0f);
  CHECK(with_crossed_row([](double, double) { return 0.0; }, 20).cells == 23.0f * 24.0f);
}

TEST_CASE("plane mixture: crossed cells before unseen ground or a wall do not deviate by a step") {
  CHECK(with_crossed_row([](double x, double) { return x < 1.4 || x > 1.6 ? std::nan("") : 0.0; }, 15).cells == 48.0f);
  // Nor do cells that no step crosses.
  CHECK(with_crossed_row([](double x, double) { return x < 1.5   ? 0.0
                                                       : x < 1.7 ? 0.06
                                                                 : std::nan(""); }, 15).cells ==
        48.0f);
  const auto before_wall = [](double x, double y) {
    if (x > 1.5) return static_cast<int>(y * 100) % 10 < 5 ? 0.3 : 1.3;
    return x > 1.3 ? 0.0 : std::nan("");
  };
  CHECK(with_crossed_row(before_wall, 13).cells == 48.0f);
  CHECK(with_crossed_row([](double x, double) { return x < 1.3   ? std::nan("")
                                                       : x < 1.5 ? 0.0
                                                                 : 0.06; }, 13).cells <
        26.0f);
}

TEST_CASE("plane mixture: a face, steeper than a ramp, is as well known as its points tell, ground as cells do") {
  const auto variance_m2 = [](double slope) {
    return with_crossed_row([=](double x, double) { return slope * x; }, 20, 0.012).fit_variance_m2;
  };
  CHECK(variance_m2(0.2) > 2.0f * variance_m2(0.1));
  CHECK(variance_m2(0.1) == Approx(variance_m2(0.0)).epsilon(0.2));
}

}  // namespace
}  // namespace curbline
