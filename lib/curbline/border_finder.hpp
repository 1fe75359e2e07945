// Finds border points: where, along a row or column of the window, the ground changes from one plane to another. Cells
// that lie on no plane of the ground, and those that hold something of both sides, are looked through; they tell where
// between the cells of the one and of the other the edge lies. Cost: two passes over the window and a look at each cell
// of a gap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/borders.hpp"
#include "curbline/counters.hpp"
#include "curbline/dem.hpp"
#include "curbline/label_field.hpp"
#include "curbline/plane_mixture.hpp"
#include "curbline/settings.hpp"

namespace curbline {

/// What a cell shows of a step that crosses it, along the way from the near side to the far one.
struct CrossedCell {
  float far_share;  ///< of the step: 0 if the cell's mean height is that of the near plane, 1 if of the far one
  float centroid;   ///< of its points, in cells from its near side
};

/// How much of a cell lies before the middle of what parts the planes, in cells. With as many points a metre on both
/// planes, each sum over the cells of a gap is exact for
///   - a vertical face that shows any number of points: 1/2 - far_share + centroid is where it stands;
///   - a sloped face as densely seen as the planes;
///   - a gap without points, of which the cells on both sides hold a part: their centroids tell how much, and half of
///     it is counted.
/// A centroid is not bounded: what a few points lie off by lot averages out.
float before_middle(const CrossedCell& cell);

template <Limits limits>
class BorderFinder {
 public:
  BorderFinder(const CurbSettings& settings, const Dem<limits>& dem, const PlaneMixture<limits>& mixture,
               const LabelField<limits>& field)
      : settings_(settings), dem_(dem), mixture_(mixture), field_(field) {}

  /// Fills `borders`, which are empty.
  void find(Borders<limits>& borders, Counters& counters);

 private:
  using LabelType = Label<limits>;
  static constexpr LabelType none = no_label<limits>;
  using Border = typename Borders<limits>::Border;

  /// A cell of a row or column and its plane.
  struct Place {
    LabelType label = none;
    std::int16_t along = 0;
  };
  /// From a cell of one plane to one of another: along x (axis 0) on column `across`, or along y on row `across`.
  struct Gap {
    int axis, across;
    Place first, second;
  };

  int find_ground();
  Border border_of(const Gap& gap) const;
  float middle_m(const Gap& gap) const;
  float same_plane(const Gap& gap) const;
  bool lies_on(int i, int j, const Cell& cell, const Plane& plane) const;

  float pitch_m(const Gap& gap) const { return gap.axis == 0 ? dem_.cell_x_m() : dem_.cell_y_m(); }
  /// Of the middle of its row or column.
  float across_m(const Gap& gap) const {
    return (static_cast<float>(gap.across) + 0.5f) * (gap.axis == 0 ? dem_.cell_y_m() : dem_.cell_x_m());
  }
  int row(const Gap& gap, int along) const { return gap.axis == 0 ? along : gap.across; }
  int col(const Gap& gap, int along) const { return gap.axis == 0 ? gap.across : along; }

