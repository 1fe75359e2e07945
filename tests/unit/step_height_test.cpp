// How high a curb is, and how certain that is.
#include "curbline/curbs/step_height.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "curbline/borders/border_finder.hpp"
#include "support/traced_curbs.hpp"

namespace curbline {
namespace {

using test::fill;
using test::length_m;
using test::Noise;
using test::small_limits;
using test::small_settings;
using test::Stages;
using test::total_length_m;
using test::traced;
using test::up;

/// A road, a pavement of 12 cm, and a dropped part of 6 cm that begins with a row of cells between them. In that row
/// points are added then: half of them spread_m higher, half lower.
std::unique_ptr<Stages<>> with_row_between(double spread_m) {
  auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double x, double y) { return x < 1.0 ? 0.0 : x < 1.1 || y > 1.4 ? 0.06 : 0.12; });
  stages->settle();
  for (int j = 0; j < 24; ++j) {
    CHECK(stages->label_at(10, j) == stages->label_at(20, 20));
    for (int k = 0; k < 200; ++k) {
      const double z = 0.06 + (k % 2 == 0 ? spread_m : -spread_m);
      stages->dem.add({1.05f, 0.1f * static_cast<float>(j) + 0.05f, static_cast<float>(z), 1e-4f});
    }
  }
  stages->trace();
  return stages;
}

TEST_CASE("step height: an edge is as high as its planes are apart, though its cells bear a third plane's label") {
  const auto heights_m = [](const Stages<>& stages) {
    std::vector<float> found;
    for (const Curb& c : stages.tracer.curbs()) {
      if (is_step(c) && c.y0_m + c.y1_m < 2.0f) found.push_back(c.height_m);
    }
    return found;
  };
  SECTION("readings of both sides are an edge") {
    const auto found = heights_m(*with_row_between(0.06));
    REQUIRE(found.size() == 1);
    CHECK(found[0] == Approx(0.12f).margin(0.002));
  }
  SECTION("readings at one height are a strip of that plane") {
    for (const float height_m : heights_m(*with_row_between(0.03))) CHECK(height_m == Approx(0.06f).margin(0.002));
  }
}

/// The curb between a pavement of 12 cm and a single row of cells before it, seen close to the edge alone, that hold
/// readings from low_m to high_m.
Curb before_row(double low_m, double high_m) {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  const auto add = [&](double x, double y, double z) {
    stages->dem.add({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), 1e-6f});
  };
  for (double y = 0.025; y < 2.4; y += 0.05) {
    for (double x = 1.425; x < 2.4; x += 0.05) add(x, y, 0.12);
    for (int k = 0; k < 4; ++k) add(1.39, y, low_m + (high_m - low_m) * k / 3);
  }
  stages->settle();
  stages->trace(0.0f, 1.2f);
  const auto curbs = stages->tracer.curbs();
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].kind == CurbKind::step_up);
  return curbs[0];
}

TEST_CASE("step height: as long as only part of a face is seen of one side, the step may be much higher") {
  const Curb from_face = before_row(0.074, 0.112), from_strip = before_row(0.093, 0.093);
  CHECK(from_face.height_m == Approx(0.027f).margin(0.005));
  CHECK(from_face.height_m + 2.0f * from_face.height_sd_m > 0.06f);
  CHECK(from_strip.height_m == Approx(0.027f).margin(0.005));
  CHECK(from_strip.height_m + 2.0f * from_strip.height_sd_m < 0.045f);
}

/// A step of 12 cm at x = 1.4 m; over the last 0.2 m before it the road falls by depth_m.
auto with_gutter(double depth_m) {
  return [depth_m](double x, double) { return x > 1.4 ? 0.12 : x > 1.2 ? -depth_m * (x - 1.2) / 0.2 : 0.0; };
}

/// The same window, when it has turned out that its cells share no noise but 1 mm.
auto traced_gutter(double depth_m, float robot_x_m = 0.0f, float robot_y_m = 0.0f) {
  auto stages = traced(with_gutter(depth_m), robot_x_m, robot_y_m);
  stages->dem.set_common(1e-6f, 1e-6f);
  stages->trace(robot_x_m, robot_y_m);
  return stages;
}

