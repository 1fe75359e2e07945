// Where within its cells an edge lies.
#include "curbline/border_finder.hpp"

#include <catch2/catch.hpp>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::small_limits;
using test::small_settings;
using test::Stages;

/// What points on a metre of two planes 1 apart make of a cell with its edge there: `face` times as many on the face as
/// on a cell of ground, the share of the far plane's ground behind the edge that the laser does not see.
CrossedCell crossed(double edge, double face, double hidden) {
  double points = 0, heights = 0, places = 0;
  const auto add = [&](double number, double height, double place) {
    points += number;
    heights += number * height;
    places += number * place;
  };
  const double seen = (1 - edge) * (1 - hidden);
  add(edge, 0, edge / 2);
  add(face, 0.5, edge);
  add(seen, 1, 1 - seen / 2);
  return {static_cast<float>(heights / points), static_cast<float>(places / points)};
}

TEST_CASE("border finder: an edge that steps up lies where it is in a cell, however many points its face has") {
  for (const double edge : {0.05, 0.3, 0.5, 0.8}) {
    for (const double face : {0.0, 0.5, 3.0})
      CHECK(edge_in_cell(crossed(edge, face, 0), true) == Approx(edge).margin(1e-5));
  }
}

TEST_CASE("border finder: an edge that steps down lies where the near ground ends, whatever it hides") {
  // A cell of which all beyond the edge is hidden holds the near ground alone.
  for (const double edge : {0.3, 0.5, 0.9})
    CHECK(edge_in_cell(crossed(edge, 0, 1), false) == Approx(edge).margin(1e-5));
  for (const double edge : {0.1, 0.5, 0.9})
    CHECK(edge_in_cell(crossed(edge, 0, 0), false) == Approx(edge).margin(1e-5));
}

TEST_CASE("border finder: cells beside the edge are whole") {
  for (const bool step_up : {false, true}) {
    CHECK(edge_in_cell({0.0f, 0.5f}, step_up) == Approx(1.0));
    CHECK(edge_in_cell({1.0f, 0.5f}, step_up) == Approx(0.0));
    CHECK(edge_in_cell({-0.1f, 0.5f}, step_up) == Approx(1.0));
    CHECK(edge_in_cell({1.1f, 0.5f}, step_up) == Approx(0.0));
  }
}

//  ______________
//                |               the shadow of a laser 1 m above: 12 cm high, at 1.2 m, 14 cm long
//                |  shadow
//                '.......________
TEST_CASE("border finder: a step down lies before its shadow") {
  Stages<small_limits> stages(small_settings());
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) {
      for (const double at : {0.01, 0.03, 0.05, 0.07, 0.09}) {
        const double x = 0.1 * i + at, y = 0.1 * j + at;
        if (x > 1.2 && x < 1.2 + 0.12 * 1.2 / 0.88) continue;
        stages.dem.add({static_cast<float>(x), static_cast<float>(y), x < 1.2 ? 0.12f : 0.0f, 1e-4f});
      }
    }
  }
  for (int pass = 0; pass < 3; ++pass) stages.infer(true);
  stages.tracer.trace(stages.dem, stages.mixture, stages.field, {0.0f, 1.2f, 1.0f}, stages.work.curbs(),
                      stages.counters);
  REQUIRE(stages.tracer.curbs().size() == 1);
  const Curb& curb = stages.tracer.curbs()[0];
  CHECK(curb.kind == CurbKind::step_down);
  CHECK(curb.x0_m == Approx(1.2).margin(0.01));
  CHECK(curb.x1_m == Approx(1.2).margin(0.01));
  CHECK(curb.face_width_m < 0.05f);
}

}  // namespace
}  // namespace curbline
