// Common to the scene tests: a window of 4 x 4 m before the robot, filled from near to far as by a laser that nods up.
//
// Tolerances. Points have noise of 5 mm. A height comes from two planes, so its error is that of their posteriors,
// Curb::height_sd_m; four of them are allowed. A border lies between two cells: half a cell of 0.1 m is allowed, and
// the cells that a step crosses may go to either side.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "curbline/pipeline.hpp"
#include "support/terrain.hpp"

namespace curbline::test {

inline constexpr double noise_sd_m = 0.005, half_cell_m = 0.05;

using ScenePipeline = Pipeline<Limits{}>;

/// The ground seen in a hundred strips, each followed by inference, then settled.
template <typename Height>
std::unique_ptr<ScenePipeline> seen(Height&& height_m, std::uint32_t seed = 1) {
  auto pipeline = std::make_unique<ScenePipeline>();
  REQUIRE(pipeline->init(Settings{}) == Status::ok);
  Noise noise(seed);
  const auto points = sample({0.0, 4.0, -2.0, 2.0}, 0.04, noise_sd_m, noise, height_m);
  for (std::size_t first = 0; first < points.size(); first += 100) {
    pipeline->observe(std::span(points).subspan(first, std::min<std::size_t>(100, points.size() - first)));
    pipeline->infer();
  }
  pipeline->settle();
  return pipeline;
}

inline double length_m(const Curb& c) {
  return std::hypot(c.x1_m - c.x0_m, c.y1_m - c.y0_m);
}

/// Pieces that lie along the line x = x_m.
inline std::vector<Curb> across_the_window(std::span<const Curb> curbs, double x_m) {
  std::vector<Curb> out;
  for (const Curb& c : curbs) {
    if (std::abs(c.x0_m - x_m) < 2 * half_cell_m && std::abs(c.x1_m - x_m) < 2 * half_cell_m) out.push_back(c);
  }
  return out;
}

inline double total_length_m(std::span<const Curb> curbs) {
  double sum = 0.0;
  for (const Curb& c : curbs) sum += length_m(c);
  return sum;
}

/// REQUIREs a curb of this height across the whole window at x, and nothing else there.
inline void check_curb_at(std::span<const Curb> all, double x_m, double height_m, CurbKind kind) {
  const std::vector<Curb> curbs = across_the_window(all, x_m);
  INFO("curb at " << x_m << " of " << height_m << " m");
  CHECK(total_length_m(curbs) > 3.8);
  for (const Curb& c : curbs) {
    CHECK(c.kind == kind);
    CHECK(c.height_m == Approx(height_m).margin(4 * c.height_sd_m));
    CHECK(std::abs(c.x0_m - x_m) <= half_cell_m);
    CHECK(std::abs(c.x1_m - x_m) <= half_cell_m);
  }
}

}  // namespace curbline::test
