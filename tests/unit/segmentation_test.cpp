// Leaves and regions: where they separate, where they join, and what a scan line leaves unchanged.
#include "curbline/regions/segmentation.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <memory>
#include <set>
#include <utility>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::small_settings;
using test::Stages;

std::array<BlockCell, 16> block(float step_m, float variance_m2 = 3e-4f) {
  std::array<BlockCell, 16> cells{};
  for (std::size_t k = 0; k < cells.size(); ++k) cells[k] = {k % 4 < 2 ? 0.0f : step_m, variance_m2, true};
  return cells;
}

/// Regions of the whole window; REQUIREs that every valid cell has one.
template <typename S>
std::set<int> regions(const S& stages) {
  std::set<int> names;
  for (int i = 0; i < stages.dem.rows(); ++i) {
    for (int j = 0; j < stages.dem.cols(); ++j) {
      if (!stages.dem.cell(stages.dem.slot(i, j)).valid()) continue;
      REQUIRE(stages.region_at(i, j) != decltype(stages.segmentation)::none);
      names.insert(stages.region_at(i, j));
    }
  }
  return names;
}

TEST_CASE("segmentation: a flat block is one leaf, named by its first cell") {
  const BlockLeaves leaves = cut_block(block(0.0f), 2.0f);
  for (const auto leaf : leaves) CHECK(leaf == 0);
}

TEST_CASE("segmentation: a block is cut on a step and nowhere else") {
  const BlockLeaves leaves = cut_block(block(0.12f), 2.0f);
  for (std::size_t k = 0; k < leaves.size(); ++k) CHECK(leaves[k] == (k % 4 < 2 ? 0 : 2));
}

TEST_CASE("segmentation: a step well within the cells' noise does not cut a block") {
  const BlockLeaves leaves = cut_block(block(0.12f, 0.5f * 0.5f), 2.0f);
  for (const auto leaf : leaves) CHECK(leaf == 0);
}

TEST_CASE("segmentation: two like cells of a block are one leaf, if they are all that it holds, too") {
  auto cells = block(0.0f);
  for (std::size_t k = 0; k < cells.size(); ++k) cells[k].valid = k == 5 || k == 7;
  const BlockLeaves leaves = cut_block(cells, 2.0f);
  for (std::size_t k = 0; k < leaves.size(); ++k) CHECK(leaves[k] == (cells[k].valid ? 5 : 255));
}

TEST_CASE("segmentation: cells without points belong to no leaf and are reached across") {
  auto cells = block(0.0f);
  for (std::size_t i = 0; i < 4; ++i) cells[4 * i + 1].valid = false;
  const BlockLeaves leaves = cut_block(cells, 2.0f);
  for (std::size_t k = 0; k < leaves.size(); ++k) CHECK(leaves[k] == (k % 4 == 1 ? 255 : 0));
  const BlockLeaves nothing = cut_block(std::array<BlockCell, 16>{}, 2.0f);
  for (const auto leaf : nothing) CHECK(leaf == 255);
}

TEST_CASE("segmentation: a plane is one region, however it slopes") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  const double slope = GENERATE(0.0, 0.1, -0.3);
  fill(stages->dem, [&](double x, double y) { return slope * x + 0.05 * y; });
  stages->segment();
  CHECK(regions(*stages).size() == 1);
}

TEST_CASE("segmentation: two planes with a step between them are two regions, parted at the step") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double x, double y) { return 0.03 * x + 0.02 * y + (x < 1.4 ? 0.0 : 0.12); });
  stages->segment();
  CHECK(regions(*stages).size() == 2);
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) CHECK(stages->region_at(i, j) == stages->region_at(i < 14 ? 0 : 23, 0));
  }
}

TEST_CASE("segmentation: a low step across a slope parts planes as soon as the ground's slope is known") {
  //          __--   a slope of 12 or 15 %
  //      __-|       22 mm, oblique across it: cells of one height are on both sides
  //   --
  const double slope = GENERATE(0.12, 0.15);
  const auto stages = std::make_unique<Stages<>>(small_settings());
  test::Noise noise;
  const auto beyond = [](double x, double y) { return x + 4.0 * y > 6.0; };
  const auto see = [&] {
    fill(stages->dem,
         [&](double x, double y) { return slope * x + (beyond(x, y) ? 0.022 : 0.0) + 0.003 * noise.normal(); });
    stages->infer();
  };
  see();
  see();
  CHECK(regions(*stages).size() == 2);
  int wrong = 0;
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) {
      wrong += stages->region_at(i, j) != stages->region_at(i, beyond(0.1 * i + 0.05, 0.1 * j + 0.05) ? 23 : 0);
    }
  }
  CHECK(wrong <= 24);  // of those that the step crosses
}

TEST_CASE(
    "segmentation: a low step across a slope parts planes whatever way the slope falls, against it a little later") {
  const int quarters = GENERATE(0, 1, 2, 3);
  const auto regions_after = [=](double slope, int passes) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    test::Noise noise;
    for (int pass = 0; pass < passes; ++pass) {
      fill(stages->dem, [&](double x, double y) {
        for (int k = 0; k < quarters; ++k) std::swap(x, y), x = 2.4 - x;
        return slope * x + (x + 4.0 * y > 6.0 ? 0.022 : 0.0) + 0.003 * noise.normal();
      });
      stages->infer();
    }
    return regions(*stages).size();
  };
  CHECK(regions_after(0.13, 2) == 2);
  CHECK(regions_after(-0.13, 6) == 2);
}

