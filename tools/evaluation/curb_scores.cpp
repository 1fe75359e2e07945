#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "evaluation/scores.hpp"

namespace curbline::tools {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double band_tolerance_m = 0.1, match_tolerance_m = 0.15;
constexpr std::array<double, 4> tolerances_m{0.05, 0.1, 0.15, 0.3};
constexpr double reach_m = tolerances_m.back() + spacing_m;
constexpr double least_m = 0.01;  // of a true step: below this there is nothing to be found
constexpr double low_m = 0.02, high_m = 0.04;

/// A place on a found step, compared with the nearest true step.
struct FoundSample {
  double height_m = 0;
  double distance_m = std::numeric_limits<double>::infinity();
  double height_error_m = nan;  ///< found minus true
};

/// Across a curb's line, away from the robot.
Point2 to_far_side(const MapCurb& c, const std::optional<Point2>& robot) {
  const Point2 left{c.y0_m - c.y1_m, c.x1_m - c.x0_m};
  const bool left_is_near = robot && dot(*robot - Point2{c.x0_m, c.y0_m}, left) > 0;
  return left_is_near ? Point2{-left.x, -left.y} : left;
}

/// Finds the nearest of the truth's samples, each of which covers 5 cm along its step.
class Nearest {
 public:
  Nearest(const std::vector<TruthSample>& samples, const std::optional<Point2>& robot)
      : samples_(samples), robot_(robot) {}

  /// Of a place on a curb. Its far side is that of its own line: at a bend the true step's may be another.
  FoundSample of(Point2 p, const MapCurb& curb) const {
    FoundSample out{curb.height_m};
    const Point2 far = to_far_side(curb, robot_);
    for (const TruthSample& s : samples_) {
      const double dx = p.x - s.at.x, dy = p.y - s.at.y;
      if (std::abs(dx) > reach_m || std::abs(dy) > reach_m) continue;
      const double across = dx * s.to_left.x + dy * s.to_left.y, along = dx * s.to_left.y - dy * s.to_left.x;
      const double on_sample = std::clamp(along, -spacing_m / 2, spacing_m / 2);
      const double distance = std::hypot(across, along - on_sample);
      if (distance >= out.distance_m) continue;
      out.distance_m = distance;
      TruthSample there = s;
      there.step_m += s.rise * on_sample;
      out.height_error_m = curb.height_m - signed_step_m(there, far);
    }
    return out;
  }

 private:
  const std::vector<TruthSample>& samples_;
  const std::optional<Point2>& robot_;
};

std::vector<FoundSample> found_samples(const Found& found, const Nearest& nearest, const Seen& seen) {
  std::vector<FoundSample> out;
  for (const MapCurb& c : found.curbs) {
    if (!is_step(c)) continue;
    for (const auto& [p, share] : samples_of(line_of(c))) {
      if (seen(p.x, p.y)) out.push_back(nearest.of(p, c));
    }
  }
  return out;
}

/// A visible sample, with the nearest found step.
struct TruthDistance {
  std::size_t curb;
  double height_m, distance_m, found_height_m;
};

std::vector<TruthDistance> truth_distances(const std::vector<TruthSample>& truth, const Found& found,
                                           const Seen& seen) {
  std::vector<TruthDistance> out;
  for (const TruthSample& s : truth) {
    if (s.height_m() < least_m || !visible(s, seen)) continue;
    TruthDistance nearest{s.curb, s.height_m(), std::numeric_limits<double>::infinity(), nan};
    for (const MapCurb& c : found.curbs) {
      const double distance = is_step(c) ? distance_m(s.at.x, s.at.y, line_of(c)) : nan;
      if (!(distance < nearest.distance_m)) continue;
      nearest.distance_m = distance;
      nearest.found_height_m = std::abs(c.height_m);
    }
    out.push_back(nearest);
  }
  return out;
}

template <typename Sample, typename Counts>
double share_within(const std::vector<Sample>& samples, double tolerance_m, Counts counts, int& all) {
  int near = 0;
  all = 0;
  for (const Sample& s : samples) {
    if (!counts(s)) continue;
    ++all;
    near += s.distance_m <= tolerance_m;
  }
  return all > 0 ? static_cast<double>(near) / all : nan;
}

/// Of samples at true steps, up for down or down for up.
double share_wrong_way(const std::vector<FoundSample>& samples) {
  int near = 0, wrong = 0;
  for (const FoundSample& s : samples) {
    if (s.distance_m > band_tolerance_m) continue;
    ++near;
    wrong += s.height_m * (s.height_m - s.height_error_m) < 0;
  }
  return near > 0 ? static_cast<double>(wrong) / near : nan;
}

/// Weighted errors in units of their standard deviations.
class NormalisedErrors {
 public:
  void add(double error, double weight) {
    ++sums_.pieces;
    weight_ += weight;
    sums_.mean_square += weight * error * error;
    sums_.within_1_sd += weight * (std::abs(error) <= 1);
    sums_.within_2_sd += weight * (std::abs(error) <= 2);
  }
  Calibration calibration() const {
    const double each = weight_ > 0 ? 1 / weight_ : nan;
    return {sums_.pieces, each * sums_.mean_square, each * sums_.within_1_sd, each * sums_.within_2_sd};
  }