TEST_CASE("step height: a step from a gutter labelled as the road is as high as from its bottom") {
  const auto up = traced_gutter(0.02), down = traced_gutter(0.02, 2.3f, 1.2f);
  REQUIRE(up->tracer.curbs().size() == 1);
  REQUIRE(down->tracer.curbs().size() == 1);
  const Curb& from_road = up->tracer.curbs()[0];
  CHECK(up->label_at(13, 5) == up->label_at(0, 5));  // the gutter's cells and the road's
  CHECK(from_road.height_m == Approx(0.14).margin(4 * from_road.height_sd_m));
  CHECK(from_road.height_m > 0.135f);
  CHECK(from_road.height_sd_m < 0.005f);
  CHECK(down->tracer.curbs()[0].height_m < -0.135f);
}

TEST_CASE(
    "step height: a step from a road that falls toward it is as high as from its foot, not from what lies along it") {
  struct Fringe {
    double width_m, depth_m;
  };
  const Fringe fringe = GENERATE(Fringe{0.7, 0.014}, Fringe{0.8, 0.017}, Fringe{0.8, 0.019});
  constexpr Limits limits{.rows = 40, .cols = 40, .planes = 6, .beams = 181};
  const auto ground = [=](double x, double) {
    return x > 2.4 ? 0.12 : -fringe.depth_m * std::max(0.0, 1.0 - (2.4 - x) / fringe.width_m);
  };
  const auto stages = std::make_unique<Stages<limits>>(small_settings(40, 40));
  const float known_m2 = 1e-5f;  // as a moving robot finds it
  stages->dem.set_common(known_m2, 0.0f);
  Noise noise;
  for (const Point& p : test::sample({0, 4.0, 0, 4.0}, 0.05, 0.005, noise, ground)) stages->dem.add(p);
  stages->settle();
  stages->trace(0.0f, 2.0f);
  REQUIRE(stages->label_at(23, 20) == stages->label_at(0, 20));  // one plane
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].height_m == Approx(0.12 + fringe.depth_m).margin(0.0015));
}

TEST_CASE("step height: ground that rises toward a step, as what mixes both sides does, makes it no lower") {
  const auto stages = traced(with_gutter(-0.012));
  REQUIRE(stages->tracer.curbs().size() == 1);
  CHECK(stages->tracer.curbs()[0].height_m > 0.115f);
}

TEST_CASE("step height: cells beside the border that lie off their planes make the height less certain") {
  const auto flat = traced(up),
             worn = traced([](double x, double y) { return up(x, y) - (x > 1.5 && x < 1.7 ? 0.008 : 0.0); });
  REQUIRE(flat->tracer.curbs().size() == 1);
  REQUIRE(worn->tracer.curbs().size() == 1);
  CHECK(worn->tracer.curbs()[0].height_sd_m > 1.05f * flat->tracer.curbs()[0].height_sd_m);
}

TEST_CASE(
    "step height: a step is as high as the ground along it, though its plane holds ground of another height too") {
  // Seen from above. A lip of 7 mm, too low to separate planes, continues one side of the corner. So the plane of
  // everything that is not road lies 1.6 mm above the lower part, and 2.4 mm below the other part where that borders
  // the road.
  //   y 2.4 +------------------+
  //         |   0.127          |
  //     1.2 +----------+ . . . +
  //         |   0      | 0.12  |
  //         +----------+-------+ x 2.4
  const float known_m2 = 1e-6f;  // even ground
  Stages<> stages(small_settings());
  stages.dem.set_common(known_m2, 0.0f);
  fill(stages.dem, [](double x, double y) { return y > 1.2 ? 0.1267 : x > 1.4 ? 0.12 : 0.0; });
  stages.settle();
  stages.trace();
  REQUIRE(stages.tracer.curbs().size() == 2);
  REQUIRE(stages.label_at(20, 2) == stages.label_at(20, 20));
  for (const Curb& curb : stages.tracer.curbs()) {
    const bool along_x = std::abs(curb.x1_m - curb.x0_m) > std::abs(curb.y1_m - curb.y0_m);
    CHECK(std::abs(curb.height_m - (along_x ? 0.1267f : 0.12f)) < (along_x ? 0.0019f : 0.0008f));
  }
}

