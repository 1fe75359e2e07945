// The true steps of a scene as samples every 5 cm: which could be found, and when they were.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "evaluation/curbs.hpp"
#include "evaluation/seen.hpp"
#include "map/map.hpp"
#include "simulator/truth.hpp"

namespace curbline::tools {

Segment line_of(const TruthCurb& curb);

/// A place on a true step.
struct TruthSample {
  std::size_t curb = 0;  ///< index in Truth::curbs
  Point2 at;
  Point2 to_left;     ///< unit vector across the step, towards the left side
  double step_m = 0;  ///< left minus right
  double rise = 0;    ///< change of step_m per metre along the step, to the right of to_left
  double height_m() const { return step_m < 0 ? -step_m : step_m; }
};

/// Samples of all steps, except under obstacles.
std::vector<TruthSample> truth_samples(const Truth& truth);

/// A step can be found if the robot saw the ground on both sides of it, 0.2 m away.
bool visible(const TruthSample& sample, const Seen& seen);

/// Height of the step toward a direction that leads across it: above 0 if it leads up.
double signed_step_m(const TruthSample& sample, Point2 toward);

/// When each true step was first seen and first reported, along a drive.
class Detections {
 public:
  static constexpr double tolerance_m = 0.1;

  explicit Detections(const Truth& truth);

  struct Detection {
    std::optional<double> seen_s, found_s;  ///< since the first scan line
    double distance_m = 0;                  ///< from the robot to the first sample that was found
  };

  /// Updates the detections with the state at a time; `seen` grows from call to call. Cost: samples in the window times
  /// curbs.
  void observe(double time_s, Point2 robot, const Bounds& window, const Seen& seen, std::span<const MapCurb> curbs);

  std::span<const Detection> of_curbs() const { return of_curbs_; }  ///< as Truth::curbs; never creases

 private:
  std::vector<TruthSample> samples_;
  std::vector<Detection> of_curbs_;
};

}  // namespace curbline::tools
