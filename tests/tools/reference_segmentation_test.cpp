// The reference's cells and the starting point of EM: posterior of a cell, graph of the cells, components.
#include "reference/segmentation.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "reference_support.hpp"

namespace curbline::tools::reference::testing {
namespace {

constexpr Grid quarters{-0.5, 0.5, 0.25, 0.25, 4, 4};

TEST_CASE("reference dem: a cell holds the mode of its points' posterior") {
  const std::vector<Point3> cloud{{0.1, 0.6, 1.00}, {0.2, 0.7, 1.02}, {0.1, 0.7, 1.07}};
  const Dem dem = make_dem(cloud, quarters, 1e9);
  REQUIRE(dem.valid == std::vector<std::size_t>{quarters.at(2, 0)});
  CHECK(dem.cell(0).points == 3);
  CHECK(dem.cell(0).height_m == Approx(1.03));
  CHECK(dem.cell(0).variance_m2() == Approx((3e-4 + 0.03 * 0.03 + 0.01 * 0.01 + 0.04 * 0.04) / 6));
}

TEST_CASE("reference dem: a cell owns its lower borders, not its upper ones") {
  const std::vector<Point3> cloud{{-0.5, 0.5, 0}, {-0.25, 0.75, 0}, {0.5, 0.6, 0}, {0.1, 1.5, 0}, {-0.51, 0.6, 0}};
  CHECK(make_dem(cloud, quarters, 1e9).valid == std::vector<std::size_t>{quarters.at(0, 0), quarters.at(1, 1)});
}

TEST_CASE("reference dem: points above the greatest height are left out, those at it are not") {
  const std::vector<Point3> cloud{{0.1, 0.6, 0.3}, {0.1, 0.6, 0.3001}};
  const Dem dem = make_dem(cloud, quarters, 0.3);
  REQUIRE(dem.valid.size() == 1);
  CHECK(dem.cell(0).points == 1);
}

TEST_CASE("reference dem: points that are not finite are left out") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const std::vector<Point3> cloud{
      {0.1, 0.6, nan}, {0.1, 0.6, -infinity}, {nan, 0.6, 0}, {0.1, infinity, 0}, {0.1, 0.6, 0.2}};
  const Dem dem = make_dem(cloud, quarters, 1e9);
  REQUIRE(dem.valid.size() == 1);
  CHECK(dem.cell(0).height_m == Approx(0.2));
}

TEST_CASE("reference dem: an empty cell links to none of its neighbours") {
  const Grid grid{0, 0, 1, 1, 3, 3};
  const auto around_the_middle = [](double x, double y) {
    return std::abs(x - 1.5) < 0.5 && std::abs(y - 1.5) < 0.5 ? std::nan("") : 0.0;
  };
  const Dem dem = make_dem(cloud_of(grid, 0, around_the_middle), grid, 1e9);
  CHECK(dem.valid.size() == 8);
  CHECK(dem.edges.size() == 8);
}

TEST_CASE("reference segmentation: the weight of an edge is the divergence one way and the other, added") {
  const DemCell a{5, 0.10, 2e-3}, b{2, 0.16, 1e-4};
  const double va = a.variance_m2(), vb = b.variance_m2(), d2 = 0.06 * 0.06;
  const double a_to_b = 0.5 * (std::log(vb / va) + va / vb - 1 + d2 / vb);
  const double b_to_a = 0.5 * (std::log(va / vb) + vb / va - 1 + d2 / va);
  CHECK(divergence(a, b) == Approx(a_to_b + b_to_a));
  CHECK(divergence(a, b) == divergence(b, a));
  CHECK(divergence(a, a) == 0);
}

/// Four cells in a row whose edges weigh 1, 5.9 and 2. With variance v on both sides, the weight is d^2 / v.
Dem chain_of_four() {
  const double v = 3e-4 / 4;
  const double b = std::sqrt(1 * v), c = b + std::sqrt(5.9 * v), d = c + std::sqrt(2 * v);
  return row_of({0, b, c, d});
}

TEST_CASE("reference segmentation: components join when the edge is within both sides' limits") {
  // The pairs join first: Int is 1 and 2, with two cells each. The edge between them, 5.9, needs 1 + s/2 and 2 + s/2.
  CHECK(segment(chain_of_four(), 10) == std::vector<int>{0, 0, 0, 0});
}

TEST_CASE("reference segmentation: components stay apart when one side's limit is too low") {
  CHECK(segment(chain_of_four(), 9) == std::vector<int>{0, 0, 1, 1});  // limits 5.5 and 6.5
}

TEST_CASE("reference segmentation: a small scale leaves every cell alone") {
  CHECK(segment(chain_of_four(), 0.9) == std::vector<int>{0, 1, 2, 3});
}

TEST_CASE("reference segmentation: components are numbered by size, the largest first") {
  CHECK(segment(row_of({0, 5, 5, 9, 9, 9}), 1) == std::vector<int>{2, 1, 1, 0, 0, 0});
}

}  // namespace
}  // namespace curbline::tools::reference::testing