TEST_CASE("step height: a step states what its plane errs there, of two surfaces that a weak crease divides") {
  // A pavement around the corner of a road, aslant. On one side of a crease through the corner it rises by 0.5 %, too
  // little for planes of their own: the plane of both is up to 1 mm off at each of the two steps of 3 cm.
  Stages<> stages(small_settings());
  stages.dem.set_common(1e-6f, 0.0f);
  Noise noise;
  const double cos = std::cos(0.5), sin = std::sin(0.5);
  const auto ground = [&](double x, double y) {
    const double across = cos * (x - 1.2) + sin * (y - 1.2), along = cos * (y - 1.2) - sin * (x - 1.2) + 0.2;
    if (across < 0.0 && along < 0.0) return 0.0;
    return 0.03 + 0.005 * std::max(0.0, along);
  };
  for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.003, noise, ground)) stages.dem.add(p);
  stages.settle();
  stages.trace();
  REQUIRE(stages.label_at(20, 2) == stages.label_at(10, 22));
  REQUIRE(stages.tracer.curbs().size() == 2);
  for (const Curb& curb : stages.tracer.curbs()) CHECK(std::abs(curb.height_m - 0.03f) < 2.0f * curb.height_sd_m);
}

//               .:'.    grass, 3 cm rough
//  ____________|
TEST_CASE(
    "step height: a curb between a road and rough ground is told, its height less certain than beside a smooth one") {
  const auto kerb_to = [](double rough_m) {
    auto stages = std::make_unique<Stages<>>(small_settings());
    Noise noise;
    const auto ground = [&](double x, double) { return x < 1.4 ? 0.0 : 0.08 + rough_m * noise.normal(); };
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.003, noise, ground)) stages->dem.add(p);
    stages->settle();
    stages->trace();
    REQUIRE(stages->tracer.curbs().size() == 1);
    return stages->tracer.curbs()[0];
  };
  const Curb smooth = kerb_to(0.0), rough = kerb_to(0.03);
  CHECK(rough.kind == CurbKind::step_up);
  CHECK(length_m(rough) == Approx(2.4).margin(0.05));
  CHECK(rough.x0_m == Approx(1.4).margin(0.02));
  CHECK(rough.height_m == Approx(0.08).margin(2 * rough.height_sd_m));
  CHECK(smooth.height_sd_m < 0.003f);
  CHECK(rough.height_sd_m == Approx(0.03 / std::sqrt(3.0)).epsilon(0.2));
}

TEST_CASE("step height: where the cells of a side two rows wide are level with the other its plane makes no step") {
  // Settled as a step up of 18 mm. As the laser looks again, the two rows lie at a share of that; their plane has not
  // followed yet.
  const auto steps = [](double share) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : x < 1.4 ? 0.018 : std::nan(""); });
    stages->settle();
    for (int j = 0; j < 24; ++j) {
      const float y = 0.1f * static_cast<float>(j) + 0.05f, z = static_cast<float>(share * 0.018);
      for (int k = 0; k < 400; ++k) stages->dem.add({k % 2 == 0 ? 1.25f : 1.35f, y, z, 1e-4f});
    }
    stages->trace();
    return std::ranges::count_if(stages->tracer.curbs(), is_step);
  };
  CHECK(steps(0.0) == 0);
  CHECK(steps(0.2) == 0);
  CHECK(steps(0.5) == 1);  // a cell that mixes both sides is as far off its plane
  CHECK(steps(1.0) == 1);
}

