#include "evaluation/curbs.hpp"

#include <algorithm>
#include <cmath>

namespace curbline::tools {

Segment line_of(const MapCurb& curb) {
  return {curb.x0_m, curb.y0_m, curb.x1_m, curb.y1_m};
}

std::vector<SegmentSample> samples_of(const Segment& s) {
  const double length = std::hypot(s.x1_m - s.x0_m, s.y1_m - s.y0_m);
  const int n = std::max(1, static_cast<int>(std::ceil(length / spacing_m)));
  std::vector<SegmentSample> out;
  for (int k = 0; k < n; ++k) {
    const double t = (k + 0.5) / n;
    out.push_back({{s.x0_m + t * (s.x1_m - s.x0_m), s.y0_m + t * (s.y1_m - s.y0_m)}, t});
  }
  return out;
}

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
      for (const SegmentSample& sample : samples_of(s)) {
        const Point2 p = sample.at;
        if (!counts(p.x, p.y)) continue;
        ++all;
        near +=
            std::any_of(to.begin(), to.end(), [&](const Segment& t) { return distance_m(p.x, p.y, t) <= tolerance_m; });
      }
    }
    return all > 0 ? near / all : 0.0;
  };
  Rates rates{share_near(lines, truth), share_near(truth, lines), 0};
  if (rates.precision + rates.recall > 0)
    rates.f1 = 2 * rates.precision * rates.recall / (rates.precision + rates.recall);
  return rates;
}

}  // namespace curbline::tools
