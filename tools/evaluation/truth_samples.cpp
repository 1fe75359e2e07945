#include "evaluation/truth_samples.hpp"

#include <algorithm>
#include <cmath>

namespace curbline::tools {
namespace {

constexpr double aside_m = 0.2;

}  // namespace

Segment line_of(const TruthCurb& curb) {
  return {curb.from.x, curb.from.y, curb.to.x, curb.to.y};
}

std::vector<TruthSample> truth_samples(const Truth& truth) {
  std::vector<TruthSample> out;
  for (std::size_t k = 0; k < truth.curbs.size(); ++k) {
    const TruthCurb& curb = truth.curbs[k];
    const double dx = curb.to.x - curb.from.x, dy = curb.to.y - curb.from.y, length = std::hypot(dx, dy);
    if (curb.kind != "step" || length <= 0) continue;
    const double rise_m = curb.to_step_m - curb.from_step_m;
    for (const auto& [at, share] : samples_of(line_of(curb))) {
      if (truth.obstacle_at(at.x, at.y)) continue;
      out.push_back({k, at, {-dy / length, dx / length}, curb.from_step_m + share * rise_m, rise_m / length});
    }
  }
  return out;
}

bool visible(const TruthSample& s, const Seen& seen) {
  const Point2 left = s.at + aside_m * s.to_left, right = s.at - aside_m * s.to_left;
  return seen(s.at.x, s.at.y) && seen(left.x, left.y) && seen(right.x, right.y);
}

double signed_step_m(const TruthSample& s, Point2 toward) {
  return dot(toward, s.to_left) < 0 ? -s.step_m : s.step_m;
}

Detections::Detections(const Truth& truth) : samples_(truth_samples(truth)), of_curbs_(truth.curbs.size()) {}

void Detections::observe(double time_s, Point2 robot, const Bounds& window, const Seen& seen,
                         std::span<const MapCurb> curbs) {
  for (const TruthSample& s : samples_) {
    Detection& detection = of_curbs_[s.curb];
    if (detection.found_s || s.at.x < window.x0 || s.at.x > window.x1 || s.at.y < window.y0 || s.at.y > window.y1) {
      continue;
    }
    if (!detection.seen_s && visible(s, seen)) detection.seen_s = time_s;
    const bool found = std::any_of(curbs.begin(), curbs.end(), [&](const MapCurb& c) {
      return is_step(c) && distance_m(s.at.x, s.at.y, line_of(c)) <= tolerance_m;
    });
    if (!found) continue;
    if (!detection.seen_s) detection.seen_s = time_s;
    detection.found_s = time_s;
    detection.distance_m = length(s.at - robot);
  }
}

}  // namespace curbline::tools