//  o
//  ________
//          |  .        the ground behind the shadow is cambered, and is known less well at the edge than in its middle
//          |____.--
TEST_CASE("step height: a step down is no better known than its lower plane is at the edge, before the shadow") {
  const double edge = 1.12, drop = 0.232, behind = edge + 0.284;
  int steps = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    Noise noise(seed);
    stages->view = {0.0f, 1.2f, 0.54f};
    stages->dem.set_common(1e-6f, 0.0f);
    for (int k = 0; k < 24 * 24 * 16; ++k) {
      const double x = 2.4 * noise.uniform(), y = 2.4 * noise.uniform();
      if (x >= edge && (x < behind || x > behind + 0.807)) continue;
      const double z_m = x < edge ? 0.0 : -drop + 0.0666 * (x - behind) * (x - behind);
      const double error_m = 0.0008 * noise.normal();
      stages->dem.add({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z_m + error_m), 1e-4f});
    }
    stages->settle();
    stages->trace(0.0f, 1.2f);
    for (const Curb& curb : stages->tracer.curbs()) {
      if (curb.kind != CurbKind::step_down) continue;
      const Plane& below = stages->mixture.plane(curb.far_label);
      const float x = 0.5f * (curb.x0_m + curb.x1_m), y = 0.5f * (curb.y0_m + curb.y1_m);
      CHECK(square(curb.height_sd_m) > 0.05f * below.height_variance_m2(x, y));
      ++steps;
    }
  }
  CHECK(steps > 0);
}

TEST_CASE("step height: a low step through the middle of cells is told as high as it is") {
  double rise_m2 = 0.0, along_m = 0.0;
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
    Stages<> stages(small_settings());
    Noise noise(seed);
    const auto ground = [](double x, double) { return x < 1.25 ? 0.0 : 0.02; };
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.02, 0.008, noise, ground)) stages.dem.add(p);
    for (int pass = 0; pass < 4; ++pass) {
      stages.infer(true);
      stages.trace();
      stages.dem.add({0.05f, 0.05f, 0.0f, 1e-4f});  // some cell must be touched, otherwise planes stay as they are
    }
    for (const Curb& c : stages.tracer.curbs()) {
      rise_m2 += length_m(c) * c.height_m;
      along_m += length_m(c);
    }
  }
  CHECK(rise_m2 / along_m == Approx(0.02).margin(0.0003));
}

