#include "program/score_table.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "formats/decimals.hpp"

namespace curbline::tools {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();  ///< for a missing figure

/// A line of the table: the figure, the reference's and the paper's. NaN for a missing one.
void print_line(const char* name, double here, double reference, double paper, int decimals) {
  std::printf("%-36s", name);
  for (const double value : {here, reference, paper}) {
    std::isnan(value) ? std::printf(" %10s", "-") : std::printf(" %10.*f", decimals, value);
  }
  std::printf("\n");
}

/// A row of the table that the reference has too.
struct Row {
  const char* name;
  double (*value)(const Scored&);
  double scale;
  int decimals;
  double paper = none;
};

constexpr std::array of_planes{
    Row{"V-measure of labels", [](const Scored& s) { return s.planes.v; }, 1, 3, paper_v},
    Row{"          of readings alone", [](const Scored& s) { return s.planes.v_readings; }, 1, 3},
    Row{"cell heights, RMSE, mm", [](const Scored& s) { return s.planes.cell_rmse_m; }, 1e3, 1},
    Row{"planes, RMSE, mm", [](const Scored& s) { return s.planes.plane_rmse_m; }, 1e3, 1},
    Row{"planes, height error, median, mm", [](const Scored& s) { return s.planes.height_m.median; }, 1e3, 1},
    Row{"planes, slope error, median, mrad", [](const Scored& s) { return s.planes.slope_rad.median; }, 1e3, 1},
};

constexpr std::array of_curbs{
    Row{"recall of 2 to 4 cm at 0.1 m", [](const Scored& s) { return s.curbs.band[0].recall; }, 1, 3},
    Row{"recall of 4 cm and more", [](const Scored& s) { return s.curbs.band[1].recall; }, 1, 3},
    Row{"precision of 4 cm and more", [](const Scored& s) { return s.curbs.band[1].precision; }, 1, 3},
    Row{"steps told up for down, or reverse", [](const Scored& s) { return s.curbs.wrong_way; }, 1, 3},
    Row{"position error, median, cm", [](const Scored& s) { return s.curbs.position_m.median; }, 100, 1},
    Row{"                95 %, cm", [](const Scored& s) { return s.curbs.position_m.most; }, 100, 1},
    Row{"height error, median, mm", [](const Scored& s) { return s.curbs.height_m.median; }, 1e3, 1},
    Row{"              95 %, mm", [](const Scored& s) { return s.curbs.height_m.most; }, 1e3, 1},
    Row{"error / sd of positions, mean square",
        [](const Scored& s) { return s.curbs.position_calibration.mean_square; }, 1, 2},
    Row{"error / sd of heights, mean square", [](const Scored& s) { return s.curbs.calibration.mean_square; }, 1, 2},
    Row{"              within 1 sd (0.68)", [](const Scored& s) { return s.curbs.calibration.within_1_sd; }, 1, 2},
    Row{"              within 2 sd (0.95)", [](const Scored& s) { return s.curbs.calibration.within_2_sd; }, 1, 2},
};

}  // namespace

void print_score_table(const Scored& here, const std::optional<Scored>& reference, const DetectionSummary& detection) {
  const auto print = [&](const Row& row) {
    print_line(row.name, row.scale * row.value(here), reference ? row.scale * row.value(*reference) : none, row.paper,
               row.decimals);
  };
  std::printf("%-36s %10s %10s %10s\n", "", "here", "crf-em", "paper");
  for (const Row& row : of_planes) print(row);
  for (std::size_t k = 0; k < here.curbs.at.size(); ++k) {
    const auto rate = [&](const char* name, double StepRates::*value) {
      print_line(name, here.curbs.at[k].*value, reference ? reference->curbs.at[k].*value : none, none, 3);
    };
    const std::string precision = "steps at " + decimals(here.curbs.at[k].tolerance_m, 2) + " m: precision";
    rate(precision.c_str(), &StepRates::precision);
    rate("                 recall", &StepRates::recall);
    rate("                 F1", &StepRates::f1);
  }
  for (const Row& row : of_curbs) print(row);
  print_line("time to detection, median, s", detection.time_s.median, none, none, 1);
  print_line("distance at detection, median, m", detection.distance_m.median, none, none, 1);
}

}  // namespace curbline::tools