  const CurbSettings& settings_;
  const Dem<limits>& dem_;
  const PlaneMixture<limits>& mixture_;
  const LabelField<limits>& field_;
  std::array<bool, limits.planes> ground_{};
};

/// Which labels are planes of the ground, and not clutter: labels most of whose cells lie off their plane, so that its
/// robust standard deviation (1.4826 times the median residual) exceeds the bound. Cells that were left to a plane by
/// what is no ground do not speak for it. Returns how many are.
template <Limits limits>
int BorderFinder<limits>::find_ground() {
  std::array<int, limits.planes> cells{}, off{};
  const float bound = settings_.max_roughness_m / 1.4826f;
  dem_.for_each_valid([&](int i, int j, int s) {
    const LabelType label = field_.label(s);
    if (label == none || !mixture_.on_ground(s)) return;
    const Cell& cell = dem_.cell(s);
    const float residual = dem_.above_m(i, j, cell, mixture_.plane(label));
    ++cells[label];
    off[label] += residual > bound || residual < -bound;
  });
  int ground = 0;
  for (std::size_t l = 0; l < ground_.size(); ++l) {
    ground_[l] = cells[l] > 0 && 2 * off[l] <= cells[l];
    ground += ground_[l];
  }
  return ground;
}

/// Within three standard deviations.
template <Limits limits>
bool BorderFinder<limits>::lies_on(int i, int j, const Cell& cell, const Plane& plane) const {
  const float residual = dem_.above_m(i, j, cell, plane);
  return residual * residual <= 9.0f * (plane.variance_m2 + dem_.height_variance_m2(cell));
}

/// A border wherever the plane changes along a row or column.
template <Limits limits>
void BorderFinder<limits>::find(Borders<limits>& borders, Counters& counters) {
  if (find_ground() < 2) return;
  std::array<Place, limits.cols> before_in_col{};
  Place before_in_row;
  int row = -1;
  const auto pass = [&](Place& before, const Place& here, int axis, int across) {
    const bool border =
        before.label != none && before.label != here.label && here.along - before.along <= settings_.link_reach;
    if (border && !borders.add(dem_, border_of({axis, across, before, here}))) ++counters.borders_full;
    before = here;
  };
  dem_.for_each_valid([&](int i, int j, int s) {
    const LabelType label = field_.label(s);
    if (label == none || !ground_[label] || !mixture_.on_ground(s) ||
        !lies_on(i, j, dem_.cell(s), mixture_.plane(label)))
      return;
    if (i != row) before_in_row = {};
    row = i;
    pass(before_in_col[static_cast<std::size_t>(j)], {label, static_cast<std::int16_t>(i)}, 0, j);
    pass(before_in_row, {label, static_cast<std::int16_t>(j)}, 1, i);
  });
}

/// Probability that the cells on both sides lie on one plane.
template <Limits limits>
float BorderFinder<limits>::same_plane(const Gap& gap) const {
  const auto belief = [&](int along) { return field_.belief(dem_, row(gap, along), col(gap, along)); };
  const auto p = belief(gap.first.along), q = belief(gap.second.along);
  float same = 0.0f;
  for (std::size_t m = 0; m < p.label.size(); ++m) {
    for (std::size_t n = 0; n < q.label.size(); ++n) {
      if (p.label[m] == q.label[n] && p.label[m] != none) same += p.probability[m] * q.probability[n];
    }
  }
  return same;
}

template <Limits limits>
auto BorderFinder<limits>::border_of(const Gap& gap) const -> Border {
  const float at_m = middle_m(gap);
  const bool rising = gap.first.label < gap.second.label;
  Border border;
  border.x_m = gap.axis == 0 ? at_m : across_m(gap);
  border.y_m = gap.axis == 0 ? across_m(gap) : at_m;
  border.probability = 1.0f - same_plane(gap);
  border.half_gap_m = 0.5f * static_cast<float>(gap.second.along - gap.first.along) * pitch_m(gap);
  const auto off = [&](const Place& place) {
    const int i = row(gap, place.along), j = col(gap, place.along);
    return dem_.above_m(i, j, dem_.cell(dem_.slot(i, j)), mixture_.plane(place.label));
  };
  border.off_m = rising ? off(gap.second) - off(gap.first) : off(gap.first) - off(gap.second);
  border.low = rising ? gap.first.label : gap.second.label;
  border.high = rising ? gap.second.label : gap.first.label;
  border.axis = static_cast<std::int8_t>(gap.axis);
  border.sign = static_cast<std::int8_t>(rising ? 1 : -1);
  border.chained = false;
  border.next_in_cell = 0;
  return border;
}

/// Along the axis, where the middle of what parts the planes lies: of a face, or of what a step down hides. Halfway
/// between the cells, unless the planes are three standard deviations or more apart: then where the cells tell.
template <Limits limits>
float BorderFinder<limits>::middle_m(const Gap& gap) const {
  const float cell_m = pitch_m(gap);
  const float halfway_m = 0.5f * static_cast<float>(gap.first.along + gap.second.along + 1) * cell_m;
  const float x_m = gap.axis == 0 ? halfway_m : across_m(gap), y_m = gap.axis == 0 ? across_m(gap) : halfway_m;
  const Plane& first = mixture_.plane(gap.first.label);
  const Plane& second = mixture_.plane(gap.second.label);
  const float step_m = second.height_m(x_m, y_m) - first.height_m(x_m, y_m);
  if (2.0f * step_m * step_m <= 9.0f * (first.variance_m2 + second.variance_m2)) return halfway_m;

  float before = 0.0f;  // in cells, from the first one's near side
  for (int along = gap.first.along; along <= gap.second.along; ++along) {
    const int i = row(gap, along), j = col(gap, along);
    const Cell& cell = dem_.cell(dem_.slot(i, j));
    if (!cell.valid()) {
      before += 0.5f;
      continue;
    }
    const float offset = (gap.axis == 0 ? cell.dx_m : cell.dy_m) / cell_m;
    before += before_middle({dem_.above_m(i, j, cell, first) / step_m, 0.5f + offset});
  }
  const auto cells = static_cast<float>(gap.second.along - gap.first.along + 1);
  before = before < 0.0f ? 0.0f : before > cells ? cells : before;
  return (static_cast<float>(gap.first.along) + before) * cell_m;
}

}  // namespace curbline