TEST_CASE("step height: the height of a step is less certain where few points tell it") {
  const auto deviation_m = [](int scans) {
    Stages<> stages(small_settings());
    for (int scan = 0; scan < scans; ++scan) fill(stages.dem, up);
    stages.settle();
    stages.dem.set_common(1e-8f, 1e-3f);
    stages.trace(0.0f, 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    return stages.tracer.curbs()[0].height_sd_m;
  };
  CHECK(deviation_m(1) == Approx(2.0 * deviation_m(4)).epsilon(0.1));
}

//  ^ z            seen by upward lines  ===========
//  |   ==========  seen by downward lines, both late: the step is wrong by what both sides err
TEST_CASE("step height: between sides that opposite sweeps have seen it is as uncertain as the tilt's latency") {
  const float latency_sd_s = 0.002f;
  const auto variance_m2 = [&](float growth_below_m_s, float growth_above_m_s) {
    Stages<> stages(small_settings());
    Noise noise(1);
    for (Point p : test::sample({0.0, 2.4, 0.0, 2.4}, 0.05, 0.002, noise, up)) {
      p.growth_m_s = p.x_m < 1.4f ? growth_below_m_s : growth_above_m_s;
      stages.dem.add(p);
    }
    stages.latency.variance_s2.now = latency_sd_s * latency_sd_s;
    stages.settle();
    stages.trace(0.0f, 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    const float sd_m = stages.tracer.curbs()[0].height_sd_m;
    return static_cast<double>(sd_m * sd_m);
  };
  const double alike_m2 = variance_m2(1.0f, 1.0f), apart_m2 = variance_m2(1.0f, -1.0f);
  CHECK(alike_m2 == Approx(variance_m2(0.0f, 0.0f)).epsilon(0.01));
  CHECK(std::sqrt(apart_m2 - alike_m2) == Approx(2.0f * latency_sd_s).epsilon(0.02));
}

//  x ^   ===========   lines that run along the step see one side each        |   those that cross it see both, and
//    |   -----------   with errors of their own                           ----+---  their errors cancel
TEST_CASE("step height: a step is as uncertain as the scan lines along it, not as those that cross it") {
  struct Found {
    double errors_m2 = 0.0, told_m2 = 0.0;
  };
  const float line_sd_m = 0.001f;
  const auto found = [&](bool along) {
    Found sum;
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
      Noise noise(seed);
      std::array<double, 24> line{};
      for (double& off_m : line) off_m = static_cast<double>(line_sd_m) * noise.normal();
      Stages<> stages(small_settings());
      fill(stages.dem, [&](double x, double y) {
        return line[static_cast<std::size_t>(10.0 * x)] + ((along ? x : y) < 1.4 ? 0.0 : 0.12);
      });
      const float points = stages.dem.cell(stages.dem.slot(0, 0)).points;
      stages.dem.set_common(1e-8f, points * line_sd_m * line_sd_m);
      stages.settle();
      stages.trace(0.0f, along ? 1.2f : 0.0f);
      const double all_m = total_length_m(stages.tracer.curbs());
      REQUIRE(all_m > 2.0);
      for (const Curb& curb : stages.tracer.curbs()) {
        sum.errors_m2 += length_m(curb) / all_m * std::pow(static_cast<double>(curb.height_m) - 0.12, 2) / 40;
        sum.told_m2 += length_m(curb) / all_m * std::pow(static_cast<double>(curb.height_sd_m), 2) / 40;
      }
    }
    return sum;
  };
  const Found along = found(true), across = found(false);
  INFO("mm: along " << 1e3 * std::sqrt(along.errors_m2) << ", told " << 1e3 * std::sqrt(along.told_m2) << "; across "
                    << 1e3 * std::sqrt(across.errors_m2) << ", told " << 1e3 * std::sqrt(across.told_m2));
  CHECK(along.errors_m2 > 20.0 * across.errors_m2);
  CHECK(along.told_m2 > 0.4 * along.errors_m2);  // 0.06 if cells erred each on its own
  CHECK(along.told_m2 < 2.0 * along.errors_m2);
  CHECK(across.told_m2 < 0.1 * along.told_m2);
}

TEST_CASE("step height: of a plane of four cells, whose fit does not show it, what scan lines err is counted in full") {
  auto stages = std::make_unique<Stages<>>(small_settings());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  fill(stages->dem, [&](double x, double y) { return x < 1.2 ? 0.0 : x < 1.4 && y > 1.0 && y < 1.2 ? 0.12 : nan; });
  stages->settle();
  const auto deviation_m = [&](float line_m2) {
    stages->dem.set_common(1e-8f, line_m2);
    stages->trace(0.0f, 1.1f);
    REQUIRE(stages->tracer.curbs().size() == 1);
    return stages->tracer.curbs()[0].height_sd_m;
  };
  CHECK(deviation_m(1e-3f) > 2.0f * deviation_m(0.0f));  // if it counted as four lines or two, this would be 1.4
}

TEST_CASE("step height: between planes of different slope the height is as uncertain as its place") {
  const auto with_slope = [](double slope) {
    const auto stages = traced([=](double x, double) { return x < 1.4 ? 0.0 : 0.12 + slope * (x - 1.4); });
    REQUIRE(stages->tracer.curbs().size() == 1);
    CHECK(stages->tracer.curbs()[0].kind == CurbKind::step_up);
    return stages->tracer.curbs()[0];
  };
  const Curb level = with_slope(0.0), sloped = with_slope(0.15);
  const float by_place_m2 = sloped.height_sd_m * sloped.height_sd_m - level.height_sd_m * level.height_sd_m;
  CHECK(std::sqrt(by_place_m2) == Approx(0.15f * sloped.position_sd_m).epsilon(0.1));
}

//  ____
//      ----____        40 cm, as on the flank of a dropped curb
TEST_CASE("step height: where a slope leads from plane to plane a step's height is less certain than at a face") {
  const auto deviation_m = [](double length_m) {
    Stages<> stages(small_settings());
    stages.view = {-0.3f, 1.2f, 1.1f, 8.0f, 8.0f};  // seen from afar, too, where its spot would have blurred an edge
    fill(stages.dem,
         [=](double x, double) { return x < 1.1 ? 0.0 : -0.064 * std::min(1.0, (x - 1.1) / (length_m + 1e-9)); });
    stages.settle();
    stages.trace(-0.3f, 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    CHECK(stages.tracer.curbs()[0].height_m == Approx(-0.064).margin(0.005));
    return stages.tracer.curbs()[0].height_sd_m;
  };
  CHECK(deviation_m(0.0) < 0.005f);
  CHECK(deviation_m(0.4) > 0.02f);  // all but a cell of it may be ground
}

TEST_CASE("step height: the wider the laser's spot, the less of a slope behind a step may be ground") {
  const auto deviation_m = [](float divergence_rad) {
    Stages<> stages(small_settings());
    stages.view = {-0.3f, 1.2f, 1.1f, 8.0f, 8.0f};
    fill(stages.dem, [](double x, double) { return x < 1.1 ? 0.0 : -0.064 * std::min(1.0, (x - 1.1) / 0.4); });
    stages.settle();  // to the same planes
    stages.view.divergence_rad = divergence_rad;
    stages.trace(-0.3f, 1.2f);
    REQUIRE(stages.tracer.curbs().size() == 1);
    return stages.tracer.curbs()[0].height_sd_m;
  };
  CHECK(deviation_m(0.0f) > 1.1f * deviation_m(0.01f));
  CHECK(deviation_m(0.01f) > 1.1f * deviation_m(0.02f));
}

/// The variance that slopes add to the height of a step along y, over the length of the window, seen from x_m = 0. The
/// last borders are told to hold slopes of `sloped_cells`, and all, if the piece shall run along its borders' axis, to
/// be found along y.
float by_slopes_m2(double (*ground)(double, double), int last, float sloped_cells, bool along_axis = false) {
  const auto stages = traced(ground, 0.0f, 1.2f);
  const CurbSettings settings{};
  const Viewpoint view{0.0f, 1.2f, 1.1f};
  const CurbStages<small_limits> seen{stages->dem, stages->mixture, stages->field, view, stages->latency, settings};
  auto& borders = stages->work.curbs().borders;
  borders.clear();
  BorderFinder<small_limits>(seen).find(borders, stages->counters);
  const int length = borders.chain(stages->dem, 0, settings.link_reach);
  REQUIRE(length == 24);
  std::vector<Border> sloped;
  std::vector<Border::Index> chain;
  for (int k = 0; k < length; ++k) {
    sloped.push_back(borders.at(k));
    if (along_axis) sloped.back().axis = 1;
    chain.push_back(static_cast<Border::Index>(k));
  }
  const auto variance_m2 = [&] {
    const ChainPart part(sloped.data(), chain, {true, true});
    CurbPiece<small_limits> piece(seen, part);
    StepHeight<small_limits> height(piece);
    height.refine(true);
    return height.variance_m2();
  };
  const float at_face_m2 = variance_m2();
  for (int k = length - last; k < length; ++k) sloped[static_cast<std::size_t>(k)].sloped_cells = sloped_cells;
  return variance_m2() - at_face_m2;
}

//  road | pavement     seen from above: the piece of a curb that goes on along the slope of a dropped one
//       |____
TEST_CASE("step height: a step is as uncertain as the part of its piece that is a slope, however short") {
  const float range_m2 = 1.4f * 1.4f + 1.1f * 1.1f, face_cells = 1.0f + usual_divergence_rad * range_m2 / 1.1f / 0.1f;
  for (const int last : {3, 6, 24}) {
    const float share = static_cast<float>(last) / 24.0f * (1.0f - face_cells / 4.0f);
    CHECK(std::sqrt(3.0f * by_slopes_m2(up, last, 4.0f)) == Approx(0.12f * share).epsilon(0.02));
  }
}

TEST_CASE("step height: a piece that runs along the axis of its borders has a finite deviation") {
  CHECK(by_slopes_m2(up, 6, 4.0f, true) == 0.0f);
}

//  ______
//        |  '  .        readings that mix both sides fill the shadow, 1.8 cells wide, as if the face led through it
//        |________'__
TEST_CASE("step height: a slope no longer than the shadow of a step down is none, but readings that mix both sides") {
  const auto down = [](double x, double) { return x < 1.4 ? 0.12 : 0.0; };
  CHECK(by_slopes_m2(down, 24, 2.5f) < 1e-8f);
  CHECK(by_slopes_m2(up, 24, 2.5f) > 1e-4f);  // which casts none
  CHECK(by_slopes_m2(down, 24, 4.0f) == Approx(by_slopes_m2(up, 24, 4.0f)).epsilon(0.1));
}

//  road / flank     seen from above: the crease between a pavement and the flank of its dropped curb runs out at the
//      /___         curb, just where the laser's sight begins; a cell from the curb it is all pavement
//     /\  pavement
TEST_CASE(
    "step height: a step beside a flank's tip is less certain by what it would be lower if the flank reached it") {
  const auto into_m = [](double x, double y) { return 0.74 * (x - 1.2) - 0.67 * (y - 1.2); };
  const auto along_m = [](double x, double y) { return 0.67 * (x - 1.2) + 0.74 * (y - 1.2); };
  for (double tip_m = -1.2; tip_m < 0.0; tip_m += 0.02) {
    INFO("tip at " << tip_m);
    const auto step_m = [=](double into, double along) {
      return std::clamp(0.13 - 0.2 * (0.87 * (along - tip_m) - 0.49 * into), 0.0, 0.13);
    };
    const auto height_m = [=](double x, double y) {
      return into_m(x, y) < 0.0 ? 0.0 : step_m(into_m(x, y), along_m(x, y));
    };
    Stages<> stages(small_settings());
    Noise noise;
    for (const Point& p : test::sample({0.0, 2.4, 0.0, 2.4}, 0.01, 0.002, noise, height_m)) {
      if (p.x_m > 1.15 + 0.67 * tip_m) stages.dem.add(p);
    }
    stages.dem.set_common(1e-6f, 0.0f);
    stages.settle();
    stages.trace(0.0f, 1.2f);
    for (const Curb& curb : stages.tracer.curbs()) {
      const double x_m = 0.5 * (curb.x0_m + curb.x1_m), y_m = 0.5 * (curb.y0_m + curb.y1_m);
      if (!is_step(curb) || std::abs(into_m(x_m, y_m)) > 0.05) continue;
      CHECK(std::abs(curb.height_m) == Approx(step_m(0.0, along_m(x_m, y_m))).margin(3 * curb.height_sd_m));
    }
  }
}

TEST_CASE("step height: a step that grows along its piece is as uncertain as it grows, if the localisation steps") {
  const auto deviation_m = [](double growth, bool steps) {
    const auto stages = traced([=](double x, double y) { return x < 1.4 ? 0.0 : 0.12 + growth * (y - 1.2); });
    stages->view.localisation_steps = steps;
    stages->trace();
    REQUIRE(stages->tracer.curbs().size() == 1);
    return static_cast<double>(stages->tracer.curbs()[0].height_sd_m);
  };
  const double even_m = deviation_m(0.0, true), grows_m = deviation_m(0.008, true);
  CHECK(even_m == Approx(deviation_m(0.0, false)));
  CHECK(deviation_m(0.008, false) == Approx(even_m).epsilon(0.01));
  // Uniformly distributed within the 19.2 mm by which it grows.
  CHECK(std::sqrt(grows_m * grows_m - even_m * even_m) == Approx(0.0192 / std::sqrt(12.0)).epsilon(0.02));
}

TEST_CASE("step height: a step down is as high as its planes lie apart at its edge, not in its shadow") {
  const auto stages = traced([](double x, double) { return x < 1.4 ? 0.12 : 0.05 * (x - 1.4); });
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  REQUIRE(curb.kind == CurbKind::step_down);
  const double edge_m = 0.5 * static_cast<double>(curb.x0_m + curb.x1_m);
  CHECK(edge_m < 1.36);
  CHECK(curb.height_m == Approx(0.05 * (edge_m - 1.4) - 0.12).margin(0.001));
}

TEST_CASE("step height: the stated deviation of a height is no smaller than repeated maps show") {
  std::vector<double> heights;
  double stated = 0.0;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    Noise noise(seed);
    for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.05, 0.008, noise, up)) stages->dem.add(p);
    for (int pass = 0; pass < 2; ++pass) stages->infer(true);
    stages->trace();
    REQUIRE(stages->tracer.curbs().size() == 1);
    heights.push_back(stages->tracer.curbs()[0].height_m);
    stated += stages->tracer.curbs()[0].height_sd_m / 40.0;
  }
  double sum2 = 0.0;
  for (const double h : heights) sum2 += (h - 0.12) * (h - 0.12);
  CHECK(stated > 0.8 * std::sqrt(sum2 / 40.0));
}

