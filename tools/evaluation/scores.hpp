// All that can be said of a map, its planes and its curbs beside the truth of the scene.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "evaluation/seen.hpp"
#include "evaluation/truth_samples.hpp"
#include "formats/csv.hpp"
#include "simulator/truth.hpp"

namespace curbline::tools {

/// What is scored.
struct Found {
  /// One of a robot that stands, some along the way of one that drives.
  std::vector<std::vector<LabelledCell>> windows;
  std::vector<MapCurb> curbs;       ///< of the whole way
  std::optional<Point2> seen_from;  ///< near sides are those of this place; without, steps are compared without signs
};

/// Median and 95 % of errors; NaN of none.
struct Errors {
  double median = 0, most = 0;
};
Errors errors_of(std::vector<double> values);

/// Labels and planes. A plane is what least squares makes of its label's cells, but those that lie off it as no noise
/// does; the true one that of most of them.
struct PlaneScores {
  /// V-measure of the labels of the ground under the cells' middles, where the truth is asked, against connected parts
  /// of the true planes, mean over the windows in which two parts or more have 5 % of the cells or more. NaN if there
  /// is none, or no cell bears a label (of a method that finds curbs alone). Parts are connected over all ground
  /// between the lowest and the highest cell, seen or not; cells off obstacles count.
  double v = 0;
  double v_readings = 0;       ///< the same of the labels of what is seen in the cells
  double cell_rmse_m = 0;      ///< of cells about the true ground
  double plane_rmse_m = 0;     ///< of planes about the true ground, at the cells of their labels
  Errors height_m, slope_rad;  ///< of a plane at the middle of its cells, and of its normal
};

/// Of steps within a tolerance. Samples every 5 cm. NaN where there is none; without precision or recall there is no
/// F1.
struct StepRates {
  double tolerance_m = 0;
  double precision = 0, recall = 0, f1 = 0;
};

/// The same for a band of heights: truth by its own step, found pieces by theirs. NaN where there is none.
struct BandRates {
  double from_m = 0, to_m = 0;
  double precision = 0, recall = 0;
  int found = 0, truth = 0;  ///< samples
};

/// (found - true) / sd of found steps that are right: within 0.1 m of a true one and in the same direction. Pieces
/// weigh by their length.
struct Calibration {
  int pieces = 0;
  double mean_square = 0, within_1_sd = 0, within_2_sd = 0;
};

struct CurbScores {
  std::array<StepRates, 4> at;                    ///< 0.05, 0.1, 0.15 and 0.3 m
  std::array<BandRates, 2> band;                  ///< 2 to 4 cm and above, at 0.1 m
  Errors position_m, height_m;                    ///< of samples of found steps within 0.15 m of a true one
  Calibration calibration, position_calibration;  ///< of heights; of the middles' distance from the true step
};

/// One true curb: how it was found.
struct CurbMatch {
  double visible_m = 0;         ///< length of it that could be found
  double step_m = 0;            ///< median of the true height there, without sign
  double covered = 0;           ///< share of that with a found step within 0.1 m
  double position_error_m = 0;  ///< median distance to the nearest found step, of what is covered
  double height_m = 0;          ///< median of what was found there, without sign
};

/// As Truth::curbs; creases are not visible.
std::vector<CurbMatch> match_steps(const Found& found, const Truth& truth, const Seen& seen);

PlaneScores score_planes(const Found& found, const Truth& truth);
CurbScores score_curbs(const Found& found, const Truth& truth, const Seen& seen);

nlohmann::json to_json(const PlaneScores& scores);
nlohmann::json to_json(const CurbScores& scores);

}  // namespace curbline::tools
