// Scores against truth: the two things that `curbline evaluate` does.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "program/map_options.hpp"

namespace curbline::tools {

struct EvaluateOptions {
  std::string dir;                  ///< that simulate wrote
  std::optional<MapMethod> method;  ///< without: labels.csv and curbs.csv of DIR if both are there, else curbline
  std::string picture;              ///< file; empty: none
};

/// Replays the logs of DIR and scores labels, planes and curbs against truth.json; beside them what crf-em makes of the
/// same sweep (where the robot stood and the window has at most 6400 cells) and the paper's figure, where it has one.
/// Prints a table; returns the figures. evaluation/scores.hpp says what each is.
nlohmann::json evaluate_truth(const EvaluateOptions& options, bool print);

/// The paper's own tables on a folder of clouds with hand-drawn regions (scan-NN.xyz, scan-NN.gt): V by cloud in x, y
/// in [0, 4] m and the RMSE of prediction between the clouds scan-03 to scan-12, for curbline and for the reference;
/// for curbline also from the raw streams (scan-NN.carmen, scan-NN.candump), where all are there, one after the other
/// through one pipeline with the robot that ships as clausius.toml.
nlohmann::json evaluate_paper(const std::string& data, bool print);

}  // namespace curbline::tools
