// Scores against truth: the two modes of `curbline evaluate`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "program/map_options.hpp"

namespace curbline::tools {

struct EvaluateOptions {
  std::string dir;                  ///< written by simulate
  std::optional<MapMethod> method;  ///< if empty: labels.csv and curbs.csv of DIR if both are there, otherwise curbline
  std::string picture;              ///< file; empty: no picture
};

/// Replays the logs of DIR and scores labels, planes and curbs against truth.json. For comparison it adds the scores of
/// crf-em on the same sweep (if the robot stood and the window has at most 6400 cells) and the paper's figure, if there
/// is one. Prints a table; returns the figures, which evaluation/scores.hpp explains; precision, recall and f1 by
/// themselves are those of all curbs, creases and edges of ramps too, within 0.1 m.
nlohmann::json evaluate_truth(const EvaluateOptions& options, bool print);

/// The paper's tables on a folder of clouds with hand-drawn regions (scan-NN.xyz, scan-NN.gt): V of each cloud in x, y
/// in [0, 4] m and the RMSE of prediction between the clouds scan-03 to scan-12, for curbline and for the reference. If
/// all raw streams are there (scan-NN.carmen, scan-NN.candump), also for curbline on these: one after the other through
/// one pipeline with the robot that ships as clausius.toml.
nlohmann::json evaluate_paper(const std::string& data, bool print);

}  // namespace curbline::tools
