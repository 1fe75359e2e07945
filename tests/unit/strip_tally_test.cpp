// What the runs of a plane's cells say about it.
#include "curbline/planes/strip_tally.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <span>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::small_limits;

// _______
//        `              two cells on one row, four apart, in the shadow of a step; on other rows nothing lies beyond
//           ` ____
TEST_CASE("strip tally: of a strip the cells that are seen count, as of its plane, not those between") {
  Dem<small_limits> dem;
  const Settings settings = test::small_settings();
  dem.init(settings.window, settings.planes.prior);
  CellLabels<small_limits> labels;
  labels.fill(no_label);
  const auto see = [&](int i, int j, Label label, float height_m) {
    dem.add({0.1f * static_cast<float>(i) + 0.05f, 0.1f * static_cast<float>(j) + 0.05f, height_m, 1e-4f});
    labels[dem.slot(i, j)] = label;
  };
  for (int i = 0; i < 24; ++i) {
    if (i < 10 || i > 14) see(i, 12, i < 10 ? 0 : 2, i < 10 ? 0.0f : -0.15f);
  }
  see(10, 12, 1, -0.03f);
  see(14, 12, 1, -0.12f);
  for (int j = 0; j < 8; ++j) see(10, j, 1, -0.03f);
  const std::array<Plane, small_limits.planes> planes{};
  const Viewpoint view{-2.5f, 1.25f, 1.0f};
  const Obstacles<small_limits> obstacles(dem, planes, view, labels);
  const StripTally tally = tally_strips(dem, std::span<const Plane>(planes), view, labels, obstacles)[1];
  CHECK(tally.cells == 10.0f);
  CHECK(tally.shadow[0].strips == 1.0f);
  CHECK(tally.shadow[0].cells == 2.0f);
}

}  // namespace
}  // namespace curbline
