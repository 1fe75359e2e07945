// The streaming pipeline against the batch algorithm: a stationary scene, seen in chunks of 200 points with inference
// after each.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "curbline/pipeline.hpp"
#include "evaluation/labels.hpp"
#include "reference/reference.hpp"
#include "support/terrain.hpp"

namespace curbline::tools::reference::testing {
namespace {

constexpr double noise_sd_m = 0.007;
constexpr std::size_t chunk = 200;
constexpr Grid window{0, -2, 0.1, 0.1, 40, 40};  // as in Settings{}

constexpr int calls_to_settle = 40;  ///< by then messages stand, in every case here

using Streaming = Pipeline<Limits{}>;

//            ________  +12 cm, from x = step_x_m on
//   ________|
//   0       2       4 m
/// Six points a cell, from near to far as from a laser that nods up, or shuffled.
std::vector<Point> street(double step_x_m, bool swept, std::uint32_t seed) {
  test::Noise noise(seed);
  auto points =
      test::sample({0, 4, -2, 2}, 0.04, noise_sd_m, noise, [&](double x, double) { return x < step_x_m ? 0.0 : 0.12; });
  for (std::size_t left = points.size(); !swept && left > 1; --left) {
    std::swap(points[left - 1], points[static_cast<std::size_t>(noise.uniform() * static_cast<double>(left))]);
  }
  return points;
}

std::unique_ptr<Streaming> streamed(std::span<const Point> points) {
  auto pipeline = std::make_unique<Streaming>();
  REQUIRE(pipeline->init(Settings{}) == Status::ok);
  for (; !points.empty(); points = points.subspan(std::min(chunk, points.size()))) {
    pipeline->observe(points.first(std::min(chunk, points.size())));
    pipeline->infer();
  }
  return pipeline;
}

std::vector<int> labels_of(const Streaming& pipeline) {
  std::vector<int> out;
  for (int i = 0; i < window.rows; ++i) {
    for (int j = 0; j < window.cols; ++j) out.push_back(pipeline.label(i, j));
  }
  return out;
}

/// The paper's algorithm with the settings of its code: CRF and EM, Potts 10, s = 100.
std::vector<int> batch_labels(std::span<const Point> points) {
  std::vector<Point3> cloud;
  for (const Point& p : points) cloud.push_back({p.x_m, p.y_m, p.z_m});
  std::vector<int> out;
  for (const MapCell& cell : map_cloud(cloud, window, {}).cells) out.push_back(cell.label);
  return out;
}

/// Drops the row of cells that the step crosses: they may belong to either road or pavement.
std::vector<int> beside_the_step(std::vector<int> labels, double step_x_m) {
  const auto row = static_cast<std::ptrdiff_t>(std::floor(step_x_m / window.dx_m));
  labels.erase(labels.begin() + row * window.cols, labels.begin() + (row + 1) * window.cols);
  return labels;
}

TEST_CASE("streaming and batch: after the last chunk the labels agree, but where the step falls in a cell") {
  const double step_x_m = GENERATE(2.0, 2.03, 2.05, 2.08);
  const bool swept = GENERATE(true, false);
  CAPTURE(step_x_m, swept);
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    const auto points = street(step_x_m, swept, seed);
    const std::vector<int> batch = batch_labels(points);
    const auto pipeline = streamed(points);
    for (const int calls : {0, calls_to_settle}) {
      for (int n = 0; n < calls; ++n) pipeline->infer();
      const std::vector<int> stream = labels_of(*pipeline);
      const double v = v_measure(batch, stream);
      CAPTURE(seed, calls);
      // 40 of 1600 cells contain points of both planes; batch and stream may assign them differently, which makes V
      // 0.91.
      CHECK(v >= (step_x_m == 2.0 ? 1 - 1e-9 : 0.9));
      CHECK(v_measure(beside_the_step(batch, step_x_m), beside_the_step(stream, step_x_m)) == Approx(1));
    }
  }
}

TEST_CASE("streaming and batch: once messages stand, further calls change no label") {
  const double step_x_m = GENERATE(2.0, 2.02, 2.03);
  const bool swept = GENERATE(true, false);
  CAPTURE(step_x_m, swept);
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const auto pipeline = streamed(street(step_x_m, swept, seed));
    for (int n = 0; n < calls_to_settle; ++n) pipeline->infer();
    const std::vector<int> labels = labels_of(*pipeline);
    int changed = 0;
    for (int n = 0; n < 3 * calls_to_settle; ++n) {
      pipeline->infer();
      changed += labels_of(*pipeline) != labels;
    }
    CHECK(changed == 0);
  }
}

}  // namespace
}  // namespace curbline::tools::reference::testing
