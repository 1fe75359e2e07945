// Scores against truth: the two things that `curbline evaluate` does.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace curbline::tools {

/// A directory that `simulate` wrote: replays its logs if DIR/curbs.csv and DIR/labels.csv are not there, and scores labels and curbs
/// against truth.json. Prints a table; returns the figures.
nlohmann::json evaluate_truth(const std::string& dir, bool print);

/// The paper's own tables on a folder of clouds with hand-drawn regions (scan-NN.xyz, scan-NN.gt): V by cloud in x, y in
/// [0, 4] m and the RMSE of prediction between the clouds scan-03 to scan-12, for curbline and for the reference; for curbline also
/// from the raw streams (scan-NN.carmen, scan-NN.candump) where all are there, with the robot that ships as clausius.toml.
nlohmann::json evaluate_paper(const std::string& data, bool print);

}  // namespace curbline::tools
