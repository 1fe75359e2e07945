// Moments and fit of planes, against the same formulas from all points at once in double precision.
#include "curbline/plane.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "curbline/regions/plane_evidence.hpp"
#include "support/moments.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

using test::Noise;
using test::of_point;
using test::of_points;

/// A prior under which points without noise give a plane without noise.
PlanePrior no_floor() {
  PlanePrior prior;
  prior.common_share = 0.0f;
  return prior;
}

TEST_CASE("plane moments: merged, they are those of the union") {
  Noise noise;
  const auto left = test::sample({0, 1, 0, 1}, 0.1, 0.01, noise, [](double x, double y) { return 0.2 * x - 0.1 * y; });
  const auto right = test::sample({1, 2, -1, 1}, 0.1, 0.01, noise, [](double, double) { return 0.3; });
  std::vector<Point> both = left;
  both.insert(both.end(), right.begin(), right.end());
  PlaneMoments merged = of_points(left);
  merged.add(of_points(right));

  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Point& p : both) mean += Eigen::Vector3d(p.x_m, p.y_m, p.z_m) / static_cast<double>(both.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Point& p : both) {
    const Eigen::Vector3d d = Eigen::Vector3d(p.x_m, p.y_m, p.z_m) - mean;
    scatter += d * d.transpose();
  }
  CHECK(merged.points == 300.0f);
  CHECK(merged.cells == 300.0f);
  CHECK(merged.weight == 300.0f);
  CHECK(merged.x == Approx(mean.x()).margin(1e-6));
  CHECK(merged.y == Approx(mean.y()).margin(1e-6));
  CHECK(merged.z == Approx(mean.z()).margin(1e-6));
  CHECK(merged.xx == Approx(scatter(0, 0)).epsilon(1e-5));
  CHECK(merged.xy == Approx(scatter(0, 1)).epsilon(1e-5));
  CHECK(merged.yy == Approx(scatter(1, 1)).epsilon(1e-5));
  CHECK(merged.xz == Approx(scatter(0, 2)).epsilon(1e-5));
  CHECK(merged.yz == Approx(scatter(1, 2)).epsilon(1e-5));
  CHECK(merged.zz == Approx(scatter(2, 2)).epsilon(1e-5));
}

TEST_CASE("plane moments: a point of weight two counts as two points there") {
  const Point p{0.3f, -0.2f, 0.1f}, q{1.0f, 0.5f, 0.0f};
  PlaneMoments twice = of_points({p, p, q}), heavy = of_point(p, 2.0f);
  heavy.add(of_point(q));
  CHECK(heavy.x == Approx(twice.x));
  CHECK(heavy.z == Approx(twice.z));
  CHECK(heavy.xz == Approx(twice.xz));
  CHECK(heavy.zz == Approx(twice.zz));
}

TEST_CASE("plane moments: nothing added to nothing is nothing, not NaN") {
  PlaneMoments m;
  m.add(PlaneMoments{});
  m.add_cell(PlaneMoments{});
  CHECK(m.weight == 0.0f);
  CHECK(m.x == 0.0f);
}

TEST_CASE("plane fit: recovers level, slopes and noise within their standard deviations") {
  Noise noise;
  const double sd = 0.008;
  const auto points =
      test::sample({0, 4, -2, 2}, 0.1, sd, noise, [](double x, double y) { return -0.88 + 0.07 * x - 0.02 * y; });
  const auto n = static_cast<float>(points.size());
  const Plane plane = fit_plane(of_points(points), no_floor());
  const double level_sd = sd / std::sqrt(n), slope_sd = level_sd / std::sqrt(16.0 / 12.0);
  CHECK(plane.alive());
  CHECK(plane.height_m(2.0f, 0.0f) == Approx(-0.74).margin(4 * level_sd));
  CHECK(plane.slope_x == Approx(0.07).margin(4 * slope_sd));
  CHECK(plane.slope_y == Approx(-0.02).margin(4 * slope_sd));
  CHECK(plane.variance_m2 == Approx(sd * sd).epsilon(4 * std::sqrt(2.0 / n)));
}

