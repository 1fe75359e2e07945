// Agreement of curbs with the truth, by samples every 5 cm along both.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "map/map.hpp"

namespace curbline::tools {

struct Segment {
  double x0_m = 0, y0_m = 0, x1_m = 0, y1_m = 0;
};

Segment line_of(const MapCurb& curb);

/// Largest distance between samples.
inline constexpr double spacing_m = 0.05;

struct SegmentSample {
  Point2 at;
  double share;  ///< position within the segment: 0 at its start, 1 at its end
};

/// At the centres of parts of equal length.
std::vector<SegmentSample> samples_of(const Segment& segment);

double distance_m(double x_m, double y_m, const Segment& segment);

struct Rates {
  double precision = 0, recall = 0, f1 = 0;
};

/// The share of the found samples within the tolerance of a true line, and of the true samples within the tolerance of
/// a found one; only samples for which counts(x, y) is true.
Rates curb_rates(std::span<const MapCurb> found, std::span<const Segment> truth, double tolerance_m,
                 const std::function<bool(double, double)>& counts);

}  // namespace curbline::tools
