// What curbs are found in: the stages before, and what they say of a cell together.
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

namespace curbline {

template <Limits limits>
struct CurbStages {
  const Dem<limits>& dem;
  const PlaneMixture<limits>& mixture;
  const LabelField<limits>& field;
  const Viewpoint& view;

  /// Does a cell bear a plane that a curb may have for a side? A label may outlive its plane by a line.
  bool bears_ground(int slot) const {
    const Label label = field.label(slot);
    return label != no_label && mixture.on_ground(slot) && mixture.plane(label).alive() && !mixture.may_be_veil(label);
  }
  /// May a cell that bears no ground, or lies beside what it bears, mix two sides? As it does that is of a veil, or of
  /// a region too small for a plane, or of a plane that may be a veil.
  bool is_veil(int slot) const {
    if (mixture.region_label(slot) == no_label) return true;
    const Label label = field.label(slot);
    return mixture.on_ground(slot) ? label != no_label && mixture.may_be_veil(label) : !mixture.covered(slot);
  }
  /// Does a cell bear a plane, and do its heights spread no more than noise and the plane's slope (Dem::slope_m2())
  /// make them? Then it holds nothing else.
  [[gnu::noinline]] bool holds_alone(int slot, Label label, float slope_m2) const {
    const Cell& cell = dem.cell(slot);
    return cell.valid() && field.label(slot) == label && mixture.region_label(slot) != no_label &&
           mixture.on_ground(slot) && !dem.mixed(cell, slope_m2);
  }
  /// Within three standard deviations.
  [[gnu::noinline]] bool lies_on(int i, int j, const Cell& cell, const Plane& plane) const {  // as CellLine::slot()
    const float residual = dem.above_m(i, j, cell, plane);
    return residual * residual <= gate * (plane.variance_m2 + dem.height_variance_m2(cell));
  }
};

}  // namespace curbline
