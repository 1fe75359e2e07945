// A row or column of the window, cell by cell: what looks along both need not be written twice.
#pragma once

#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/cell.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"

namespace curbline {

/// A column, along x (axis 0), or a row, along y (1). `along` numbers its cells.
template <Limits limits>
struct CellLine {
  const Dem<limits>& dem;
  int axis, across;  ///< number of the column, or row

  int cells() const { return dem.cells_along(axis); }
  int row(int along) const { return axis == 0 ? along : across; }
  int col(int along) const { return axis == 0 ? across : along; }
  // This and above_m() are called from many places, for borders only: inlined they take 700 bytes of flash.
  [[gnu::noinline]] int slot(int along) const { return dem.slot(row(along), col(along)); }
  const Cell& cell(int along) const { return dem.cell(slot(along)); }
  /// Dem::next_valid() along the line (toward 1) or against it (-1).
  int next_valid(int along, int toward, int reach) const {
    return dem.next_valid(slot(along), direction(axis, toward), reach);
  }
  [[gnu::noinline]] float above_m(int along, const Plane& plane) const {
    return dem.above_m(row(along), col(along), cell(along), plane);
  }

  float pitch_m() const { return dem.cell_m(axis); }
  /// Offset of the cell's centroid from its middle, in cells along the line.
  float offset(const Cell& cell) const { return (axis == 0 ? cell.dx_m : cell.dy_m) / pitch_m(); }
  /// Coordinates of a place on the middle of the line.
  float x_m(float along_m) const { return axis == 0 ? along_m : across_m(); }
  float y_m(float along_m) const { return axis == 0 ? across_m() : along_m; }
  /// The other coordinate, of its middle.
  float across_m() const { return (static_cast<float>(across) + 0.5f) * dem.cell_m(1 - axis); }
  /// Direction along the line that leads away from the laser at a cell: 1 or -1.
  int away(const Viewpoint& view, int along) const {
    return (static_cast<float>(along) + 0.5f) * pitch_m() > view.place_m(axis) ? 1 : -1;
  }
};

}  // namespace curbline
