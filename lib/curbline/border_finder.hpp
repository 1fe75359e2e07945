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

/// Where the laser looks from: x and y in the window's frame, z of the map frame.
struct Viewpoint {
  float x_m = 0.0f, y_m = 0.0f, z_m = 0.0f;
};

/// What a cell shows of an edge that crosses it, along the way from the near side to the far one.
struct CrossedCell {
  float far_share;  ///< of the step: 0 if the cell's mean height is that of the near plane, 1 if of the far one
  float centroid;   ///< of its points, in cells from its near side
};

/// How far from the near side of a cell its edge lies, in cells, 0 to 1.
/// A step up shows its face: with as many points a metre on both planes, and any number on the face, the edge lies at
/// 1/2 + (1/2 - far_share) + (centroid - 1/2). A step down shows none, and hides what lies below it: at 2 centroid -
/// far_share, whatever the share of points below; and not beyond 1 - far_share, where it would lie if nothing were
/// hidden.
float edge_in_cell(const CrossedCell& cell, bool step_up);

template <Limits limits>
class BorderFinder {
 public:
  BorderFinder(const CurbSettings& settings, const Dem<limits>& dem, const PlaneMixture<limits>& mixture,
               const LabelField<limits>& field, const Viewpoint& view)
      : settings_(settings), dem_(dem), mixture_(mixture), field_(field), view_(view) {}

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
  struct Edge {
    float at_m;     ///< along the axis
    float width_m;  ///< between the cells of the one plane and of the other, without what lies in the shadow of a step
                    ///< down
  };

  int find_ground();
  Border border_of(const Gap& gap) const;
  Edge edge_of(const Gap& gap) const;
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
  const Viewpoint& view_;
  std::array<bool, limits.planes> ground_{};
};

/// Which labels are planes of the ground, and not clutter: labels most of whose cells lie off their plane, so that its
/// robust standard deviation (1.4826 times the median residual) exceeds the bound. Returns how many are.
template <Limits limits>
int BorderFinder<limits>::find_ground() {
  std::array<int, limits.planes> cells{}, off{};
  const float bound = settings_.max_roughness_m / 1.4826f;
  dem_.for_each_valid([&](int i, int j, int s) {
    const LabelType label = field_.label(s);
    if (label == none) return;
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
  const Edge edge = edge_of(gap);
  const bool rising = gap.first.label < gap.second.label;
  Border border;
  border.x_m = gap.axis == 0 ? edge.at_m : across_m(gap);
  border.y_m = gap.axis == 0 ? across_m(gap) : edge.at_m;
  border.probability = 1.0f - same_plane(gap);
  border.half_gap_m = 0.5f * static_cast<float>(gap.second.along - gap.first.along) * pitch_m(gap);
  border.width_m = edge.width_m;
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

/// In the middle of the gap, unless the planes are three standard deviations or more apart: then where its cells tell.
template <Limits limits>
auto BorderFinder<limits>::edge_of(const Gap& gap) const -> Edge {
  const float cell_m = pitch_m(gap);
  const float middle_m = 0.5f * static_cast<float>(gap.first.along + gap.second.along + 1) * cell_m;
  const float x_m = gap.axis == 0 ? middle_m : across_m(gap), y_m = gap.axis == 0 ? across_m(gap) : middle_m;
  const float seen_from_m = gap.axis == 0 ? view_.x_m : view_.y_m;
  const bool outward = seen_from_m < middle_m;
  const Plane& near = mixture_.plane(outward ? gap.first.label : gap.second.label);
  const Plane& far = mixture_.plane(outward ? gap.second.label : gap.first.label);
  const float step_m = far.height_m(x_m, y_m) - near.height_m(x_m, y_m);
  const int length = gap.second.along - gap.first.along;
  const float inside_m = static_cast<float>(length - 1) * cell_m;
  if (2.0f * step_m * step_m <= 9.0f * (near.variance_m2 + far.variance_m2)) return {middle_m, inside_m};

  float edge = 0.0f, empty = 0.0f;  // in cells from the near one
  for (int k = 0; k <= length; ++k) {
    const int along = outward ? gap.first.along + k : gap.second.along - k;
    const int i = row(gap, along), j = col(gap, along);
    const Cell& cell = dem_.cell(dem_.slot(i, j));
    if (!cell.valid()) {
      empty += 1.0f;
      continue;
    }
    const float offset = (gap.axis == 0 ? cell.dx_m : cell.dy_m) / cell_m;
    edge += edge_in_cell({dem_.above_m(i, j, cell, near) / step_m, 0.5f + (outward ? offset : -offset)}, step_m > 0.0f);
  }
  // A ray that grazes a step down meets the ground behind it at step / slope of the ray; the edge lies before its
  // shadow. Cells that are empty otherwise lie between two scan lines.
  const float above_m = view_.z_m - near.height_m(x_m, y_m), away_m = middle_m - seen_from_m;
  float shadow = 0.0f;
  if (step_m < 0.0f && above_m > 0.0f) shadow = -step_m * (outward ? away_m : -away_m) / (above_m * cell_m);
  if (shadow > empty) shadow = empty;
  edge += 0.5f * (empty - shadow);
  const float at =
      outward ? static_cast<float>(gap.first.along) + edge : static_cast<float>(gap.second.along + 1) - edge;
  return {at * cell_m, inside_m - shadow * cell_m};
}

}  // namespace curbline
