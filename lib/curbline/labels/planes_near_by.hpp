// The planes near each cell: those of regions in its block or the eight around it. Only these are candidates for its
// label (all planes, if none of these is ground), so that two pavements of equal height on both sides of a road keep
// different labels. Cost: a pass over the window when regions have changed their planes or the window has moved, and
// for a cell's candidates a visit of each plane near by.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "curbline/grid.hpp"
#include "curbline/index_set.hpp"
#include "curbline/labels/label_site.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/map/level_cell.hpp"
#include "curbline/math.hpp"
#include "curbline/planes/plane_mixture.hpp"

namespace curbline {

template <Limits limits>
class PlanesNearBy {
 public:
  void clear() { near_.fill({}); }

  void follow(const Dem<limits>& dem, const PlaneMixture<limits>& mixture);

  /// The candidates of a valid cell, as of the last follow(). Node potentials: Student t with 2 degrees of freedom
  /// about each plane. A plane along a flight of stairs passes near the heights of all its treads, but a cell that lies
  /// level is not on it, whatever its neighbours say (three standard deviations at most).
  LabelSite::Candidates candidates(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int i, int j,
                                   const Cell& cell) const;

 private:
  using Planes = IndexSet<limits.planes>;
  static constexpr std::size_t blocks_in_row = limits.cols / block_side;
  using BlockRow = std::array<Planes, blocks_in_row>;

  static std::size_t block(int i, int j) {
    return static_cast<std::size_t>(i / block_side) * blocks_in_row + static_cast<std::size_t>(j / block_side);
  }
  static BlockRow planes_in(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int first_row);

  std::array<Planes, limits.rows / block_side * blocks_in_row> near_{};  ///< for each block of the window
  float origin_x_m_ = 0.0f, origin_y_m_ = 0.0f;                          ///< of the window then
};

template <Limits limits>
void PlanesNearBy<limits>::follow(const Dem<limits>& dem, const PlaneMixture<limits>& mixture) {
  if (!mixture.any_relabelled() && origin_x_m_ == dem.origin_x_m() && origin_y_m_ == dem.origin_y_m()) return;
  origin_x_m_ = dem.origin_x_m();
  origin_y_m_ = dem.origin_y_m();
  near_.fill({});
  for (int i = 0; i < dem.rows(); i += block_side) {
    const BlockRow here = planes_in(dem, mixture, i);
    for (int j = 0; j < dem.cols(); j += block_side) {
      const Planes& planes = here[static_cast<std::size_t>(j / block_side)];
      for (int a = i - block_side; a <= i + block_side; a += block_side) {
        for (int b = j - block_side; b <= j + block_side; b += block_side) {
          if (dem.contains(a, b)) near_[block(a, b)].insert(planes);
        }
      }
    }
  }
}

/// Planes in each of the blocks that begin in a row.
template <Limits limits>
auto PlanesNearBy<limits>::planes_in(const Dem<limits>& dem, const PlaneMixture<limits>& mixture, int first_row)
    -> BlockRow {
  BlockRow planes{};
  for (int i = first_row; i < first_row + block_side; ++i) {
    dem.for_each_valid_in_row(i, [&](int, int j, int s) {
      const Label label = mixture.region_label(s);
      if (label != no_label) planes[static_cast<std::size_t>(j / block_side)].insert(label);
    });
  }
  return planes;
}

template <Limits limits>
LabelSite::Candidates PlanesNearBy<limits>::candidates(const Dem<limits>& dem, const PlaneMixture<limits>& mixture,
                                                       int i, int j, const Cell& cell) const {
  const float x = dem.centroid_x_m(i, cell), y = dem.centroid_y_m(j, cell);
  const float cell_variance = dem.height_variance_m2(cell);
  LabelSite::Candidates candidates;
  const auto consider = [&](int k) {
    const Plane& plane = mixture.plane(k);
    if (!mixture.ground(k)) return;
    const float variance = plane.variance_m2 + cell_variance;
    const float residual = cell.height_m - plane.height_m(x, y);
    float u = 1.0f + residual * residual / (2.0f * variance);
    if (u > 1e10f) u = 1e10f;  // its cube, and a ratio of two, must stay finite
    float doubt = variance * u * u * u;
    if (plane.steeper_than_ground()) doubt *= exp(std::min(level_likelihood(dem, cell, plane), gate));
    candidates.consider(static_cast<Label>(k), doubt);
  };
  near_[block(i, j)].for_each(consider);
  if (candidates.label[0] == no_label) {
    for (int k = 0; k < limits.planes; ++k) consider(k);
  }
  return candidates;
}

}  // namespace curbline
