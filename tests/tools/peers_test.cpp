// Curbs by gradients, and by Canny's edges with polynomials.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "peers/peers.hpp"
#include "peers/polynomials.hpp"

namespace curbline::tools::peers {
namespace {

const Grid grid{0, -2, 0.1, 0.1, 40, 40};

std::vector<Point3> cloud_of(const std::function<double(double, double)>& height) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise_m(0, 0.004);
  std::vector<Point3> cloud;
  for (double x = 0.0125; x < 4; x += 0.025) {
    for (double y = -1.9875; y < 2; y += 0.025) cloud.push_back({x, y, height(x, y) + noise_m(random)});
  }
  return cloud;
}

std::vector<MapCurb> curbs_of(Method method, const std::function<double(double, double)>& height) {
  return map_cloud(cloud_of(height), grid, 1e9, method).curbs;
}

/// Length of the pieces within 6 cm of a line, and of all pieces.
struct Lengths {
  double near_m = 0, all_m = 0;
};

Lengths lengths(const std::vector<MapCurb>& curbs, const std::function<double(double, double)>& distance_m) {
  Lengths out;
  for (const MapCurb& c : curbs) {
    const double length = std::hypot(c.x1_m - c.x0_m, c.y1_m - c.y0_m);
    out.all_m += length;
    if (distance_m((c.x0_m + c.x1_m) / 2, (c.y0_m + c.y1_m) / 2) < 0.06) out.near_m += length;
  }
  return out;
}

double step_up(double x, double) {
  return x < 2 ? 0 : 0.12;
}

}  // namespace

TEST_CASE("peers: a step of 12 cm across the window is found along its whole length with its height") {
  for (const Method method : {Method::gradient, Method::canny}) {
    const std::vector<MapCurb> curbs = curbs_of(method, step_up);
    const Lengths found = lengths(curbs, [](double x, double) { return std::abs(x - 2); });
    CAPTURE(static_cast<int>(method));
    CHECK(found.near_m > 3.5);
    CHECK(found.all_m == Approx(found.near_m));
    for (const MapCurb& c : curbs) {
      CHECK(c.kind == "step_up");
      CHECK(c.height_m == Approx(0.12).margin(0.015));
    }
  }
}

TEST_CASE("peers: a step down is one as seen from the origin") {
  for (const Method method : {Method::gradient, Method::canny}) {
    for (const MapCurb& c : curbs_of(method, [](double x, double) { return x < 2 ? 0 : -0.1; })) {
      CHECK(c.kind == "step_down");
    }
  }
}

TEST_CASE("peers: level ground, a ramp of 6 % and a wall of half a metre are no curbs") {
  for (const Method method : {Method::gradient, Method::canny}) {
    CAPTURE(static_cast<int>(method));
    CHECK(curbs_of(method, [](double, double) { return 0.0; }).empty());
    CHECK(curbs_of(method, [](double x, double) { return 0.06 * x; }).empty());
    CHECK(lengths(curbs_of(method, [](double x, double) { return x < 2.2 ? 0 : 0.5; }), [](double, double) {
            return 0;
          }).all_m < 0.5);
  }
}

TEST_CASE("canny: a bend is followed to less than a cell") {
  const auto from_arc = [](double x, double y) { return std::abs(std::hypot(x - 2, y + 3) - 3); };
  const std::vector<MapCurb> curbs =
      curbs_of(Method::canny, [](double x, double y) { return std::hypot(x - 2, y + 3) < 3 ? 0.1 : 0; });
  const Lengths found = lengths(curbs, from_arc);
  CHECK(found.near_m > 3);
  CHECK(found.near_m > 0.9 * found.all_m);
}

TEST_CASE("peers: a map without points has no curbs") {
  for (const Method method : {Method::gradient, Method::canny}) CHECK(map_cloud({}, grid, 1, method).curbs.empty());
}

TEST_CASE("polynomials: two lines are two curves, outliers none") {
  std::vector<EdgePoint> points;
  for (int k = 0; k < 30; ++k) {
    points.push_back({0.1 * k, 0.5, 0.1});
    points.push_back({0.1 * k, 1.5 + 0.02 * k, -0.05});
  }
  points.push_back({1.0, 1.0, 0.2});
  double up_m = 0, down_m = 0;
  for (const MapCurb& c : polynomial_curbs(points)) {
    (c.height_m > 0 ? up_m : down_m) += std::hypot(c.x1_m - c.x0_m, c.y1_m - c.y0_m);
  }
  CHECK(up_m == Approx(2.9).margin(0.1));
  CHECK(down_m == Approx(2.96).margin(0.1));
}

TEST_CASE("polynomials: the same points give the same curbs, and a few points none") {
  CHECK(polynomial_curbs({{0, 0, 0.1}, {1, 0, 0.1}, {2, 0, 0.1}}).empty());
  CHECK(polynomial_curbs(std::vector<EdgePoint>(20, EdgePoint{1, 1, 0.1})).empty());
}

}  // namespace curbline::tools::peers
