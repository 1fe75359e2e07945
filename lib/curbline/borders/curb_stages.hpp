// What the search for curbs works on: map, planes, labels, viewpoint, the latency's uncertainty and settings; and
// questions about a cell that need several of them.
#pragma once

#include "curbline/grid.hpp"
#include "curbline/labels/label_field.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/cell.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"
#include "curbline/planes/plane_mixture.hpp"
#include "curbline/point.hpp"
#include "curbline/settings.hpp"
#include "curbline/sweeps.hpp"

namespace curbline {

template <Limits limits>
struct CurbStages {
  const Dem<limits>& dem;
  const PlaneMixture<limits>& mixture;
  const LabelField<limits>& field;
  const Viewpoint& view;
  const LatencyDoubt& latency;
  const CurbSettings& settings;

  /// Does a cell belong to a plane that may be a side of a curb? (A label may outlive its plane by a line.)
  bool bears_ground(int slot) const {
    const Label label = field.label(slot);
    return label != no_label && mixture.on_ground(slot) && mixture.plane(label).alive() && !mixture.may_be_veil(label);
  }
  /// Does it also lie on that plane, and is it not an edge of two others, whose mean height happens to be that of the
  /// plane? Only such cells are the sides of borders; others are looked through.
  [[gnu::noinline]] bool shows_ground(int i, int j, int slot) const {
    if (!bears_ground(slot)) return false;
    const Cell& cell = dem.cell(slot);
    const Plane& plane = mixture.plane(field.label(slot));
    if (!lies_on(i, j, cell, plane)) return false;
    if (!dem.mixed(cell, dem.slope_m2(plane), plane.rough_m2)) return true;
    return !spreads_between_others(i, j, slot, 1, 0) && !spreads_between_others(i, j, slot, 0, 1);
  }
  /// May a cell without ground, or off its plane, be a mixture of two sides: of a veil, of a region too small for a
  /// plane, or of a plane that may be a veil?
  bool may_be_veil(int slot) const {
    if (mixture.region_label(slot) == no_label) return true;
    const Label label = field.label(slot);
    return mixture.on_ground(slot) ? label != no_label && mixture.may_be_veil(label) : !mixture.covered(slot);
  }
  /// Does a cell hold this plane and nothing else: do its heights spread by no more than noise and the plane's slope
  /// (Dem::slope_m2())?
  [[gnu::noinline]] bool holds_alone(int slot, Label label, float slope_m2) const {
    const Cell& cell = dem.cell(slot);
    return cell.valid() && field.label(slot) == label && mixture.region_label(slot) != no_label &&
           mixture.on_ground(slot) && !dem.mixed(cell, slope_m2, mixture.plane(label).rough_m2);
  }
  /// Do the heights of a cell, the middle one of three along (di, dj), spread as on an edge of the planes of the
  /// others: is their variance nearer to that of two levels with this mean than to none?
  // Not inlined: it is called for few cells, from places that would each hold it twice.
  [[gnu::noinline]] bool spreads_between_others(int i, int j, int slot, int di, int dj) const {
    if (!dem.contains(i - di, j - dj) || !dem.contains(i + di, j + dj)) return false;
    const int before = dem.slot(i - di, j - dj), after = dem.slot(i + di, j + dj);
    if (!bears_ground(before) || !bears_ground(after)) return false;
    const Label own = field.label(slot), first = field.label(before), second = field.label(after);
    if (first == own || second == own) return false;
    const Cell& cell = dem.cell(slot);
    const float two_levels_m2 =
        -dem.above_m(i, j, cell, mixture.plane(first)) * dem.above_m(i, j, cell, mixture.plane(second));
    return two_levels_m2 > 0.0f && 2.0f * dem.spread_m2(cell) > two_levels_m2 * cell.weight;
  }
  /// Is a cell on a plane, within three standard deviations?
  [[gnu::noinline]] bool lies_on(int i, int j, const Cell& cell, const Plane& plane) const {  // as CellLine::slot()
    const float residual = dem.above_m(i, j, cell, plane);
    return residual * residual <= gate * (plane.variance_m2 + dem.height_variance_m2(cell));
  }
};

}  // namespace curbline
