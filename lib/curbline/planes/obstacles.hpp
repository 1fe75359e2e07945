// Which planes belong to obstacles. An obstacle is a region within whose cells heights spread as on more than 45
// degrees, unless they spread over less than a step and the region is wider than a wall: that is rough ground, grass or
// rubble, as anything as steep and as wide would rise higher. The cells around a box, which hold its sides, are a ring
// as wide as the box, but narrow along x or along y. So is the top of one: level, higher above the ground than a curb
// or a stair, smaller than a square metre or narrower than shoulders, and not part of a way. A way has beside it, as
// high above the ground, a plane that is no top, or one higher or lower by as much as the next step of a stair. A
// region that reaches the window's end may be larger than it looks, unless it is shorter than a metre along x and along
// y; so may one that begins where nothing is seen before it and, on a robot that drives, one that ends where nothing is
// seen beyond: the laser may not have looked there yet. Cost: a pass over the window, one more where there is rough
// ground or a ring, and two more where there may be tops.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>

#include "curbline/grid.hpp"
#include "curbline/index_set.hpp"
#include "curbline/map/cell_line.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/per_cell.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"

namespace curbline {

inline constexpr float highest_step_m = 0.3f;  ///< higher than any curb or stair

template <Limits limits>
class Obstacles {
 public:
  /// `region_label`: for each valid cell, the plane of its region.
  Obstacles(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
            const CellLabels<limits>& region_label);

  bool is(std::size_t label) const { return is_[label]; }
  /// Is it an obstacle higher than a step?
  bool high(std::size_t label) const { return high_[label]; }
  /// Is it small, level and higher than most steps, but part of a way?
  bool way(std::size_t label) const { return way_[label]; }
  /// Number of cells of a plane's region.
  float cells(std::size_t label) const { return cells_[label]; }
  /// A plane through the laser, other than level ground that the origin of a cloud lies on: no visible surface, but
  /// readings on the rays between an edge and the ground behind, or a single scan line on bent ground.
  static bool seen_edge_on(const Plane& plane, const Viewpoint& view) {
    return plane.steeper_than_ramp() && plane.passes_through(view.x_m, view.y_m, view.z_m);
  }
  /// The reference for the others: the largest plane that is neither an obstacle nor seen edge-on; null if none is.
  const Plane* ground() const { return ground_; }

 private:
  using PlaneFlags = std::array<bool, limits.planes>;
  using Neighbours = std::array<IndexSet<limits.planes>, limits.planes>;
  static constexpr float usual_step_m = 0.2f;  ///< few curbs or stairs are higher
  static constexpr float way_m = 1.0f;         ///< side of the smallest square of raised ground; stairs lead on
  static constexpr float shoulders_m = 0.5f;   ///< narrowest raised ground; less is a wall

  /// Extent of a plane's region.
  struct Extent {
    bool reaches_end = false;  ///< of what has been seen of the window
    float thin_cells = 0.0f;   ///< cells in runs shorter than shoulders, along x or along y
    std::array<int, 2> first{limits.rows, limits.cols}, last{};  ///< cells, along x and along y

    void add(int i, int j) {
      first = {std::min(first[0], i), std::min(first[1], j)};
      last = {std::max(last[0], i), std::max(last[1], j)};
    }
    bool touches_end_of(const Extent& seen) const {
      return first[0] == seen.first[0] || first[1] == seen.first[1] || last[0] == seen.last[0] ||
             last[1] == seen.last[1];
    }
    bool narrow(float cells) const { return 2.0f * thin_cells >= cells; }
    float length_m(std::size_t axis, float cell_m) const {
      return static_cast<float>(last[axis] - first[axis] + 1) * cell_m;
    }
  };
  using Extents = std::array<Extent, limits.planes>;

  /// Do heights with this variance spread, evenly, over more than a step?
  static bool higher_than_step(float variance_m2) {
    return variance_m2 > highest_step_m * highest_step_m * (1.0f / 12);
  }
  bool smaller_than_way(const Extent& extent, float cells) const {
    const float cell_x_m = dem_.cell_x_m(), cell_y_m = dem_.cell_y_m();
    if (!extent.reaches_end && cells * cell_x_m * cell_y_m < way_m * way_m) return true;
    return extent.length_m(0, cell_x_m) < way_m && extent.length_m(1, cell_y_m) < way_m;
  }
  void add_rings(const PlaneFlags& wide);
  void add_tops();
  void take_ways_from(PlaneFlags& top, const Neighbours& beside);
  Extents extents_of(const PlaneFlags& asked) const;
  bool thin(const CellLine<limits>& line, int at, Label label) const;
  Neighbours neighbours(const PlaneFlags& asked) const;