TEST_CASE("step height: the variance of a step's height is that of both planes in the middle of its piece") {
  const auto stages = traced(up, 0.0f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  const double of_planes_m2 =
      static_cast<double>(stages->mixture.plane(curb.near_label).height_variance_m2(1.4f, 1.2f) +
                          stages->mixture.plane(curb.far_label).height_variance_m2(1.4f, 1.2f));
  CHECK(curb.height_sd_m > 0.99 * std::sqrt(of_planes_m2));
  CHECK(curb.height_sd_m < 1.02 * std::sqrt(of_planes_m2));  // and a little for its position: slopes differ by rounding
}

TEST_CASE("step height: between planes of different slope the height is as uncertain as its place, along y, too") {
  const auto with_slopes = [](double before, double behind) {
    const auto stages =
        traced([=](double, double y) { return y < 1.4 ? before * (y - 1.4) : 0.12 + behind * (y - 1.4); }, 1.2f, 0.0f);
    REQUIRE(stages->tracer.curbs().size() == 1);
    CHECK(stages->tracer.curbs()[0].kind == CurbKind::step_up);
    return stages->tracer.curbs()[0];
  };
  const Curb level = with_slopes(0.0, 0.0);
  for (const auto& [before, behind] : {std::pair{0.0, 0.15}, {-0.15, 0.0}, {0.1, -0.05}}) {
    const Curb sloped = with_slopes(before, behind);
    const float by_place_m2 = sloped.height_sd_m * sloped.height_sd_m - level.height_sd_m * level.height_sd_m;
    CHECK(std::sqrt(by_place_m2) == Approx(0.15f * sloped.position_sd_m).epsilon(0.1));
  }
}

TEST_CASE(
    "step height: a step down is as high as its planes lie apart at its edge, of any slope, along y, from below") {
  const auto ground = [](double, double y) { return y < 1.4 ? 0.12 + 0.06 * (y - 1.4) : 0.04 * (y - 1.4); };
  for (const float robot_y_m : {0.0f, 2.3f}) {
    auto stages = std::make_unique<Stages<>>(small_settings());
    stages->dem.look_from(1.2f, 0.0f);
    fill(stages->dem, ground);
    stages->settle();
    stages->dem.look_from(1.2f, robot_y_m);
    stages->trace(1.2f, robot_y_m);
    REQUIRE(stages->tracer.curbs().size() == 1);
    const Curb& curb = stages->tracer.curbs()[0];
    REQUIRE(curb.kind == (robot_y_m > 1.4f ? CurbKind::step_up : CurbKind::step_down));
    const double edge_m = 0.5 * static_cast<double>(curb.y0_m + curb.y1_m);
    CHECK(edge_m < 1.36);
    CHECK(std::abs(curb.height_m) == Approx(0.12 + 0.02 * (edge_m - 1.4)).margin(0.0006));
    CHECK(curb.face_width_m >= 0.0f);
  }
}

TEST_CASE("step height: ground beside a step down is carried on to the near end of the step's shadow") {
  const auto stages = traced_gutter(0.02, 2.3f, 1.2f);
  REQUIRE(stages->tracer.curbs().size() == 1);
  const Curb& curb = stages->tracer.curbs()[0];
  CHECK(curb.kind == CurbKind::step_down);
  const double edge_m = 0.5 * static_cast<double>(curb.x0_m + curb.x1_m);
  CHECK(curb.height_m == Approx(-0.12 - 0.1 * (edge_m - 1.2)).margin(0.001));
}

}  // namespace
}  // namespace curbline
