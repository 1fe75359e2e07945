// A cell against the posterior of a Gaussian with unknown mean and variance, computed from all points at once in double
// precision.
#include "curbline/map/cell.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "support/terrain.hpp"

namespace curbline {
namespace {

struct Reading {
  double dx, dy, height, weight;
};

Cell cell_of(const std::vector<Reading>& readings) {
  Cell cell;
  for (const Reading& r : readings) {
    cell.add(static_cast<float>(r.dx), static_cast<float>(r.dy), static_cast<float>(r.height),
             static_cast<float>(r.weight));
  }
  return cell;
}

std::vector<Reading> readings(int count, double height, double sd) {
  test::Noise noise(7);
  std::vector<Reading> all;
  for (int k = 0; k < count; ++k) {
    all.push_back({0.1 * (noise.uniform() - 0.5), 0.1 * (noise.uniform() - 0.5), height + sd * noise.normal(),
                   0.1 + noise.uniform()});
  }
  return all;
}

TEST_CASE("cell: without a point it is not valid, with one it is") {
  Cell cell;
  CHECK_FALSE(cell.valid());
  cell.add(0.01f, -0.02f, 0.3f, 0.5f);
  CHECK(cell.valid());
  CHECK(cell.height_m == 0.3f);
  CHECK(cell.dx_m == 0.01f);
  CHECK(cell.dy_m == -0.02f);
  CHECK(cell.scatter_m2 == 0.0f);
}

TEST_CASE("cell: a noisier reading moves the mean less") {
  Cell sharp, blurred;
  for (Cell* cell : {&sharp, &blurred}) cell->add(0.0f, 0.0f, 0.0f, 1.0f);
  sharp.add(0.0f, 0.0f, 0.1f, 1.0f);
  blurred.add(0.0f, 0.0f, 0.1f, 0.25f);
  CHECK(sharp.height_m == Approx(0.05f));
  CHECK(blurred.height_m == Approx(0.02f));
}

TEST_CASE("cell: running sums agree with the weighted mean and scatter of all points at once") {
  const auto all = readings(500, -0.83, 0.006);
  double weight = 0, height = 0, dx = 0, dy = 0, scatter = 0;
  for (const Reading& r : all) {
    weight += r.weight;
    height += r.weight * r.height;
    dx += r.weight * r.dx;
    dy += r.weight * r.dy;
  }
  height /= weight;
  for (const Reading& r : all) scatter += r.weight * (r.height - height) * (r.height - height);
  const Cell cell = cell_of(all);
  CHECK(cell.points == 500.0f);
  CHECK(cell.weight == Approx(weight).epsilon(1e-5));
  CHECK(cell.height_m == Approx(height).margin(1e-6));
  CHECK(cell.dx_m == Approx(dx / weight).margin(1e-7));
  CHECK(cell.dy_m == Approx(dy / weight).margin(1e-7));
  CHECK(cell.scatter_m2 == Approx(scatter).epsilon(1e-4));
}

TEST_CASE("cell: the order of its points does not matter") {
  auto all = readings(200, 0.4, 0.01);
  const Cell forward = cell_of(all);
  std::reverse(all.begin(), all.end());
  const Cell backward = cell_of(all);
  CHECK(backward.height_m == Approx(forward.height_m).margin(1e-6));
  CHECK(backward.scatter_m2 == Approx(forward.scatter_m2).epsilon(1e-4));
  CHECK(backward.dx_m == Approx(forward.dx_m).margin(1e-7));
}

TEST_CASE("cell: the variance starts at the prior and ends at that of the points") {
  const CellPrior prior;
  Cell one;
  one.add(0.0f, 0.0f, 1.0f, 1.0f);
  CHECK(one.variance_m2(prior) == Approx(3.0f * 4e-4f / 4.0f));

  std::vector<Reading> all = readings(20000, 0.0, 0.05);
  for (Reading& r : all) r.weight = 1.0;
  // The relative standard deviation of a variance from n points is sqrt(2 / n); four of them are allowed.
  CHECK(cell_of(all).variance_m2(prior) == Approx(0.05 * 0.05).epsilon(4.0 * std::sqrt(2.0 / 20000.0)));
}

TEST_CASE("cell: points of one height leave no scatter, however high the cell lies") {
  Cell cell;
  for (int k = 0; k < 1000; ++k) cell.add(0.0f, 0.0f, 412.3f, 0.7f);
  CHECK(cell.height_m == 412.3f);
  CHECK(cell.scatter_m2 == 0.0f);
}

}  // namespace
}  // namespace curbline