 private:
  Calibration sums_;
  double weight_ = 0;
};

void calibrate(const Found& found, const Nearest& nearest, const Seen& seen, CurbScores& out) {
  NormalisedErrors height, position;
  for (const MapCurb& c : found.curbs) {
    const Point2 middle{(c.x0_m + c.x1_m) / 2, (c.y0_m + c.y1_m) / 2};
    if (!is_step(c) || !seen(middle.x, middle.y)) continue;
    const FoundSample sample = nearest.of(middle, c);
    if (sample.distance_m > band_tolerance_m || std::abs(sample.height_error_m) >= std::abs(c.height_m)) continue;
    const double length_m = std::hypot(c.x1_m - c.x0_m, c.y1_m - c.y0_m);
    if (c.height_sd_m > 0) height.add(sample.height_error_m / c.height_sd_m, length_m);
    if (c.position_sd_m > 0) position.add(sample.distance_m / c.position_sd_m, length_m);
  }
  out.calibration = height.calibration();
  out.position_calibration = position.calibration();
}

}  // namespace

Errors errors_of(std::vector<double> values) {
  if (values.empty()) return {nan, nan};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double q) {
    return values[static_cast<std::size_t>(std::lround(q * static_cast<double>(values.size() - 1)))];
  };
  return {quantile(0.5), quantile(0.95)};
}

std::vector<CurbMatch> match_steps(const Found& found, const Truth& truth, const Seen& seen) {
  struct Samples {
    std::vector<double> step, position, height;
  };
  const std::vector<TruthSample> all = truth_samples(truth);
  std::vector<Samples> of_curb(truth.curbs.size());
  for (const TruthDistance& s : truth_distances(all, found, seen)) {
    Samples& samples = of_curb[s.curb];
    samples.step.push_back(s.height_m);
    if (s.distance_m > band_tolerance_m) continue;
    samples.position.push_back(s.distance_m);
    samples.height.push_back(s.found_height_m);
  }
  std::vector<CurbMatch> out(truth.curbs.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    const Samples& samples = of_curb[k];
    const auto visible = static_cast<double>(samples.step.size());
    out[k].visible_m = spacing_m * visible;
    out[k].step_m = errors_of(samples.step).median;
    if (visible > 0) out[k].covered = static_cast<double>(samples.position.size()) / visible;
    out[k].position_error_m = errors_of(samples.position).median;
    out[k].height_m = errors_of(samples.height).median;
  }
  return out;
}

CurbScores score_curbs(const Found& found, const Truth& truth, const Seen& seen) {
  const std::vector<TruthSample> samples = truth_samples(truth);
  const Nearest nearest(samples, found.seen_from);
  const std::vector<FoundSample> of_found = found_samples(found, nearest, seen);
  const std::vector<TruthDistance> of_truth = truth_distances(samples, found, seen);
  const auto any = [](const auto&) { return true; };
  CurbScores out;
  int all = 0;
  for (std::size_t k = 0; k < tolerances_m.size(); ++k) {
    const double precision = share_within(of_found, tolerances_m[k], any, all);
    const double recall = share_within(of_truth, tolerances_m[k], any, all);
    const double f1 = precision + recall == 0 ? 0 : 2 * precision * recall / (precision + recall);
    out.at[k] = {tolerances_m[k], precision, recall, f1};
  }
  out.band = {BandRates{low_m, high_m}, BandRates{high_m, std::numeric_limits<double>::infinity()}};
  for (BandRates& band : out.band) {
    const auto within = [&](const auto& s) {
      return std::abs(s.height_m) >= band.from_m && std::abs(s.height_m) < band.to_m;
    };
    band.precision = share_within(of_found, band_tolerance_m, within, band.found);
    band.recall = share_within(of_truth, band_tolerance_m, within, band.truth);
  }
  out.wrong_way = share_wrong_way(of_found);
  std::vector<double> position, height;
  for (const FoundSample& s : of_found) {
    if (s.distance_m > match_tolerance_m) continue;
    position.push_back(s.distance_m);
    height.push_back(std::abs(s.height_error_m));
  }
  out.position_m = errors_of(position);
  out.height_m = errors_of(height);
  calibrate(found, nearest, seen, out);
  return out;
}

nlohmann::json to_json(const CurbScores& scores) {
  nlohmann::json out;
  for (const StepRates& r : scores.at) {
    out["steps"].push_back(
        {{"tolerance_m", r.tolerance_m}, {"precision", r.precision}, {"recall", r.recall}, {"f1", r.f1}});
  }
  for (const BandRates& b : scores.band) {
    out["step_bands"].push_back({{"from_m", b.from_m},
                                 {"to_m", b.to_m},
                                 {"precision", b.precision},
                                 {"recall", b.recall},
                                 {"found_samples", b.found},
                                 {"true_samples", b.truth}});
  }
  out["wrong_way"] = scores.wrong_way;
  out["position_error_median_m"] = scores.position_m.median;
  out["position_error_95_m"] = scores.position_m.most;
  out["height_error_median_m"] = scores.height_m.median;
  out["height_error_95_m"] = scores.height_m.most;
  for (const auto& [name, c] :
       {std::pair{"calibration", scores.calibration}, {"position_calibration", scores.position_calibration}}) {
    out[name] = {{"pieces", c.pieces},
                 {"mean_square", c.mean_square},
                 {"within_1_sd", c.within_1_sd},
                 {"within_2_sd", c.within_2_sd}};
  }
  return out;
}

}  // namespace curbline::tools
