// The table of `curbline evaluate DIR`: the figures of a map beside those of the reference and of the paper.
#pragma once

#include <optional>

#include "evaluation/scores.hpp"

namespace curbline::tools {

inline constexpr double paper_v = 0.88;  ///< V-measure, in simulation, +- 0.05

/// The scores of one map.
struct Scored {
  PlaneScores planes;
  CurbScores curbs;
};

/// Over all true steps that were reported at some time.
struct DetectionSummary {
  Errors time_s, distance_m;
};

/// Prints to standard output, with a dash for each missing figure.
void print_score_table(const Scored& here, const std::optional<Scored>& reference, const DetectionSummary& detection);

}  // namespace curbline::tools
