// A gap between two planes on a row or column of the window: from a cell of one plane to the next cell of the other.
// Whether a step down hides the rest of a wide gap, or its far side is seen over other ground than its near plane,
// where in it the edge is, to a part of a cell, whether a slope takes its place, and the probability of one. Cost: a
// look at each cell of the gap, and along the ray to it if one is empty.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "curbline/borders/curb_stages.hpp"
#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/cell_line.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"

namespace curbline {

/// A cell of a line and its label.
struct LabelledCell {
  Label label = no_label;
  std::int16_t along = 0;
};

/// What a cell shows of a step across it, from the near side to the far side.
struct CrossedCell {
  float far_share;  ///< 0 if the cell's mean height is that of the near plane, 1 if that of the far one
  float centroid;   ///< of its points, in cells from its near side
};

/// The length of a cell that lies before the middle of what parts the planes, in cells. With equal density of points on
/// both planes, the sum over the cells of a gap is exact for
///   - a vertical face with any number of points: 1/2 - far_share + centroid is its place;
///   - a sloped face as dense as the planes;
///   - a gap without points that reaches into the cells on both sides: their centroids show how far, and half of it
///     counts.
/// The centroid is not clamped: the random errors of a few points average out.
inline float before_middle(const CrossedCell& cell) {
  return 0.5f - std::clamp(cell.far_share, 0.0f, 1.0f) + cell.centroid;
}

/// How much of a slope from plane to plane a cell holds, as a length in cells. Heights that are on both planes alone
/// have a variance of far_share (1 - far_share), in squares of the step; what that lacks, summed over the cells of a
/// gap, is a sixth of an even slope's length, wherever cells part it. A vertical face counts as the share that its
/// readings have in their cell. Noise only shortens it.
inline float sloped_cells(float far_share, float variance) {
  const float share = std::clamp(far_share, 0.0f, 1.0f);
  return std::max(0.0f, 6.0f * (share * (1.0f - share) - variance));
}

template <Limits limits>
class PlaneGap {
 public:
  using Line = CellLine<limits>;

  /// `line` must outlive it.
  PlaneGap(const CurbStages<limits>& stages, const Line& line, const LabelledCell& first, const LabelledCell& second)
      : stages_(stages),
        line_(line),
        first_{first, stages.mixture.plane(first.label)},
        second_{second, stages.mixture.plane(second.label)} {}

  const Line& line() const { return line_; }
  /// A cell beside the gap, and its plane.
  struct Side : LabelledCell {
    const Plane& plane;
  };
  /// The first one is before the second along the line.
  const Side& first() const { return first_; }
  const Side& second() const { return second_; }
  /// Distance of the two, in cells.
  int length() const { return second_.along - first_.along; }

  /// Does a step down hide the rest of a wide gap?
  [[gnu::cold]] bool hidden() const;  // for size: few gaps are wide enough to ask
  /// Is the cell at its far end, the second or the first, seen over other ground than that of the near end's plane?
  [[gnu::cold]] bool seen_over_other(bool second_is_far) const {
    const Passed before = passed(second_is_far ? Sides{first_, second_} : Sides{second_, first_});
    return before.other && !before.near;
  }
  /// Probability that the cells on both sides belong to one plane.
  float same_plane() const;
  struct Middle {
    float along_m;  ///< from the line's beginning
    bool open;      ///< Border::open
    bool parted;    ///< Border::parted
    int empty;      ///< cells without a point
    float sloped;   ///< Border::sloped_cells
  };
  /// The middle of what parts the planes.
  Middle middle() const;

 private:
  static constexpr int widest_blur = 2;  ///< cells that mix both sides, at an edge and at the end of its shadow

  /// As the laser saw the lower one: only that can be hidden.
  struct Sides {
    const Side &near, &far;
  };
  Sides sides(bool second_is_upper) const {
    const Side& lower = second_is_upper ? first_ : second_;
    const Viewpoint from = stages_.dem.seen_from(line_.slot(lower.along), stages_.view);
    return line_.away(from, lower.along) > 0 ? Sides{first_, second_} : Sides{second_, first_};
  }
  float halfway_m() const { return 0.5f * static_cast<float>(first_.along + second_.along + 1) * line_.pitch_m(); }
  /// Rise from the first plane to the second, half way.
  float rise_m() const {
    const float x_m = line_.x_m(halfway_m()), y_m = line_.y_m(halfway_m());
    return second_.plane.height_m(x_m, y_m) - first_.plane.height_m(x_m, y_m);
  }
  /// The cells that hold both heights of a step up, from the first one to the last; without any, the cells on both
  /// sides of the gap.
  struct Face {
    int first, last;
    bool parted = false;  ///< of two cells side by side, each holds one height
  };
  /// Ground where the ray to the far cell, from where that was seen, crosses the height of the near plane, or up to
  /// widest_blur cells nearer: of that plane (`near`; its nearest cell to the far one at (x_m, y_m)), of another one.
  struct Passed {
    bool near = false, other = false;
    float x_m = 0.0f, y_m = 0.0f;
  };
  Passed passed(const Sides& sides) const;
  bool mixed(int along, const Plane& plane) const;
  Face seen_face(const Sides& sides, bool second_is_upper) const;
  float centroid_share(int along, const Face& face) const;
  [[gnu::cold]] bool behind_obstacle(const Sides& sides, int first_empty, int last_empty) const;

