// How well curbs agree with the truth, by samples every 5 cm along both.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

struct Segment {
  double x0_m = 0, y0_m = 0, x1_m = 0, y1_m = 0;
};

/// A true curb line: a segment with the step at its ends, >= 0.
struct TrueCurb {
  Segment line;
  double step0_m = 0, step1_m = 0;
};

double distance_m(double x_m, double y_m, const Segment& segment);

struct Rates {
  double precision = 0, recall = 0, f1 = 0;
};

/// Share of the found samples that lie within the tolerance of a true line, and of the true samples within it of a
/// found one; only samples for which counts(x, y) is true.
Rates curb_rates(std::span<const MapCurb> found, std::span<const Segment> truth, double tolerance_m,
                 const std::function<bool(double, double)>& counts);

/// One true curb: how it was found.
struct CurbMatch {
  double visible_m = 0;         ///< length whose samples count
  double covered = 0;           ///< share of that with a found piece within the tolerance
  double position_error_m = 0;  ///< median distance of the found samples that are nearest to this curb
  double height_m = 0;          ///< median of what was found there, without sign
  double height_error_m = 0;    ///< median of |found - true|
};

/// Matches found pieces to true curbs, the nearest within the tolerance. A curb that nobody saw has visible_m 0.
std::vector<CurbMatch> match_curbs(std::span<const MapCurb> found, std::span<const TrueCurb> truth, double tolerance_m,
                                   const std::function<bool(double, double)>& counts);

/// Median and 95 % of errors pooled over all curbs; NaN where there is none.
struct ErrorSummary {
  double position_median_m = 0, position_95_m = 0, height_median_m = 0, height_95_m = 0;
};
ErrorSummary curb_errors(std::span<const MapCurb> found, std::span<const TrueCurb> truth, double tolerance_m,
                         const std::function<bool(double, double)>& counts);

}  // namespace curbline::tools