  const Dem<limits>& dem_;
  const std::span<const Plane> planes_;
  const Viewpoint& view_;
  const CellLabels<limits>& region_label_;
  PlaneFlags is_{}, high_{}, way_{};
  std::array<float, limits.planes> cells_{};
  const Plane* ground_ = nullptr;
};

template <Limits limits>
Obstacles<limits>::Obstacles(const Dem<limits>& dem, std::span<const Plane> planes, const Viewpoint& view,
                             const CellLabels<limits>& region_label)
    : dem_(dem), planes_(planes), view_(view), region_label_(region_label) {
  std::array<float, limits.planes> spread{}, weight{};
  dem_.for_each_valid([&](int, int, int s) {
    const Label label = region_label_[s];
    if (label == no_label) return;
    cells_[label] += 1.0f;
    spread[label] += dem_.spread_m2(dem_.cell(s));
    weight[label] += dem_.cell(s).weight;
  });
  PlaneFlags wide{};
  for (std::size_t l = 0; l < planes_.size(); ++l) {
    const bool steep = dem_.steep(spread[l], weight[l]);
    high_[l] = steep && higher_than_step(planes_[l].variance_m2);
    is_[l] = steep && (high_[l] || planes_[l].narrower_than(shoulders_m));
    wide[l] = steep && !is_[l];
  }
  add_rings(wide);
  for (std::size_t l = 0; l < planes_.size(); ++l) {
    if (!planes_[l].alive() || is_[l] || seen_edge_on(planes_[l], view)) continue;
    if (ground_ == nullptr || planes_[l].cells > ground_->cells) ground_ = &planes_[l];
  }
  if (ground_ != nullptr) add_tops();
}

/// Of steep regions that are wide, those that are narrow wherever they are crossed.
template <Limits limits>
void Obstacles<limits>::add_rings(const PlaneFlags& wide) {
  if (std::ranges::none_of(wide, std::identity{})) return;
  const Extents extents = extents_of(wide);
  for (std::size_t l = 0; l < wide.size(); ++l) is_[l] = is_[l] || (wide[l] && extents[l].narrow(cells_[l]));
}

template <Limits limits>
void Obstacles<limits>::add_tops() {
  PlaneFlags level{};  // and raised
  for (std::size_t l = 0; l < planes_.size(); ++l) {
    level[l] =
        planes_[l].alive() && !is_[l] && !planes_[l].steeper_than_ramp() && planes_[l].above_m(*ground_) > usual_step_m;
  }
  if (std::ranges::none_of(level, std::identity{})) return;
  const Extents extents = extents_of(level);
  PlaneFlags top{};
  for (std::size_t l = 0; l < top.size(); ++l) {
    top[l] = level[l] && (smaller_than_way(extents[l], cells_[l]) || extents[l].narrow(cells_[l]));
  }
  take_ways_from(top, neighbours(level));
  for (std::size_t l = 0; l < top.size(); ++l) {
    if (top[l]) is_[l] = high_[l] = true;
  }
}

/// Tops that lead on are ways. A way found may make a way of the top beside it.
template <Limits limits>
void Obstacles<limits>::take_ways_from(PlaneFlags& top, const Neighbours& beside) {
  const auto leads_on = [&](std::size_t l) {
    bool found = false;
    beside[l].for_each([&](int m) {
      const auto other = static_cast<std::size_t>(m);
      const float apart_m = planes_[other].above_m(*ground_) - planes_[l].above_m(*ground_);
      found = found || !top[other] || square(apart_m) > square(0.5f * usual_step_m);
    });
    return found;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t l = 0; l < top.size(); ++l) {
      if (!top[l] || !leads_on(l)) continue;
      top[l] = false;
      way_[l] = changed = true;
    }
  }
}

template <Limits limits>
auto Obstacles<limits>::extents_of(const PlaneFlags& asked) const -> Extents {
  Extents found{};
  Extent seen;
  dem_.for_each_valid([&](int i, int j, int s) {
    seen.add(i, j);
    const Label label = region_label_[s];
    if (label == no_label || !asked[label]) return;
    Extent& extent = found[label];
    extent.add(i, j);
    if (thin({dem_, 0, j}, i, label) || thin({dem_, 1, i}, j, label)) extent.thin_cells += 1.0f;
  });
  for (Extent& extent : found) extent.reaches_end = extent.touches_end_of(seen);
  return found;
}

/// Is the run of cells of this label through a cell, on its row or column, shorter than shoulders? Not if it may go on:
/// beyond the window's end; toward the laser, where nothing is seen; or away from the laser of a robot that drives,
/// where nothing is seen up to the window's end, so that it may not have looked there yet.
template <Limits limits>
bool Obstacles<limits>::thin(const CellLine<limits>& line, int at, Label label) const {
  const float cell_m = line.pitch_m();
  const int toward = -line.away(view_, at);
  int length = 1;
  for (const int step : {toward, -toward}) {
    int last = at;
    for (int k = at + step;; k += step) {
      if (static_cast<float>(length) * cell_m >= shoulders_m || k < 0 || k >= line.cells()) return false;
      const int slot = line.slot(k);
      const bool seen = dem_.cell(slot).valid();
      if (!seen && step == toward) return false;
      if (!seen && view_.drives()) continue;
      if (!seen || region_label_[slot] != label) break;
      length += step * (k - last);
      last = k;
    }
  }
  return true;
}

/// Which of the planes asked for are adjacent, on a row or a column.
template <Limits limits>
auto Obstacles<limits>::neighbours(const PlaneFlags& asked) const -> Neighbours {
  Neighbours found{};
  dem_.for_each_valid([&](int i, int j, int s) {
    const Label label = region_label_[s];
    if (label == no_label || !asked[label]) return;
    const auto meet = [&](int p, int q) {
      if (p >= dem_.rows() || q >= dem_.cols()) return;
      const int slot = dem_.slot(p, q);
      const Label other = dem_.cell(slot).valid() ? region_label_[slot] : no_label;
      if (other == no_label || other == label || !asked[other]) return;
      found[label].insert(other);
      found[other].insert(label);
    };
    for (int away = 1; away <= widest_gap + 1; ++away) meet(i + away, j), meet(i, j + away);
  });
  return found;
}

}  // namespace curbline
