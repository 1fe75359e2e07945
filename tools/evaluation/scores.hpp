// All scores of a map, its planes and its curbs against the truth of the scene.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/seen.hpp"
#include "evaluation/truth_samples.hpp"
#include "formats/csv.hpp"
#include "simulator/truth.hpp"

namespace curbline::tools {

/// The results to be scored.
struct Found {
  /// One window for a robot that stands, several along the path of one that drives.
  std::vector<std::vector<LabelledCell>> windows;
  std::vector<MapCurb> curbs;  ///< of the whole path
  /// Near and far sides are as seen from here. If empty, a curb's near side lies to the right of its line, from its
  /// first end to its second, as the library's do.
  std::optional<Point2> seen_from;
  std::string labels_file = "labels.csv";  ///< that a window was read from, for errors
};

/// Median and 95 % quantile of errors; NaN if there are none.
struct Errors {
  double median = 0, most = 0;
};
Errors errors_of(std::vector<double> values);

/// Scores of labels and planes. A plane is the least-squares fit to its label's cells, without those that are farther
/// off than noise can explain; it is compared with the true plane of most of these cells.
struct PlaneScores {
  /// V-measure of the labels of the ground at the cells' centres, where the truth is looked up, against connected parts
  /// of the true planes; mean over the windows in which at least two parts have 5 % of the cells or more. NaN if there
  /// is none, or if no cell has a label (methods that only find curbs). Connectivity is that of all ground between the
  /// lowest and the highest cell, seen or not, to a third of a cell; only cells off obstacles count.
  double v = 0;
  double v_readings = 0;       ///< the same for the labels of what is seen in the cells
  double cell_rmse_m = 0;      ///< error of cells against the true ground
  double plane_rmse_m = 0;     ///< error of planes against the true ground, at the cells of their labels
  Errors height_m, slope_rad;  ///< error of a plane at the centroid of its cells, and of its normal
};

/// Of steps within a tolerance. Samples every 5 cm. NaN if there is none; F1 is NaN if precision or recall is.
struct StepRates {
  double tolerance_m = 0;
  double precision = 0, recall = 0, f1 = 0;
};

/// The same for a band of heights: truth by its own step, found pieces by theirs. NaN if there is none.
struct BandRates {
  double from_m = 0, to_m = 0;  ///< to_m of the last band is infinite, null in JSON
  double precision = 0, recall = 0;
  int found = 0, truth = 0;  ///< samples
};

/// (found - true) / sd of correctly found steps: within 0.1 m of a true one and in the same direction. Pieces are
/// weighted by length.
struct Calibration {
  int pieces = 0;
  double mean_square = 0, within_1_sd = 0, within_2_sd = 0;
};

struct CurbScores {
  std::array<StepRates, 4> at;    ///< 0.05, 0.1, 0.15 and 0.3 m
  std::array<BandRates, 2> band;  ///< 2 to 4 cm and above, at 0.1 m
  double wrong_way = 0;  ///< share of samples of found steps within 0.1 m of a true one that are up for down, or down
                         ///< for up; NaN if there are none
  Errors position_m, height_m;                    ///< of samples of found steps within 0.15 m of a true one
  Calibration calibration, position_calibration;  ///< of heights; of the midpoints' distances from the true step
};

/// How one true curb was found.
struct CurbMatch {
  double visible_m = 0;         ///< the length of it that could be found
  double step_m = 0;            ///< median true height of that length, without sign
  double covered = 0;           ///< share of that length with a found step within 0.1 m
  double position_error_m = 0;  ///< median distance of the covered part to the nearest found step
  double height_m = 0;          ///< median height found there, without sign
};

/// In the order of Truth::curbs; creases are not visible.
std::vector<CurbMatch> match_steps(const Found& found, const Truth& truth, const Seen& seen);

PlaneScores score_planes(const Found& found, const Truth& truth);
CurbScores score_curbs(const Found& found, const Truth& truth, const Seen& seen);

nlohmann::json to_json(const PlaneScores& scores);
nlohmann::json to_json(const CurbScores& scores);

}  // namespace curbline::tools