TEST_CASE("plane fit: no plane is known better than what the points of a cell share") {
  Noise noise;
  const auto points = test::sample({0, 1, 0, 1}, 0.1, 0.0, noise, [](double, double) { return 0.0; });
  const PlanePrior prior;
  CHECK(fit_plane(of_points(points), prior).variance_m2 == prior.common_share * prior.noise_m2);
}

TEST_CASE("plane fit: of the mean heights of cells the stated variance is that of such a mean") {
  Noise noise;
  const double sd = 0.004;
  const auto variance_m2 = [&](double side_m, float common_m2) {
    float mean_m2 = 0.0f;
    for (int k = 0; k < 400; ++k) {
      const PlaneMoments moments =
          of_points(test::sample({0, side_m, 0, side_m}, 0.1, sd, noise, [](double, double) { return 0.0; }));
      mean_m2 += fit_plane_to_means(moments, no_floor(), common_m2).fit_variance_m2 / 400.0f;
    }
    return mean_m2;
  };
  CHECK(variance_m2(1.0, 0.0f) == Approx(sd * sd).epsilon(0.05));
  CHECK(variance_m2(0.5, 0.0f) == Approx(sd * sd).epsilon(0.05));  // three of 25 have gone into the plane
  CHECK(variance_m2(1.0, 1e-4f) == Approx(1e-4));
}

TEST_CASE("plane fit: what a row of cells leaves open of its slope is no steeper than a ramp") {
  Noise noise;
  const auto points = test::sample({0, 0.01, 0, 1}, 0.01, 0.01, noise, [](double, double) { return 0.0; });
  const Plane plane = fit_plane(of_points(points), PlanePrior{});
  const float beside_m = 0.1f;
  CHECK(std::abs(plane.slope_x) < steepest_ramp);
  CHECK(plane.rise_variance_m2(beside_m, 0.0f) < std::pow(1.1f * steepest_ramp * beside_m, 2.0f));
  CHECK(plane.rise_variance_m2(beside_m, 0.0f) > std::pow(0.5f * steepest_ramp * beside_m, 2.0f));
}

TEST_CASE("plane fit: the height is best known at the centroid and worse the further away") {
  Noise noise;
  const auto points = test::sample({0, 2, 0, 1}, 0.1, 0.01, noise, [](double x, double) { return 0.1 * x; });
  const Plane plane = fit_plane(of_points(points), no_floor());
  const float centre = plane.height_variance_m2(plane.x_m, plane.y_m);
  CHECK(centre == Approx(plane.variance_m2 / 200.0f));
  CHECK(plane.height_variance_m2(plane.x_m + 1.0f, plane.y_m) > centre);
  CHECK(plane.height_variance_m2(plane.x_m + 2.0f, plane.y_m) > plane.height_variance_m2(plane.x_m + 1.0f, plane.y_m));
  // Known less well across its short side: 4 times the variance of a slope over half the length.
  CHECK(plane.height_variance_m2(plane.x_m, plane.y_m + 1.0f) - centre ==
        Approx(4.0f * (plane.height_variance_m2(plane.x_m + 1.0f, plane.y_m) - centre)).epsilon(0.15));
}

TEST_CASE("plane fit: the stated variance of a height is the one that repeated fits show") {
  Noise noise;
  const int fits = 2000;
  double sum = 0.0, sum2 = 0.0, stated = 0.0;
  for (int k = 0; k < fits; ++k) {
    const auto points = test::sample({0, 1, 0, 1}, 0.1, 0.01, noise, [](double, double) { return 0.0; });
    const Plane plane = fit_plane(of_points(points), no_floor());
    const double height = plane.height_m(1.5f, 0.5f);
    sum += height;
    sum2 += height * height;
    stated += plane.height_variance_m2(1.5f, 0.5f) / fits;
  }
  const double variance = sum2 / fits - sum / fits * sum / fits;
  CHECK(stated == Approx(variance).epsilon(4.0 * std::sqrt(2.0 / fits)));
}

