// What the spread of heights within a cell tells of a slope.
#include "curbline/map/level_cell.hpp"

#include <catch2/catch.hpp>
#include <memory>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::small_limits;
using test::small_settings;

/// A cell of 5 x 5 points over it, or n x 5 if the scan lines cross a part of it, from `from` on, on ground that rises
/// along x.
struct OneCell {
  explicit OneCell(double rise, int lines = 5, double from = 0.01) {
    const Settings settings = small_settings();
    dem->init(settings.window, settings.planes.prior);
    plane.slope_x = 0.6f;
    plane.cells = 100.0f;
    for (int line = 0; line < lines; ++line) {
      for (int k = 0; k < 5; ++k) {
        const double x = from + 0.02 * line;
        dem->add(
            {static_cast<float>(1.0 + x), static_cast<float>(1.01 + 0.02 * k), static_cast<float>(rise * x), 1e-4f});
      }
    }
  }
  const Cell& cell() const { return dem->cell(dem->slot(10, 10)); }
  float expected_m2() const { return slope_scatter_m2(*dem, cell(), plane); }
  float likelihood() const { return level_likelihood(*dem, cell(), plane); }

  std::unique_ptr<Dem<small_limits>> dem = std::make_unique<Dem<small_limits>>();
  Plane plane{};
};

TEST_CASE("level cell: a slope scatters heights by its rise in the cell, less where one line crosses that") {
  const OneCell slope(0.6);
  CHECK(slope.expected_m2() == Approx(slope.cell().scatter_m2 / slope.cell().points).epsilon(0.05));
  CHECK(OneCell(0.6, 1, 0.01).expected_m2() < 0.5f * OneCell(0.6, 1, 0.05).expected_m2());
}

TEST_CASE("level cell: level readings tell against a slope, the more of them the more, a single one says nothing") {
  CHECK(OneCell(0.6).likelihood() < 0.1f);
  CHECK(OneCell(1.2).likelihood() == 0.0f);  // noisier than the slope makes it
  CHECK(OneCell(0.1).likelihood() > gate);
  CHECK(OneCell(0.1, 1, 0.05).likelihood() < OneCell(0.1).likelihood());
  Settings settings = small_settings();
  auto dem = std::make_unique<Dem<small_limits>>();
  dem->init(settings.window, settings.planes.prior);
  dem->add({1.05f, 1.05f, 0.0f, 1e-4f});
  Plane plane;
  plane.slope_x = 0.6f;
  CHECK(level_likelihood(*dem, dem->cell(dem->slot(10, 10)), plane) == 0.0f);
}

}  // namespace
}  // namespace curbline
