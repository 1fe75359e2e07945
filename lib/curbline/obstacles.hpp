// What stands on the ground: which planes are of obstacles. A region within whose cells the heights spread as on a
// slope of more than 45 degrees; and the top of one: level, less than a square metre, higher above the ground than a
// kerb or a stair, and no way that leads on. A way has beside it, as high above the ground, one that is no top, or lies
// higher or lower by as much as the next step of a stair does. Cost: a pass over the window, and two more where there
// may be tops.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "curbline/dem.hpp"
#include "curbline/index_set.hpp"
#include "curbline/plane.hpp"

namespace curbline {

inline constexpr float highest_step_m = 0.3f;  ///< no kerb or stair is as high

template <Limits limits>
class Obstacles {
 public:
  /// label_of(slot) is the plane of a valid cell's region, `none` if it has none.
  template <typename LabelType, typename LabelOf>
  Obstacles(const Dem<limits>& dem, std::span<const Plane> planes, LabelType none, LabelOf&& label_of);

  bool is(std::size_t label) const { return is_[label]; }
  /// Is it one that is higher than a step?
  bool high(std::size_t label) const { return high_[label]; }
  /// Is it small, level and higher than most steps, but part of a way?
  bool way(std::size_t label) const { return way_[label]; }
  /// In how many cells a plane's region lies.
  float cells(std::size_t label) const { return cells_[label]; }
  /// The largest plane that is none, null if there is none: what the others are measured against.
  const Plane* ground() const { return ground_; }

 private:
  using PlaneFlags = std::array<bool, limits.planes>;
  using Neighbours = std::array<IndexSet<limits.planes>, limits.planes>;
  static constexpr float usual_step_m = 0.2f;  ///< few kerbs or stairs are as high
  static constexpr float way_m = 1.0f;         ///< a square of ground that lies higher is no smaller: stairs lead on
  static constexpr int widest_gap = 2;         ///< between planes that lie beside each other, in cells: a face

  template <typename LabelType, typename LabelOf>
  void add_tops(const Dem<limits>& dem, std::span<const Plane> planes, LabelType none, LabelOf&& label_of);
  template <typename LabelType, typename LabelOf>
  static PlaneFlags at_edge(const Dem<limits>& dem, LabelType none, LabelOf&& label_of);
  template <typename LabelType, typename LabelOf>
  static Neighbours neighbours(const Dem<limits>& dem, LabelType none, LabelOf&& label_of, const PlaneFlags& asked);

  PlaneFlags is_{}, high_{}, way_{};
  std::array<float, limits.planes> cells_{};
  const Plane* ground_ = nullptr;
};

template <Limits limits>
template <typename LabelType, typename LabelOf>
Obstacles<limits>::Obstacles(const Dem<limits>& dem, std::span<const Plane> planes, LabelType none,
                             LabelOf&& label_of) {
  std::array<float, limits.planes> spread{}, weight{};
  dem.for_each_valid([&](int, int, int s) {
    const LabelType label = label_of(s);
    if (label == none) return;
    cells_[label] += 1.0f;
    spread[label] += dem.spread_m2(dem.cell(s));
    weight[label] += dem.cell(s).weight;
  });
  for (std::size_t l = 0; l < planes.size(); ++l) {
    is_[l] = dem.steep(spread[l], weight[l]);
    high_[l] = is_[l] && planes[l].variance_m2 > highest_step_m * highest_step_m * (1.0f / 12);
    if (!planes[l].alive() || is_[l]) continue;
    if (ground_ == nullptr || planes[l].cells > ground_->cells) ground_ = &planes[l];
  }
  if (ground_ != nullptr) add_tops(dem, planes, none, label_of);
}

template <Limits limits>
template <typename LabelType, typename LabelOf>
void Obstacles<limits>::add_tops(const Dem<limits>& dem, std::span<const Plane> planes, LabelType none,
                                 LabelOf&& label_of) {
  PlaneFlags level{}, top{};  // and above the ground by more than a step
  bool any = false;
  for (std::size_t l = 0; l < planes.size(); ++l) {
    level[l] =
        planes[l].alive() && !is_[l] && !planes[l].steeper_than_ramp() && planes[l].above_m(*ground_) > usual_step_m;
    top[l] = level[l] && cells_[l] * dem.cell_x_m() * dem.cell_y_m() < way_m * way_m;
    any = any || top[l];
  }
  if (!any) return;
  const PlaneFlags edge = at_edge(dem, none, label_of);
  const Neighbours beside = neighbours(dem, none, label_of, level);
  for (std::size_t l = 0; l < top.size(); ++l) top[l] = top[l] && !edge[l];
  const auto leads_on = [&](std::size_t l) {
    bool found = false;
    beside[l].for_each([&](int m) {
      const auto other = static_cast<std::size_t>(m);
      const float apart_m = planes[other].above_m(*ground_) - planes[l].above_m(*ground_);
      found = found || !top[other] || square(apart_m) > square(0.5f * usual_step_m);
    });
    return found;
  };
  for (bool changed = true; changed;) {  // a way that is found may make one of what lies beside it
    changed = false;
    for (std::size_t l = 0; l < top.size(); ++l) {
      if (!top[l] || !leads_on(l)) continue;
      top[l] = false;
      way_[l] = changed = true;
    }
  }
  for (std::size_t l = 0; l < top.size(); ++l) {
    if (top[l]) is_[l] = high_[l] = true;
  }
}

/// Which planes reach the end of the window.
template <Limits limits>
template <typename LabelType, typename LabelOf>
auto Obstacles<limits>::at_edge(const Dem<limits>& dem, LabelType none, LabelOf&& label_of) -> PlaneFlags {
  PlaneFlags found{};
  dem.for_each_valid([&](int i, int j, int s) {
    if (i > 0 && j > 0 && i < dem.rows() - 1 && j < dem.cols() - 1) return;
    if (const LabelType label = label_of(s); label != none) found[label] = true;
  });
  return found;
}

/// Of the planes that are asked for, which lie beside which, on a row or a column.
template <Limits limits>
template <typename LabelType, typename LabelOf>
auto Obstacles<limits>::neighbours(const Dem<limits>& dem, LabelType none, LabelOf&& label_of, const PlaneFlags& asked)
    -> Neighbours {
  Neighbours found{};
  dem.for_each_valid([&](int i, int j, int s) {
    const LabelType label = label_of(s);
    if (label == none || !asked[label]) return;
    const auto meet = [&](int p, int q) {
      if (p >= dem.rows() || q >= dem.cols()) return;
      const int slot = dem.slot(p, q);
      const LabelType other = dem.cell(slot).valid() ? label_of(slot) : none;
      if (other == none || other == label || !asked[other]) return;
      found[label].insert(other);
      found[other].insert(label);
    };
    for (int away = 1; away <= widest_gap + 1; ++away) meet(i + away, j), meet(i, j + away);
  });
  return found;
}

}  // namespace curbline
