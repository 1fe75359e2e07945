// Compares the points of a line with the ground mapped before it, to find whether a jump of the poses was the robot's
// or its localisation's (pose_offset.hpp), and how late the tilt is (tilt_latency.hpp). A view of the stages, made for
// one line; owns nothing. Cost: that of those two, a point each.
#pragma once

#include "curbline/intake/line_projection.hpp"
#include "curbline/intake/pose_offset.hpp"
#include "curbline/intake/tilt_latency.hpp"
#include "curbline/labels/label_field.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/planes/plane_mixture.hpp"
#include "curbline/point.hpp"

namespace curbline {

template <Limits limits>
class MapComparison {
 public:
  /// Unmarked cells are searched up to `reach` cells away, on a row or column.
  MapComparison(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, const LabelField<limits>& field, int reach)
      : dem_(dem), mixture_(mixture), field_(field), reach_(reach) {}

  /// While it is undecided whose a jump was: gives `offset` the line's heights above unmarked cells, and applies the
  /// correction to the line.
  void follow_jump(ProjectedLine<limits>& line, const TiltLatency& latency, PoseOffset& offset) const;

  /// Tests a line measured while poses jump, or between jumps of a robot that climbs. It is off the map if all of it
  /// is, by about as much as the poses jump. If too little of it lies on mapped ground to tell, it is taken in part:
  /// without points that may be off by more than the noise that points of one place share.
  enum class JumpLine : unsigned char { on_map, in_part, off_map };
  JumpLine check_jump(ProjectedLine<limits>& line, const LineMotion& motion, bool climbs, const TiltLatency& latency,
                      const PoseOffset& offset) const;

  /// Gives `latency` the points on ground seen by an earlier sweep, and not yet by this one. What covers it is none: in
  /// a cell of a hedge's side one line is all that has been seen, and the next one meets it at another height.
  void follow_latency(const ProjectedLine<limits>& line, const LineMotion& motion, const PoseOffset& offset,
                      TiltLatency& latency) const;

 private:
  /// Cells, for a step of unknown size: from farther away, ground beyond a curb would look like one.
  static constexpr int reach_of_climbs = 2;

  using Place = typename Dem<limits>::Place;
  // For size: only lines at a jump of the poses, or after a step, are compared.
  [[gnu::cold]] void compare(const ProjectedLine<limits>& line, const TiltLatency& latency, int reach,
                             PoseOffset& offset) const;
  /// The ground at a point, by a cell.
  struct Ground {
    float above_m, variance_m2;  ///< the point's height above it; variance of the ground's own height ...
    float rise_variance_m2;      ///< ... and by the plane's slope, from the cell's centroid to the point
    BySweep growth_m_s;          ///< of above_m, with the latency of each sweep
  };
  bool ground_at(const Point& p, const Place& place, const Place& of, const SweepRates& rates, Ground& out) const;

  const Dem<limits>& dem_;
  const PlaneMixture<limits>& mixture_;
  const LabelField<limits>& field_;
  int reach_;
};

template <Limits limits>
void MapComparison<limits>::follow_jump(ProjectedLine<limits>& line, const TiltLatency& latency,
                                        PoseOffset& offset) const {
  compare(line, latency, offset.climbed() ? reach_of_climbs : reach_, offset);
  const PoseShift shift = offset.end_line();
  if (!shift.any()) return;
  for (Point& p : line.points()) p.z_m += offset.at(shift, p.x_m, p.y_m);
}

template <Limits limits>
auto MapComparison<limits>::check_jump(ProjectedLine<limits>& line, const LineMotion& motion, bool climbs,
                                       const TiltLatency& latency, const PoseOffset& offset) const -> JumpLine {
  PoseOffset suspect = offset.suspecting(motion.jumps, climbs);
  compare(line, latency, reach_, suspect);
  suspect.end_line();
  if (suspect.compared()) return suspect.likelier() ? JumpLine::off_map : JumpLine::on_map;
  const float common_m2 = dem_.prior().common_m2();
  const bool any = line.leave_out_if([&](const Point& p) { return motion.blur_m2(p.x_m, p.y_m) > common_m2; });
  return any ? JumpLine::in_part : JumpLine::on_map;
}

template <Limits limits>
void MapComparison<limits>::compare(const ProjectedLine<limits>& line, const TiltLatency& latency, int reach,
                                    PoseOffset& offset) const {
  Ground ground;
  for (const Point& p : line.points()) {
    const Place place = dem_.place_at(p.place_x_m(), p.place_y_m());
    if (!place.inside()) continue;
    const Place near = dem_.nearest_unmarked(place, reach);
    if (!near.inside() || !ground_at(p, place, near, latency.sweep_rates(), ground)) {
      offset.pass();
      continue;
    }
    offset.compare({p.x_m, p.y_m, ground.above_m, p.variance_m2 + ground.variance_m2,
                    ground.rise_variance_m2 + latency.height_variance_m2(ground.growth_m_s)});
  }
}

template <Limits limits>
void MapComparison<limits>::follow_latency(const ProjectedLine<limits>& line, const LineMotion& motion,
                                           const PoseOffset& offset, TiltLatency& latency) const {
  Ground ground;
  for (const Point& p : line.points()) {
    const Place place = dem_.place_at(p.place_x_m(), p.place_y_m());
    if (!place.inside()) continue;
    const int slot = dem_.slot(place.i, place.j);
    if (!dem_.mapped_before(slot) || mixture_.covered(slot) ||
        !ground_at(p, place, place, latency.sweep_rates(), ground))
      continue;
    const float blur_m2 = motion.still ? 0.0f : motion.blur_m2(p.x_m, p.y_m);  // the points of the line share it
    const float doubt_m2 = offset.doubt_m2(p.x_m, p.y_m);
    latency.compare({ground.above_m, p.variance_m2 - blur_m2 + ground.variance_m2,
                     ground.rise_variance_m2 + blur_m2 + doubt_m2, ground.growth_m_s,
                     dem_.farther_m(slot, p.x_m, p.y_m)});
  }
}

/// From the cell's centroid along the slope of its plane; false if it has no plane, or more than one surface.
template <Limits limits>
bool MapComparison<limits>::ground_at(const Point& p, const Place& place, const Place& of, const SweepRates& rates,
                                      Ground& out) const {
  const int slot = dem_.slot(of.i, of.j);
  const Label label = field_.label(slot);
  if (label == no_label) return false;
  const Cell& cell = dem_.cell(slot);
  if (dem_.several_surfaces(cell)) return false;
  const Plane& plane = mixture_.plane(label);
  const float x = place.u * dem_.cell_x_m() - p.shift_x_m, y = place.v * dem_.cell_y_m() - p.shift_y_m;
  const float dx = x - dem_.centroid_x_m(of.i, cell), dy = y - dem_.centroid_y_m(of.j, cell);
  out.above_m = p.z_m - cell.height_m - (plane.slope_x * dx + plane.slope_y * dy);
  out.variance_m2 = dem_.prior().texture_m2 + dem_.height_variance_m2(cell);
  out.rise_variance_m2 = plane.rise_variance_m2(dx, dy);
  const BySweep of_ground = dem_.growths_m_s(slot, rates);
  out.growth_m_s = {p.growth_m_s - of_ground.now, -of_ground.last, -of_ground.before};
  return true;
}

}  // namespace curbline
