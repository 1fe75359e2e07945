// A recording replayed to its end, with what the evaluation needs from the whole path: where the ground was seen, the
// window's labels every half window, all curbs, and when each true step was reported.
#pragma once

#include <string>
#include <vector>

#include "evaluation/scores.hpp"
#include "program/map_options.hpp"
#include "simulator/truth.hpp"

namespace curbline::tools {

struct RecordedRun {
  Map map;      ///< the window at the end
  Found found;  ///< of the whole path
  Seen seen;
  std::vector<Detections::Detection> detections;  ///< in the order of Truth::curbs
  RobotMarker robot;                              ///< at the end
  bool drove = false;
  std::string remarks;  ///< Replay::remarks()
  double max_height_m = 0;
};

/// Whether DIR contains the logs that simulate writes.
bool has_logs(const std::string& dir);

/// Streams the logs of DIR through the pipeline. Throws BadInput.
RecordedRun replay_recording(const std::string& dir, const Truth& truth);

/// The same sweep by a method for whole clouds, on the window of `run`. Throws BadInput.
Map map_recording(const std::string& dir, const RecordedRun& run, MapMethod method);

}  // namespace curbline::tools