TEST_CASE("segmentation: a region splits again when new cells show a step") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  // Few and far apart, the first cells look like one slope.
  test::Noise noise;
  for (const Point& p : test::sample({0.0, 0.1, 0.0, 2.4}, 0.05, 0.002, noise, [](double, double) { return 0.0; }))
    stages->dem.add(p);
  for (const Point& p : test::sample({1.0, 1.1, 0.0, 2.4}, 0.05, 0.002, noise, [](double, double) { return 0.12; }))
    stages->dem.add(p);
  stages->infer();
  CHECK(stages->region_at(0, 5) == stages->region_at(10, 5));
  for (const Point& p :
       test::sample({0.1, 2.4, 0.0, 2.4}, 0.05, 0.002, noise, [](double x, double) { return x < 1.0 ? 0.0 : 0.12; })) {
    stages->dem.add(p);
  }
  stages->infer();
  CHECK(stages->region_at(0, 5) == stages->region_at(9, 5));
  CHECK(stages->region_at(10, 5) == stages->region_at(23, 5));
  CHECK(stages->region_at(9, 5) != stages->region_at(10, 5));
}

TEST_CASE("segmentation: what no line touched keeps its region, though its neighbours are cut anew") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  // Three strips; only the last one is touched again.
  fill(stages->dem, [](double x, double) { return x < 0.8 ? 0.0 : x < 1.6 ? 0.12 : 0.24; });
  stages->infer();
  const auto first = stages->region_at(0, 0), middle = stages->region_at(8, 0), last = stages->region_at(16, 0);
  REQUIRE(regions(*stages) == std::set<int>{first, middle, last});
  const auto before = stages->counters.evidences;
  stages->dem.add({2.05f, 1.05f, 0.24f, 1e-4f});
  stages->infer();
  CHECK(regions(*stages) == std::set<int>{first, middle, last});
  for (int j = 0; j < 24; ++j) CHECK(stages->region_at(3, j) == first);
  CHECK(stages->counters.evidences - before < before);  // the first strip took part as one node
}

TEST_CASE("segmentation: a touched region dissolves its neighbour before it as well as the one behind it") {
  const auto evidences = [](float x_m) {
    const auto stages = std::make_unique<Stages<>>(small_settings());
    fill(stages->dem, [](double x, double) { return x < 0.8 ? 0.0 : x < 1.6 ? 0.12 : 0.0; });
    stages->infer();
    const auto before = stages->counters.evidences;
    stages->dem.add({x_m, 1.05f, 0.0f, 1e-4f});
    stages->infer();
    return stages->counters.evidences - before;
  };
  CHECK(evidences(0.35f) == Approx(evidences(2.05f)).epsilon(0.15));
}

TEST_CASE("segmentation: a cell that left the window has no region") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double, double) { return 0.0; });
  stages->segment();
  stages->segmentation.forget(stages->dem.slot(5, 5));
  CHECK(stages->region_at(5, 5) == decltype(stages->segmentation)::none);
}

TEST_CASE("segmentation: without a touched cell nothing is cut or merged") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  stages->infer();
  const auto names = regions(*stages);
  const auto before = stages->counters.evidences;
  stages->infer();
  CHECK(regions(*stages) == names);
  CHECK(stages->counters.evidences == before);
}

TEST_CASE("segmentation: regions reach across gaps as far as links do, and no further") {
  Settings settings = small_settings();
  settings.segmentation.link_reach = 6;
  const int gap = GENERATE(5, 6);  // cells without points
  const auto stages = std::make_unique<Stages<>>(settings);
  test::Noise noise;
  const auto flat = [](double, double) { return 0.0; };
  for (const Point& p : test::sample({0.0, 0.8, 0.0, 2.4}, 0.05, 0.002, noise, flat)) stages->dem.add(p);
  for (const Point& p : test::sample({0.8 + 0.1 * gap, 2.4, 0.0, 2.4}, 0.05, 0.002, noise, flat)) stages->dem.add(p);
  stages->segment();
  CHECK(regions(*stages).size() == (gap == 5 ? 1 : 2));
}

//  ________####________    a box across the window: the ground on both sides is one region, within the reach of links
TEST_CASE("segmentation: what stands on the ground does not part it, nor join what a step parts") {
  const auto together = [](double step_m, int rows) {
    auto stages = std::make_unique<Stages<>>(small_settings());
    const double end = 1.0 + 0.1 * rows;
    fill(stages->dem, [=](double x, double) { return x < end ? 0.0 : step_m; });
    for (int i = 10; i < 10 + rows; ++i) {
      for (int j = 0; j < 24; ++j) {
        const float x_m = 0.1f * static_cast<float>(i) + 0.05f, y_m = 0.1f * static_cast<float>(j) + 0.05f;
        for (const float z_m : {0.2f, 0.4f, 0.6f, 0.8f}) stages->dem.add({x_m, y_m, z_m, 1e-4f});
      }
    }
    stages->segment();
    return stages->region_at(2, 12) == stages->region_at(22, 12);
  };
  CHECK(together(0.0, 3));
  CHECK(together(0.0, 9));
  CHECK_FALSE(together(0.0, 10));
  CHECK_FALSE(together(0.12, 3));
}

TEST_CASE("segmentation: a leaf for which the store has no room has no region, and others are right") {
  constexpr Limits tight{.rows = 24, .cols = 24, .planes = 6, .regions = 4, .links = 2};
  const auto stages = std::make_unique<Stages<tight>>(small_settings());
  fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  stages->segment();
  CHECK(stages->counters.regions_full == 32);  // 36 leaves and 4 nodes
  CHECK(stages->counters.links_full > 0);
  CHECK(stages->region_at(2, 2) != Segmentation<tight>::none);
  CHECK(stages->region_at(2, 2) == stages->region_at(3, 6));  // as far as there is room, in the order of rows
  CHECK(stages->region_at(2, 22) == Segmentation<tight>::none);
  CHECK(stages->region_at(14, 2) == Segmentation<tight>::none);
}

}  // namespace
}  // namespace curbline
