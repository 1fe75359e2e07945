// Runs of a plane's cells on rows and columns, and what the runs beside one make of it. On whole maps: ground_test.cpp.
#include "curbline/planes/run.hpp"

#include <catch2/catch.hpp>
#include <memory>
#include <string>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::small_limits;
using test::small_settings;

/// The labels of the runs that a row of cells, or a column, falls into, with the cells seen of each: for "aa.ab" a3 b1,
/// if '.' is not seen and '-' belongs to no plane.
std::string runs_of(const std::string& cells, int axis) {
  const auto dem = std::make_unique<Dem<small_limits>>();
  dem->init(small_settings().window, PlanePrior{});
  const auto labels = std::make_unique<CellLabels<small_limits>>();
  labels->fill(no_label);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k] == '.') continue;
    const int i = axis == 0 ? static_cast<int>(k) : 7, j = axis == 0 ? 7 : static_cast<int>(k);
    dem->add({0.1f * static_cast<float>(i) + 0.05f, 0.1f * static_cast<float>(j) + 0.05f, 0.0f, 1e-4f});
    if (cells[k] != '-') (*labels)[dem->slot(i, j)] = static_cast<Label>(cells[k] - 'a');
  }
  std::string found;
  for_each_run(*dem, axis, *labels, [&](const Strip& strip, const CellLine<small_limits>& line) {
    REQUIRE(line.axis == axis);
    REQUIRE(line.across == 7);
    found += static_cast<char>('a' + strip.run.label);
    found += std::to_string(strip.run.cells);
  });
  return found;
}

TEST_CASE("run: it ends where the next plane begins, not where nothing is seen or a cell belongs to none") {
  const int axis = GENERATE(0, 1);
  CHECK(runs_of("aaabb", axis) == "a3b2");
  CHECK(runs_of("aa..a-abb", axis) == "a4b2");
  CHECK(runs_of("aba", axis) == "a1b1a1");
  CHECK(runs_of("..--..", axis) == "");
  CHECK(runs_of("aaaaaaaaaaaaaaaaaaaaaaab", axis) == "a23b1");  // up to the window's end
}

TEST_CASE("strip: how far it is to its neighbours is counted over what is not seen") {
  const Run before(Label{1}, 3, Cell{}), next(Label{2}, 9, Cell{}), none;
  Run run(Label{3}, 5, Cell{});
  run.add(6, Cell{});
  CHECK(Strip{before, run, next}.between(3));
  CHECK_FALSE(Strip{before, run, next}.between(2));
  CHECK_FALSE(Strip{none, run, next}.between(3));
  CHECK(Strip{before, run, next}.alone(1));
  CHECK_FALSE(Strip{before, run, next}.alone(2));
  CHECK_FALSE(Strip{before, run, none}.alone(2));
  CHECK(Strip{none, run, none}.alone(5));
}

TEST_CASE("strip: an edge blurs the cells that it crosses and those of the spot from where they were last seen") {
  const Run none, run(Label{1}, 11, Cell{});
  const Strip strip{none, run, none};
  const float spot = 0.01f * (1.1f * 1.1f + 1.4f * 1.4f) / (1.1f * 0.1f);
  const auto cells = [&](float askew, float divergence_rad = 0.01f, float laser_z_m = 1.1f) {
    const Viewpoint view{.x_m = -0.3f, .z_m = laser_z_m, .end_x_m = 8.0f, .divergence_rad = divergence_rad};
    return strip.blurred_cells({view, view.x_m, 0.1f, view.end_x_m, 0.0f}, askew);
  };
  CHECK(cells(0.0f) == Approx(1.0f + spot));
  CHECK(cells(0.0f, 0.015f) == Approx(1.0f + 1.5f * spot));
  CHECK(cells(-0.5f) == Approx(1.5f + spot));
  CHECK(cells(5.0f) == Approx(2.0f + spot));  // it lies along the row: columns tell
  CHECK(cells(0.0f, 0.01f, -0.1f) == 0.0f);
}

}  // namespace
}  // namespace curbline
