// The reference's planes: least squares for components, EM for cells that ignore their neighbours.
#include "reference/mixture.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "reference/segmentation.hpp"
#include "reference_support.hpp"

namespace curbline::tools::reference::testing {
namespace {

constexpr Grid grid{2, -1, 0.1, 0.1, 20, 20};

/// Road and pavement with a step of 12 cm between them at x = 3 m.
double street(double x, double y) {
  return 0.02 * x + 0.01 * y + (x < 3 ? 0 : 0.12);
}

TEST_CASE("reference mixture: least squares finds the plane of a component") {
  const Dem dem = make_dem(cloud_of(grid, 0, [](double x, double y) { return 0.3 + 0.05 * x - 0.02 * y; }), grid, 1e9);
  const auto planes = planes_of_components(dem, std::vector<int>(dem.valid.size(), 0));
  REQUIRE(planes.size() == 1);
  CHECK(planes[0].w[0] == Approx(0.3 + 0.05 * 2 + 0.02 * 1));  // at the grid's corner
  CHECK(planes[0].w[1] == Approx(0.05));
  CHECK(planes[0].w[2] == Approx(-0.02));
  CHECK(planes[0].weight == Approx(1));
}

TEST_CASE("reference mixture: two cells make no plane, three do") {
  const Dem dem =
      make_dem(cloud_of({0, 0, 1, 1, 2, 4}, 0, [](double x, double) { return x; }), {0, 0, 1, 1, 2, 4}, 1e9);
  const auto planes = planes_of_components(dem, {0, 0, 1, 2, 0, 1, 1, 2});
  REQUIRE(planes.size() == 2);
  CHECK(planes[0].weight == Approx(3.0 / 8));  // the cells without a plane stay in the mixture
  CHECK(planes[1].weight == Approx(3.0 / 8));
}

TEST_CASE("reference mixture: cells on one line, which tell no slope, give a level plane") {
  const Dem dem = row_of({0.1, 0.2, 0.6});
  const auto planes = planes_of_components(dem, {0, 0, 0});
  REQUIRE(planes.size() == 1);
  CHECK(planes[0].w[0] == Approx(0.3));
  CHECK(planes[0].w.tail<2>().norm() == 0);
  CHECK(planes[0].variance_m2 == Approx((0.04 + 0.01 + 0.09) / 3));
}

TEST_CASE("reference mixture: a plane without any spread still has a likelihood") {
  const Dem dem = row_of({0.1, 0.1, 0.1});
  CHECK(log_likelihoods(dem, planes_of_components(dem, {0, 0, 0})).allFinite());
}

TEST_CASE("reference mixture: the likelihood of a cell is that of the formula") {
  const Dem dem = row_of({0.25});
  const MixturePlane plane{{0.1, 0.2, 0.04}, 0.01, 0.3};  // 0.1 + 0.2 * 0.5 + 0.04 * 0.5 = 0.22 at the cell's centre
  const double expected = std::log(0.3 / std::sqrt(2 * 3.14159265358979 * 0.01) * std::exp(-0.5 * 0.03 * 0.03 / 0.01));
  CHECK(log_likelihoods(dem, {plane})(0, 0) == Approx(expected));
}

TEST_CASE("reference mixture: responsibilities share a cell between planes as their likelihoods do") {
  Eigen::MatrixXd log_likelihood(2, 2), responsibility;
  log_likelihood << std::log(0.3), std::log(0.1), -2000, -2000 - std::log(3.0);
  const double total = independent_responsibilities(log_likelihood, responsibility);
  CHECK(responsibility(0, 0) == Approx(0.75));
  CHECK(responsibility(1, 1) == Approx(0.25));  // far below what exp() can represent
  CHECK(total == Approx(std::log(0.4) - 2000 + std::log(4.0 / 3)));
}

TEST_CASE("reference mixture: cells count by their responsibilities in the M-step") {
  const Dem dem = row_of({0.0, 0.0, 0.4});
  Responsibilities responsibility(3, 1);
  responsibility << 1, 0.5, 0.5;
  std::vector<MixturePlane> planes(1);
  maximise(dem, responsibility, planes);
  CHECK(planes[0].w[0] == Approx(0.1));  // (0.5 * 0.4) / 2
  CHECK(planes[0].variance_m2 == Approx((1 * 0.01 + 0.5 * 0.01 + 0.5 * 0.09) / 2));
  CHECK(planes[0].weight == Approx(2.0 / 3));
}

TEST_CASE("reference mixture: a plane that no cell answers for keeps its parameters") {
  const Dem dem = row_of({0.0, 0.0, 0.4});
  std::vector<MixturePlane> planes{{{1, 2, 3}, 0.5, 0.2}};
  maximise(dem, Responsibilities::Zero(3, 1), planes);
  CHECK(planes[0].w == Eigen::Vector3d(1, 2, 3));
  CHECK(planes[0].variance_m2 == 0.5);
  CHECK(planes[0].weight == 0);
}

TEST_CASE("reference mixture: the log likelihood does not fall from one EM step to the next") {
  const Dem dem = make_dem(cloud_of(grid, 0.03, street), grid, 1e9);
  const auto component = segment(dem, 10);
  std::vector<MixturePlane> planes = planes_of_components(dem, component);
  REQUIRE(planes.size() >= 3);
  Responsibilities responsibility;
  const double first = independent_responsibilities(log_likelihoods(dem, planes), responsibility);
  double before = first;
  for (int step = 0; step < 30; ++step) {
    maximise(dem, responsibility, planes);
    const double now = independent_responsibilities(log_likelihoods(dem, planes), responsibility);
    INFO("step " << step);
    CHECK(now >= before - 1e-9 * std::abs(before));
    before = now;
  }
  CHECK(before > first + 1);
}

}  // namespace
}  // namespace curbline::tools::reference::testing