TEST_CASE("plane fit: far from the origin it keeps its digits") {
  Noise noise;
  const auto points =
      test::sample({0, 2, 0, 2}, 0.1, 0.005, noise, [](double x, double y) { return 0.05 * x + 0.02 * y; });
  // Shifts that float can add exactly to rounded coordinates, so that both sets are the same points.
  std::vector<Point> near_by = points, far_away;
  for (Point& p : near_by) {
    p.x_m = std::round(p.x_m * 1024.0f) / 1024.0f;
    p.y_m = std::round(p.y_m * 1024.0f) / 1024.0f;
    p.z_m = std::round(p.z_m * 16384.0f) / 16384.0f;
    far_away.push_back({p.x_m + 1024.0f, p.y_m - 2048.0f, p.z_m + 128.0f, p.variance_m2});
  }
  const PlanePrior prior;
  const PlaneMoments a = of_points(near_by), b = of_points(far_away);
  CHECK(PlaneEvidence(prior).log_evidence(b) == Approx(PlaneEvidence(prior).log_evidence(a)).margin(0.5));
  const Plane p = fit_plane(a, prior), q = fit_plane(b, prior);
  CHECK(q.slope_x == Approx(p.slope_x).margin(1e-4));
  CHECK(q.slope_y == Approx(p.slope_y).margin(1e-4));
  CHECK(q.height_m(1025.0f, -2047.0f) == Approx(p.height_m(1.0f, 1.0f) + 128.0f).margin(1e-4));
}

TEST_CASE(
    "plane: of a thin strip of many points, across the axes, the height's variance is a number, and least in its "
    "middle") {
  for (const double weight : {10.0, 1000.0, 20000.0}) {
    PlaneMoments moments;
    for (int k = -20; k < 20; ++k) {
      PlaneMoments cell;
      cell.x = static_cast<float>(1 + 0.0707 * k);
      cell.y = static_cast<float>(2 + 0.0707 * k);
      cell.weight = cell.points = static_cast<float>(weight);
      cell.cells = 1;
      moments.add_cell(cell);
    }
    const Plane plane = fit_plane(moments, {});
    for (float x = -1; x < 5; x += 0.1f) {
      for (float y = 0; y < 4; y += 0.1f) CHECK(plane.height_variance_m2(x, y) >= plane.variance_m2 / 40);
    }
  }
}

TEST_CASE("plane: steeper than ground, how high above another, how wrong some way off, are told in any direction") {
  const auto leaning = [](float slope_x, float slope_y) {
    Plane plane;
    plane.slope_x = slope_x;
    plane.slope_y = slope_y;
    return plane;
  };
  for (const float sign : {-1.0f, 1.0f}) {
    CHECK_FALSE(leaning(sign * 0.37f, 0.0f).steeper_than_ground());
    CHECK_FALSE(leaning(0.0f, sign * 0.37f).steeper_than_ground());
    CHECK(leaning(sign * 0.38f, 0.0f).steeper_than_ground());
    CHECK(leaning(0.0f, sign * 0.38f).steeper_than_ground());
    CHECK(leaning(sign * 0.3f, 0.3f).steeper_than_ground());
  }
  Plane ground = leaning(0.1f, -0.2f), box;
  ground.z_m = 1.0f;
  box.x_m = 2.0f;
  box.y_m = 3.0f;
  box.z_m = 1.5f;
  CHECK(box.above_m(ground) == Approx(1.5 - (1.0 + 0.2 - 0.6)));
  Plane known;
  known.fit_variance_m2 = 1e-4f;
  known.pxx = 0.5f;
  known.pxy = -0.3f;
  known.pyy = 0.7f;
  CHECK(known.rise_variance_m2(2.0f, 1.0f) == Approx(1e-4 * (4 * 0.5 - 2 * 2 * 0.3 + 0.7)));
}

}  // namespace
}  // namespace curbline
