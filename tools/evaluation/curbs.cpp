#include "evaluation/curbs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace curbline::tools {
namespace {

constexpr double sample_step_m = 0.05;

struct Sample {
  double x_m, y_m;
  double share;  ///< 0 at the segment's start, 1 at its end
};

std::vector<Sample> samples(const Segment& s) {
  const double length = std::hypot(s.x1_m - s.x0_m, s.y1_m - s.y0_m);
  const int n = std::max(1, static_cast<int>(std::ceil(length / sample_step_m)));
  std::vector<Sample> out;
  for (int k = 0; k < n; ++k) {
    const double t = (k + 0.5) / n;
    out.push_back({s.x0_m + t * (s.x1_m - s.x0_m), s.y0_m + t * (s.y1_m - s.y0_m), t});
  }
  return out;
}

Segment line_of(const MapCurb& c) {
  return {c.x0_m, c.y0_m, c.x1_m, c.y1_m};
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(q * static_cast<double>(values.size() - 1)))];
}

/// A found sample and the true curb that it lies on.
struct Hit {
  std::size_t curb;
  double position_error_m, height_m, height_error_m;
};

std::optional<Hit> nearest(const Sample& p, double height_m, std::span<const TrueCurb> truth, double tolerance_m) {
  std::optional<Hit> hit;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Segment& s = truth[k].line;
    const double d = distance_m(p.x_m, p.y_m, s);
    if (d > tolerance_m || (hit && d >= hit->position_error_m)) continue;
    const double dx = s.x1_m - s.x0_m, dy = s.y1_m - s.y0_m;
    const double t =
        std::clamp(((p.x_m - s.x0_m) * dx + (p.y_m - s.y0_m) * dy) / std::max(1e-12, dx * dx + dy * dy), 0.0, 1.0);
    const double step = truth[k].step0_m + t * (truth[k].step1_m - truth[k].step0_m);
    hit = Hit{k, d, std::abs(height_m), std::abs(std::abs(height_m) - step)};
  }
  return hit;
}

std::vector<Hit> all_hits(std::span<const MapCurb> found, std::span<const TrueCurb> truth, double tolerance_m,
                          const std::function<bool(double, double)>& counts) {
  std::vector<Hit> hits;
  for (const MapCurb& curb : found) {
    for (const Sample& p : samples(line_of(curb))) {
      if (!counts(p.x_m, p.y_m)) continue;
      if (const auto hit = nearest(p, curb.height_m, truth, tolerance_m)) hits.push_back(*hit);
    }
  }
  return hits;
}

}  // namespace

double distance_m(double x_m, double y_m, const Segment& s) {
  const double dx = s.x1_m - s.x0_m, dy = s.y1_m - s.y0_m, length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((x_m - s.x0_m) * dx + (y_m - s.y0_m) * dy) / length2, 0.0, 1.0) : 0;
  return std::hypot(x_m - s.x0_m - t * dx, y_m - s.y0_m - t * dy);
}

Rates curb_rates(std::span<const MapCurb> found, std::span<const Segment> truth, double tolerance_m,
                 const std::function<bool(double, double)>& counts) {
  std::vector<Segment> lines;
  for (const MapCurb& curb : found) lines.push_back(line_of(curb));
  const auto share_near = [&](std::span<const Segment> of, std::span<const Segment> to) {
    double all = 0, near = 0;
    for (const Segment& s : of) {
      for (const Sample& p : samples(s)) {
        if (!counts(p.x_m, p.y_m)) continue;
        ++all;
        near += std::any_of(to.begin(), to.end(),
                            [&](const Segment& t) { return distance_m(p.x_m, p.y_m, t) <= tolerance_m; });
      }
    }
    return all > 0 ? near / all : 0.0;
  };
  Rates rates{share_near(lines, truth), share_near(truth, lines), 0};
  if (rates.precision + rates.recall > 0)
    rates.f1 = 2 * rates.precision * rates.recall / (rates.precision + rates.recall);
  return rates;
}

std::vector<CurbMatch> match_curbs(std::span<const MapCurb> found, std::span<const TrueCurb> truth, double tolerance_m,
                                   const std::function<bool(double, double)>& counts) {
  std::vector<CurbMatch> out(truth.size());
  const std::vector<Hit> hits = all_hits(found, truth, tolerance_m, counts);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const std::vector<Sample> line = samples(truth[k].line);
    const double length = std::hypot(truth[k].line.x1_m - truth[k].line.x0_m, truth[k].line.y1_m - truth[k].line.y0_m);
    double visible = 0, covered = 0;
    for (const Sample& p : line) {
      if (!counts(p.x_m, p.y_m)) continue;
      ++visible;
      covered += std::any_of(found.begin(), found.end(),
                             [&](const MapCurb& c) { return distance_m(p.x_m, p.y_m, line_of(c)) <= tolerance_m; });
    }
    out[k].visible_m = visible / static_cast<double>(line.size()) * length;
    out[k].covered = visible > 0 ? covered / visible : 0;
    std::vector<double> position, height, height_error;
    for (const Hit& hit : hits) {
      if (hit.curb != k) continue;
      position.push_back(hit.position_error_m);
      height.push_back(hit.height_m);
      height_error.push_back(hit.height_error_m);
    }
    out[k].position_error_m = quantile(position, 0.5);
    out[k].height_m = quantile(height, 0.5);
    out[k].height_error_m = quantile(height_error, 0.5);
  }
  return out;
}

ErrorSummary curb_errors(std::span<const MapCurb> found, std::span<const TrueCurb> truth, double tolerance_m,
                         const std::function<bool(double, double)>& counts) {
  std::vector<double> position, height;
  for (const Hit& hit : all_hits(found, truth, tolerance_m, counts)) {
    position.push_back(hit.position_error_m);
    height.push_back(hit.height_error_m);
  }
  return {quantile(position, 0.5), quantile(position, 0.95), quantile(height, 0.5), quantile(height, 0.95)};
}

}  // namespace curbline::tools
