// The evidence of planes, against its definition from all points at once in double precision, and what parts two of
// them.
#include "curbline/regions/plane_evidence.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "support/moments.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

using test::Noise;
using test::of_points;
using test::Patch;

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

/// By how much one plane is more evident than two, if nothing is seen of the border between them.
float gain_of_one(const PlaneEvidence& evidence, const PlaneMoments& first, const PlaneMoments& second) {
  PlaneMoments both = first;
  both.add(second);
  return evidence.gain(first, evidence.score(first), second, evidence.score(second), both, [] { return BorderRise{}; });
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
    return gain_of_one(evidence, first, second);
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
    return gain_of_one(evidence, face, above);
  };
  CHECK(gain([](double x, double) { return x < 0.3 ? 0.35 * x : 0.105 + 0.07 * (x - 0.3); }) < 0.0f);
  CHECK(gain([](double x, double) { return x < 0.3 ? 0.07 * x : 0.021 - 0.20 * (x - 0.3); }) < 0.0f);
  CHECK(gain([](double x, double) { return 0.05 * x * x; }) > 0.0f);
  CHECK(gain([](double x, double) { return 0.07 * x; }) > 0.0f);
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
    return gain_of_one(evidence, face, above);
  };
  CHECK(gain(0.35, 0.07) < 0.0f);
  CHECK(gain(0.07, 0.07) > 0.0f);
}

}  // namespace
}  // namespace curbline
