#include "peers/polynomials.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "map/median.hpp"

namespace curbline::tools::peers {
namespace {

constexpr int trials = 300;
constexpr int terms = 4;  ///< coefficients of a cubic
constexpr double tolerance_m = 0.08, gap_m = 0.4, piece_m = 0.3;
constexpr std::size_t least_points = 8;

/// v = c0 + c1 u + c2 u^2 + c3 u^3 along its own axis.
struct Curve {
  double x_m = 0, y_m = 0, cos = 1, sin = 0;
  Eigen::Vector4d c = Eigen::Vector4d::Zero();
  double u(const EdgePoint& p) const { return cos * (p.x_m - x_m) + sin * (p.y_m - y_m); }
  double v(const EdgePoint& p) const { return cos * (p.y_m - y_m) - sin * (p.x_m - x_m); }
  double at(double along) const { return c[0] + along * (c[1] + along * (c[2] + along * c[3])); }
  double error(const EdgePoint& p) const { return std::abs(v(p) - at(u(p))); }
  EdgePoint point(double along) const {
    return {x_m + cos * along - sin * at(along), y_m + sin * along + cos * at(along), 0};
  }
};

using Points = std::vector<EdgePoint>;

/// Least squares, with the axis from the first to the last point.
Curve fit(const Points& points, const EdgePoint& from, const EdgePoint& to) {
  Curve curve;
  const double length = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
  curve.x_m = from.x_m;
  curve.y_m = from.y_m;
  curve.cos = length > 0 ? (to.x_m - from.x_m) / length : 1;
  curve.sin = length > 0 ? (to.y_m - from.y_m) / length : 0;
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd powers(n, terms);
  Eigen::VectorXd across(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const EdgePoint& p = points[static_cast<std::size_t>(k)];
    const double u = curve.u(p);
    powers.row(k) << 1, u, u * u, u * u * u;
    across[k] = curve.v(p);
  }
  curve.c = powers.colPivHouseholderQr().solve(across);
  return curve;
}

/// The two points with the largest distance; for few points.
std::pair<EdgePoint, EdgePoint> ends_of(const Points& points) {
  std::pair<EdgePoint, EdgePoint> ends{points.front(), points.back()};
  double longest = 0;
  for (std::size_t a = 0; a < points.size(); ++a) {
    for (std::size_t b = a + 1; b < points.size(); ++b) {
      const double length = std::hypot(points[a].x_m - points[b].x_m, points[a].y_m - points[b].y_m);
      if (length <= longest) continue;
      longest = length;
      ends = {points[a], points[b]};
    }
  }
  return ends;
}

/// The points near the curve that are not separated by a gap from the middle of the points through which it was fitted,
/// in order along it.
Points on_curve(const Points& points, const Curve& curve, double middle_u) {
  Points near;
  for (const EdgePoint& p : points) {
    if (curve.error(p) <= tolerance_m) near.push_back(p);
  }
  std::sort(near.begin(), near.end(), [&](auto& a, auto& b) { return curve.u(a) < curve.u(b); });
  const auto apart = [&](const EdgePoint& a, const EdgePoint& b) { return curve.u(b) - curve.u(a) > gap_m; };
  auto first = near.begin();
  for (auto end = first; first != near.end(); first = end) {
    end = std::adjacent_find(first, near.end(), apart);
    if (end != near.end()) ++end;
    if (curve.u(*(end - 1)) >= middle_u) return {first, end};
  }
  return {};
}

Points best_run(const Points& points, std::mt19937& random) {
  Points best;
  for (int trial = 0; trial < trials; ++trial) {
    Points drawn;
    for (int k = 0; k < terms; ++k) drawn.push_back(points[random() % points.size()]);
    const auto [from, to] = ends_of(drawn);
    const double length = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    if (length < gap_m) continue;
    Points run = on_curve(points, fit(drawn, from, to), 0.5 * length);
    if (run.size() > best.size()) best = std::move(run);
  }
  return best;
}

void give_out(const Points& run, std::vector<MapCurb>& out) {
  const auto [from, to] = ends_of(run);
  const Curve curve = fit(run, from, to);
  double first = curve.u(run.front()), last = first;
  for (const EdgePoint& p : run) {
    first = std::min(first, curve.u(p));
    last = std::max(last, curve.u(p));
  }
  const int pieces = std::max(1, static_cast<int>(std::ceil((last - first) / piece_m)));
  for (int k = 0; k < pieces; ++k) {
    const double u0 = first + (last - first) * k / pieces, u1 = first + (last - first) * (k + 1) / pieces;
    std::vector<double> heights;
    for (const EdgePoint& p : run) {
      if (curve.u(p) >= u0 - piece_m / 2 && curve.u(p) <= u1 + piece_m / 2) heights.push_back(p.height_m);
    }
    if (heights.empty()) continue;
    const double height_m = median(std::move(heights));
    const EdgePoint a = curve.point(u0), b = curve.point(u1);
    out.push_back({a.x_m, a.y_m, b.x_m, b.y_m, height_m, 0, 1, height_m > 0 ? "step_up" : "step_down"});
  }
}

}  // namespace

std::vector<MapCurb> polynomial_curbs(Points points) {
  std::mt19937 random(1);
  std::vector<MapCurb> out;
  while (points.size() >= least_points) {
    const Points run = best_run(points, random);
    if (run.size() < least_points) break;
    give_out(run, out);
    std::erase_if(points, [&](const EdgePoint& p) {
      return std::any_of(run.begin(), run.end(), [&](const EdgePoint& q) { return p.x_m == q.x_m && p.y_m == q.y_m; });
    });
  }
  return out;
}

}  // namespace curbline::tools::peers
