// Which planes are one bent surface, and which creases between other planes are reported.
#include "curbline/curbs/surfaces.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <set>

#include "curbline/curbs/curb_tracer.hpp"
#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::Noise;
using test::small_settings;

constexpr Limits limits{.rows = 40, .cols = 40, .planes = 8, .beams = 181};

/// A window of 4 m with this ground, as a laser sees it from the window's lowest corner.
template <typename Height>
std::unique_ptr<test::Stages<limits>> traced(Height&& height_m) {
  auto stages = std::make_unique<test::Stages<limits>>(small_settings(40, 40));
  Noise noise;
  fill(stages->dem, [&](double x, double y) { return height_m(x, y) + 0.003 * noise.normal(); });
  stages->settle();
  stages->trace();
  return stages;
}

int creases(const test::Stages<limits>& stages) {
  const auto curbs = stages.tracer.curbs();
  return static_cast<int>(std::count_if(curbs.begin(), curbs.end(), [](const Curb& curb) { return !is_step(curb); }));
}

struct Labels {
  std::set<Label> planes, surfaces;
};

/// The labels of the cells whose middle is in a part of the window.
template <typename Within>
Labels labels_of(const test::Stages<limits>& stages, Within&& within) {
  Labels out;
  for (int i = 0; i < limits.rows; ++i) {
    for (int j = 0; j < limits.cols; ++j) {
      if (!within(0.1 * (i + 0.5), 0.1 * (j + 0.5))) continue;
      out.planes.insert(stages.label_at(i, j));
      out.surfaces.insert(stages.tracer.surfaces().name(stages.label_at(i, j)));
    }
  }
  return out;
}

const auto everywhere = [](double, double) { return true; };

//      __.--.__       a road of 4 m, 5 cm higher in the middle than at its curbs, at any angle;
//    _/        \_     or as high, but made of two planes
TEST_CASE(
    "surfaces: a cambered road is one, of planes that meet at no crease, while two that meet at one as steep are two") {
  const bool creased = GENERATE(false, true);
  const double across_x = GENERATE(1.0, 0.6, 0.0), across_y = std::sqrt(1.0 - across_x * across_x);
  const auto stages = traced([&](double x, double y) {
    const double away = across_x * (x - 2.0) + across_y * (y - 2.0);
    return creased ? -0.025 * std::abs(away) : -0.0125 * away * away;
  });
  const Labels all = labels_of(*stages, everywhere);
  CHECK(all.planes.size() >= 2);
  CHECK(all.surfaces.size() == (creased ? 2 : 1));
  CHECK((creases(*stages) > 0) == creased);
}

TEST_CASE("surfaces: three planes or more along a bend are one, by the lowest of their labels, a hollow as a crown") {
  const double sign = GENERATE(-1.0, 1.0);
  const auto stages = traced([=](double x, double) { return sign * 0.02 * (x - 2.0) * (x - 2.0); });
  const Labels all = labels_of(*stages, everywhere);
  CHECK(all.planes.size() >= 3);
  CHECK(all.surfaces == std::set<Label>{*all.planes.begin()});
  CHECK(creases(*stages) == 0);
}

//  ___           the road is bent as before and lies 4 cm below a pavement where x > 3
//     |__.--.__
TEST_CASE("surfaces: a curb beside a cambered road parts it from the pavement, and is as high as the road is there") {
  const auto stages = traced([](double x, double) { return x > 3.0 ? 0.028 : -0.012 * (x - 2.0) * (x - 2.0); });
  const Labels road = labels_of(*stages, [](double x, double) { return x < 2.8; });
  const Labels pavement = labels_of(*stages, [](double x, double) { return x > 3.2; });
  CHECK(road.surfaces.size() == 1);
  CHECK(pavement.surfaces.size() == 1);
  CHECK(road.surfaces != pavement.surfaces);
  double kerb_m = 0.0;
  for (const Curb& curb : stages->tracer.curbs()) {
    REQUIRE(is_step(curb));
    CHECK(curb.height_m == Approx(0.04).margin(0.01));
    kerb_m += length_of(curb);
  }
  CHECK(kerb_m == Approx(4.0).margin(0.2));
}

//          _--
//  ______--      a ramp of 1 in 12 at the end of level ground, or of a road that is bent across it
TEST_CASE("surfaces: the foot of a ramp is the edge of a ramp, whatever the ground is bent by beside it") {
  const double bend_1_m = GENERATE(0.0, 0.01);
  const auto stages = traced(
      [=](double x, double y) { return 0.083 * std::max(x - 2.0, 0.0) - 0.5 * bend_1_m * (y - 2.0) * (y - 2.0); });
  const auto curbs = stages->tracer.curbs();
  double edge_m = 0.0;
  for (const Curb& curb : curbs) {
    if (curb.kind == CurbKind::ramp_edge) edge_m += length_of(curb);
  }
  CHECK(edge_m == Approx(4.0).margin(0.3));
  CHECK(labels_of(*stages, [](double x, double) { return x < 1.8; }).surfaces !=
        labels_of(*stages, [](double x, double) { return x > 2.2; }).surfaces);
}

TEST_CASE("surfaces: planes that are told apart by a step, more than by a crease, are two, though the ground is bent") {
  const auto stages = traced([](double x, double) { return -0.0125 * (x - 2.0) * (x - 2.0); });
  const CurbSettings settings;
  const CurbStages<limits> found{stages->dem, stages->mixture, stages->field, stages->view, stages->latency, settings};
  Curb crease, step;
  crease.near_label = step.far_label = stages->label_at(5, 20);
  crease.far_label = step.near_label = stages->label_at(35, 20);
  REQUIRE(crease.near_label != crease.far_label);
  crease.y1_m = 1.0f;
  step.kind = CurbKind::step_up;
  Surfaces<limits> surfaces;
  const auto follow = [&](float step_m) {
    step.y1_m = step_m;
    typename Surfaces<limits>::Work work;
    surfaces.follow(found, work, std::array{crease, step});
  };
  follow(0.9f);
  CHECK(surfaces.name(crease.near_label) == surfaces.name(crease.far_label));
  CHECK(surfaces.hold(crease));
  CHECK_FALSE(surfaces.hold(step));
  follow(1.1f);
  CHECK(surfaces.name(crease.near_label) != surfaces.name(crease.far_label));
  CHECK_FALSE(surfaces.hold(crease));
}

TEST_CASE("surfaces: what follows no bend any more has its own name again") {
  const auto stages = traced([](double x, double) { return -0.0125 * (x - 2.0) * (x - 2.0); });
  const Labels before = labels_of(*stages, everywhere);
  REQUIRE(before.surfaces.size() < before.planes.size());
  stages->tracer.init(small_settings().curbs);
  CHECK(labels_of(*stages, everywhere).surfaces == before.planes);
  CHECK(stages->tracer.surfaces().name(no_label) == no_label);
}

}  // namespace
}  // namespace curbline