  const CurbStages<limits>& stages_;
  const Line& line_;
  const Side first_, second_;
};

/// If so, no obstacle stands in it, and the ray to its far cell grazes the near plane's edge: there are cells of that
/// on its way. And that edge ends the near cell's ground: it runs on to there at 45 degrees or less to the line across;
/// a flatter one has its borders on lines the other way. Else what is unseen of the near plane, as between scan lines,
/// would count as hidden.
template <Limits limits>
bool PlaneGap<limits>::hidden() const {
  for (int along = first_.along + 1; along < second_.along; ++along) {
    if (stages_.mixture.obstructed(stages_.dem, line_.slot(along))) return false;
  }
  const Sides seen = sides(rise_m() > 0.0f);
  const Passed edge = passed(seen);
  const float along_m = line_.axis == 0 ? edge.x_m : edge.y_m, across_m = line_.axis == 0 ? edge.y_m : edge.x_m;
  const float along = along_m / line_.pitch_m() - 0.5f - static_cast<float>(seen.near.along);
  const float across = (across_m - line_.across_m()) / line_.dem.cell_m(1 - line_.axis);
  return edge.near && magnitude(along) <= magnitude(across) + widest_blur;
}

template <Limits limits>
auto PlaneGap<limits>::passed(const Sides& sides) const -> Passed {
  const Dem<limits>& dem = stages_.dem;
  const auto [near, far] = sides;
  const int i = line_.row(far.along), j = line_.col(far.along), far_slot = dem.slot(i, j);
  const Viewpoint from = dem.seen_from(far_slot, stages_.view);
  const Cell& cell = dem.cell(far_slot);
  const float above_m = from.z_m - near.plane.height_m(from.x_m, from.y_m);
  const float below_m = -dem.above_m(i, j, cell, near.plane);
  if (!(above_m > 0.0f) || !(below_m > 0.0f)) return {};
  const float dx_m = dem.centroid_x_m(i, cell) - from.x_m, dy_m = dem.centroid_y_m(j, cell) - from.y_m;
  const float share = above_m / (above_m + below_m);  // of the ray, down to the plane
  const float cells = square_root(square(dx_m / dem.cell_x_m()) + square(dy_m / dem.cell_y_m()));
  Passed out;
  for (int back = 0; back <= widest_blur; ++back) {
    const float at = share - static_cast<float>(back) / cells;
    const float x_m = from.x_m + at * dx_m, y_m = from.y_m + at * dy_m;
    const int s = dem.slot_within(x_m, y_m);
    if (s < 0 || !stages_.bears_ground(s)) continue;
    if (stages_.field.label(s) == near.label) return {true, out.other, x_m, y_m};
    out.other = true;
  }
  return out;
}

template <Limits limits>
float PlaneGap<limits>::same_plane() const {
  const auto p = stages_.field.belief(stages_.dem, line_.slot(first_.along));
  const auto q = stages_.field.belief(stages_.dem, line_.slot(second_.along));
  float same = 0.0f;
  for (std::size_t m = 0; m < p.label.size(); ++m) {
    for (std::size_t n = 0; n < q.label.size(); ++n) {
      if (p.label[m] == q.label[n] && p.label[m] != no_label) same += p.probability[m] * q.probability[n];
    }
  }
  return same;
}

/// The middle of what parts the planes: of a face, or of what a step down hides. Halfway between the cells, unless the
/// planes are at least three standard deviations apart: then the cells of the gap locate it, except obstacles and what
/// they hide. Each cell errs independently, by anything within it; within obstacles the edge may be anywhere: if that
/// error is the larger one, or a cell is hidden, the border is open.
template <Limits limits>
auto PlaneGap<limits>::middle() const -> Middle {
  const float cell_m = line_.pitch_m();
  const auto cells = static_cast<float>(length() + 1);
  const float step_m = rise_m();
  const Sides seen = sides(step_m > 0.0f);
  const Face face = seen_face(seen, step_m > 0.0f);
  float before = 0.0f;  // in cells, from the first one's near side
  float covered = 0.0f, sloped = 0.0f;
  int empty = 0, first_empty = 0, last_empty = 0;
  for (int along = first_.along; along <= second_.along; ++along) {
    const int s = line_.slot(along);
    const Cell& cell = line_.dem.cell(s);
    if (!cell.valid()) {
      if (empty++ == 0) first_empty = along;
      last_empty = along;
      before += along < face.first ? 1.0f : along > face.last ? 0.0f : 0.5f;
    } else if (stages_.mixture.covered(s)) {
      covered += 1.0f;
      before += 0.5f;
    } else {
      const float far_share = line_.above_m(along, first_.plane) / step_m;
      before += before_middle({far_share, 0.5f + centroid_share(along, face) * line_.offset(cell)});
      if (along != first_.along && along != second_.along)
        sloped += sloped_cells(far_share, cell.scatter_m2 / (cell.weight * square(step_m)));
    }
  }
  const bool open =
      covered * covered > cells - covered || (empty > 0 && behind_obstacle(seen, first_empty, last_empty));
  if (2.0f * step_m * step_m <= gate * (first_.plane.variance_m2 + second_.plane.variance_m2))
    return {halfway_m(), open, false, empty, 0.0f};
  before = std::clamp(before, 0.0f, cells);
  return {(static_cast<float>(first_.along) + before) * cell_m, open, face.parted, empty, sloped};
}

/// Do the heights in a cell spread more than those of a plane?
template <Limits limits>
bool PlaneGap<limits>::mixed(int along, const Plane& plane) const {
  return line_.dem.mixed(line_.dem.cell(line_.slot(along)), line_.dem.slope_m2(plane));
}

/// Seen from its upper side, a step hides what is below its edge: empty cells there are no sign of missing scan lines.
template <Limits limits>
auto PlaneGap<limits>::seen_face(const Sides& sides, bool second_is_upper) const -> Face {
  Face face{first_.along, second_.along};
  const bool second_is_far = &sides.far == &second_;
  if (second_is_far != second_is_upper) return face;
  if (length() == 1) {
    const bool in_first = mixed(first_.along, first_.plane), in_second = mixed(second_.along, second_.plane);
    if (in_first == in_second) return {first_.along, second_.along, !in_first};
    return in_first ? Face{first_.along, first_.along} : Face{second_.along, second_.along};
  }
  const auto lies_on = [&](int along, const Cell& cell, const Plane& plane) {
    return stages_.lies_on(line_.row(along), line_.col(along), cell, plane);
  };
  for (int along = first_.along + 1; along < second_.along; ++along) {
    const int s = line_.slot(along);
    const Cell& cell = line_.dem.cell(s);
    if (!cell.valid() || stages_.mixture.covered(s) || !mixed(along, sides.near.plane)) continue;
    if (lies_on(along, cell, first_.plane) || lies_on(along, cell, second_.plane)) continue;
    if (face.first == first_.along) face.first = along;
    face.last = along;
  }
  return face;
}

/// What share of a cell's centroid, from its middle, counts. Where scan lines crossed a cell that lies on one plane
/// tells nothing of a face in another, and all rows share this error if lines run along the edge. If the face is in no
/// cell, it is between two lines, of which evenly spaced ones move the centroids of both cells alike: half of each
/// counts. What is unseen of a gap may reach into the cells on both sides: all of it counts.
template <Limits limits>
float PlaneGap<limits>::centroid_share(int along, const Face& face) const {
  if (along != first_.along && along != second_.along) return 1.0f;
  if (face.parted) return 0.5f;
  if (length() == 1) return along < face.first || along > face.last ? 0.0f : 1.0f;
  if (face.first > first_.along) return 0.0f;
  const int s = line_.slot(along == first_.along ? along + 1 : along - 1);
  return line_.dem.cell(s).valid() && !stages_.mixture.covered(s) ? 0.0f : 1.0f;
}

/// Does an obstacle hide the empty cell next to the gap's far side, from where that was seen? If so, a cell on the way
/// that is not ground is above the planes of both sides; the face of a step up is between them.
template <Limits limits>
bool PlaneGap<limits>::behind_obstacle(const Sides& sides, int first_empty, int last_empty) const {
  const Dem<limits>& dem = stages_.dem;
  const auto above = [&](int i, int j, const Cell& cell, const Plane& plane) {
    return dem.above_m(i, j, cell, plane) > 0.0f && !stages_.lies_on(i, j, cell, plane);
  };
  const Side& far = sides.far;
  const Viewpoint from = dem.seen_from(line_.slot(far.along), stages_.view);
  const int along = &far == &second_ ? last_empty : first_empty;
  const float middle_m = (static_cast<float>(along) + 0.5f) * line_.pitch_m();
  const float x_m = line_.x_m(middle_m), y_m = line_.y_m(middle_m);
  const float dx = (from.x_m - x_m) / dem.cell_x_m(), dy = (from.y_m - y_m) / dem.cell_y_m();
  const float cells = square_root(dx * dx + dy * dy);
  float x = x_m / dem.cell_x_m(), y = y_m / dem.cell_y_m();
  for (float passed = 1.0f; passed < cells; passed += 1.0f) {
    x += dx / cells;
    y += dy / cells;
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    if (!(x >= 0.0f) || !(y >= 0.0f) || i >= dem.rows() || j >= dem.cols()) return false;
    const int s = dem.slot(i, j);
    const Cell& cell = dem.cell(s);
    if (!cell.valid() || stages_.bears_ground(s)) continue;
    if (above(i, j, cell, first_.plane) && above(i, j, cell, second_.plane)) return true;
  }
  return false;
}

}  // namespace curbline
