// Moments, evidence and fit of planes, against the same formulas from all points at once in double precision.
#include "curbline/plane.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "curbline/regions/plane_evidence.hpp"
#include "support/moments.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

using test::Noise;
using test::of_point;
using test::of_points;
using test::Patch;

/// A prior under which points without noise give a plane without noise.
PlanePrior no_floor() {
  PlanePrior prior;
  prior.common_share = 0.0f;
  return prior;
}

/// ln p(z | points on one plane), normal-inverse-gamma: noise ~ IG(a0, a0 V0), level and slopes ~ N((mean z, 0, 0),
/// noise / V0) around the centroid; plus (n / 2) ln(2 pi V0), the part that log_evidence() leaves out.
double evidence_by_definition(const std::vector<Point>& points, const PlanePrior& prior) {
  const double V0 = prior.noise_m2, a0 = prior.degrees, b0 = a0 * V0, n = static_cast<double>(points.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Point& p : points) mean += Eigen::Vector3d(p.x_m, p.y_m, p.z_m) / n;
  const Eigen::Matrix3d L0 = V0 * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d m0(mean.z(), 0.0, 0.0);
  Eigen::Matrix3d L = L0;
  Eigen::Vector3d r = L0 * m0;
  double q = m0.dot(L0 * m0);
  for (const Point& p : points) {
    const Eigen::Vector3d phi(1.0, p.x_m - mean.x(), p.y_m - mean.y());
    L += phi * phi.transpose();
    r += phi * static_cast<double>(p.z_m);
    q += static_cast<double>(p.z_m) * static_cast<double>(p.z_m);
  }
  q -= r.dot(L.ldlt().solve(r));
  const double a = a0 + 0.5 * n, b = b0 + 0.5 * q;
  return 0.5 * (std::log(L0.determinant()) - std::log(L.determinant())) + a0 * std::log(b0) - a * std::log(b) +
         std::lgamma(a) - std::lgamma(a0) + 0.5 * n * std::log(V0);
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

TEST_CASE("plane evidence: agrees with its definition, from one point to as many as a window has") {
  const double spacing = GENERATE(2.0, 0.9, 0.5, 0.1, 0.04);
  const double sd = GENERATE(0.002, 0.01, 0.1);
  Noise noise;
  const auto points =
      test::sample({1, 3, -1, 1}, spacing, sd, noise, [](double x, double y) { return -0.9 + 0.07 * x - 0.03 * y; });
  const PlanePrior prior;
  const double truth = evidence_by_definition(points, prior);
  const PlaneMoments m = of_points(points);
  // Stirling's series up to 1 / x leaves 1 / (360 x^3) at x = 2.5. Float leaves 1e-6 of the scatter of z in the
  // residual, which enters as shape * ln(rate).
  const double n = static_cast<double>(points.size()), V0 = prior.noise_m2;
  const double shape = 2.0 + 0.5 * n, rate = 2.0 + 0.5 * n * sd * sd / V0;
  INFO(points.size() << " points, noise " << sd);
  CHECK(PlaneEvidence(prior).log_evidence(m) ==
        Approx(truth).margin(1e-3 + shape / rate * 0.5e-6 * static_cast<double>(m.zz) / V0 + 1e-6 * std::abs(truth)));
}

TEST_CASE("plane evidence: two halves of a plane gain by merging, two sides of a step lose") {
  Noise noise;
  const PlaneEvidence evidence;
  const auto gain = [&](double step_m) {
    const auto low = test::sample({0, 1, 0, 1}, 0.1, 0.01, noise, [](double x, double) { return 0.05 * x; });
    const auto high = test::sample({1, 2, 0, 1}, 0.1, 0.01, noise, [&](double x, double) { return 0.05 * x + step_m; });
    PlaneMoments both = of_points(low);
    both.add(of_points(high));
    return evidence.log_evidence(both) - evidence.log_evidence(of_points(low)) - evidence.log_evidence(of_points(high));
  };
  CHECK(gain(0.0) > 0.0f);
  CHECK(gain(0.10) < 0.0f);
  CHECK(gain(-0.10) < 0.0f);
}

//  ___________                                  __-------__
//             |___________  2.5 cm: two        _-           -_  bent by as much: one
TEST_CASE("plane evidence: a low curb along two wide pavements parts them, ground that bends as much is one") {
  Noise noise;
  const PlaneEvidence evidence;
  const auto gain = [&](auto&& height_m) {
    const PlaneMoments first = of_points(test::sample({0, 2, 0, 4}, 0.1, 0.007, noise, height_m));
    const PlaneMoments second = of_points(test::sample({2, 4, 0, 4}, 0.1, 0.007, noise, height_m));
    PlaneMoments both = first;
    both.add(second);
    return evidence.gain(first, evidence.score(first), second, evidence.score(second), both,
                         [] { return BorderRise{}; });
  };
  const auto kerb = [](double height_m) {
    return [=](double x, double) { return 0.02 * x + (x < 2.0 ? 0.0 : height_m); };
  };
  CHECK(gain(kerb(0.0)) > 0.0f);
  CHECK(gain(kerb(0.01)) > 0.0f);
  CHECK(gain(kerb(0.025)) < 0.0f);
  CHECK(gain(kerb(-0.025)) < 0.0f);
  CHECK(gain([](double x, double) { return 0.01 * (x - 2.0) * (x - 2.0); }) > 0.0f);
}

//                    __--
//  ________________|--   2.5 cm, of which the planes show 3 mm at the middle of one of them: the border shows it
TEST_CASE("plane evidence: a low curb between planes of different slope parts them, if the ground jumps along it") {
  Noise noise;
  const PlaneEvidence evidence;
  const auto height_m = [](double x, double) { return x < 2.0 ? 0.0 : 0.025 + 0.022 * (x - 2.0); };
  const PlaneMoments first = of_points(test::sample({0, 2, 0, 4}, 0.1, 0.007, noise, height_m));
  const PlaneMoments second = of_points(test::sample({2, 4, 0, 4}, 0.1, 0.007, noise, height_m));
  const auto parted = [&](float pairs, float rise_m) {
    const BorderRise border{pairs, 0.1f, 0.0f, rise_m}, back{pairs, -0.1f, 0.0f, -rise_m};
    CHECK(evidence.parted(first, second, border) == evidence.parted(second, first, back));
    return evidence.parted(first, second, border);
  };
  CHECK_FALSE(parted(0.0f, 0.0f));
  CHECK(parted(40.0f, 0.0125f));         // as many cells with points of both sides as without
  CHECK_FALSE(parted(40.0f, 0.0011f));   // bent ground
  CHECK_FALSE(parted(40.0f, -0.0125f));  // a step the other way
  CHECK_FALSE(parted(40.0f, 0.006f));    // no more than the cells of a scan line share
  CHECK_FALSE(parted(4.0f, 0.0125f));    // too few to show it
}

//        _______________                          __-------__
//      _-      a curb's sloped face, 30 cm      _-           -_  bent, 10 m to its centre: one
//    _-        wide, and the ground above: two
TEST_CASE("plane evidence: a crease parts two planes, ground that bends over the same distance is one") {
  Noise noise;
  const PlaneEvidence evidence;
  const auto gain = [&](auto&& height_m) {
    const PlaneMoments face = of_points(test::sample({0, 0.3, 0, 2.0}, 0.1, 0.012, noise, height_m));
    const PlaneMoments above = of_points(test::sample({0.3, 0.7, 0, 2.0}, 0.1, 0.012, noise, height_m));
    PlaneMoments both = face;
    both.add(above);
    return evidence.gain(face, evidence.score(face), above, evidence.score(above), both, [] { return BorderRise{}; });
  };
  CHECK(gain([](double x, double) { return x < 0.3 ? 0.35 * x : 0.105 + 0.07 * (x - 0.3); }) < 0.0f);
  CHECK(gain([](double x, double) { return x < 0.3 ? 0.07 * x : 0.021 - 0.20 * (x - 0.3); }) < 0.0f);
  CHECK(gain([](double x, double) { return 0.05 * x * x; }) > 0.0f);
  CHECK(gain([](double x, double) { return 0.07 * x; }) > 0.0f);
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

TEST_CASE("plane evidence: on a hill, too, a low curb parts planes if the ground jumps by more than the hill rises") {
  const bool along_y = GENERATE(false, true);
  const double hill = GENERATE(0.1, -0.1);
  Noise noise;
  const PlaneEvidence evidence;
  const auto height_m = [=](double x, double y) {
    const double across = along_y ? y : x;
    return hill * across + (across < 2.0 ? 0.0 : 0.025 + 0.022 * (across - 2.0));
  };
  const auto points = [&](double from, double to) {
    return of_points(
        test::sample(along_y ? Patch{0, 4, from, to} : Patch{from, to, 0, 4}, 0.1, 0.007, noise, height_m));
  };
  const PlaneMoments first = points(0, 2), second = points(2, 4);
  const auto parted = [&](double jump_m) {
    const auto rise_m = static_cast<float>(0.1 * (hill + 0.011) + jump_m);  // of a cell, by the mean slope, plus more
    return evidence.parted(first, second, {40.0f, along_y ? 0.0f : 0.1f, along_y ? 0.1f : 0.0f, rise_m});
  };
  CHECK(parted(0.0125));
  CHECK_FALSE(parted(0.004));
  CHECK_FALSE(parted(0.0));
  CHECK_FALSE(parted(-0.0125));
}

TEST_CASE("plane evidence: a crease parts two planes whatever way it runs") {
  const double turn = GENERATE(0.0, 0.8, 1.5708);
  Noise noise;
  const PlaneEvidence evidence;
  const auto gain = [&](double before, double behind) {
    std::vector<Point> points[2];
    const auto across = [&](double x, double y) { return x * std::cos(turn) + y * std::sin(turn); };
    for (const Point& p : test::sample({-1, 1, -1, 1}, 0.1, 0.012, noise, [&](double x, double y) {
           return (across(x, y) < 0.0 ? before : behind) * across(x, y);
         })) {
      const double at = across(static_cast<double>(p.x_m), static_cast<double>(p.y_m));
      if (at > -0.3 && at < 0.4) points[at < 0.0 ? 0 : 1].push_back(p);
    }
    const PlaneMoments face = of_points(points[0]), above = of_points(points[1]);
    PlaneMoments both = face;
    both.add(above);
    return evidence.gain(face, evidence.score(face), above, evidence.score(above), both, [] { return BorderRise{}; });
  };
  CHECK(gain(0.35, 0.07) < 0.0f);
  CHECK(gain(0.07, 0.07) > 0.0f);
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
