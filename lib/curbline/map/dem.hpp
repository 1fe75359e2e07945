// The elevation map: the contents of the cells of the rolling window (window.hpp). For each cell its heights
// (cell.hpp), its neighbours (next_cells.hpp), when and from where it was last seen (last_seen.hpp), and how its height
// depends on the tilt's latency. Cells that leave the window are cleared.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "curbline/frames.hpp"
#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/map/cell.hpp"
#include "curbline/map/laser_way.hpp"
#include "curbline/map/last_seen.hpp"
#include "curbline/map/next_cells.hpp"
#include "curbline/map/window.hpp"
#include "curbline/math.hpp"
#include "curbline/per_cell.hpp"
#include "curbline/plane.hpp"
#include "curbline/point.hpp"
#include "curbline/pose.hpp"
#include "curbline/settings.hpp"
#include "curbline/sweeps.hpp"

namespace curbline {

template <Limits limits>
class Dem : public Window<limits> {
 public:
  static constexpr int capacity = limits.rows * limits.cols;
  using typename Window<limits>::Place;
  using Window<limits>::rows;
  using Window<limits>::cols;
  using Window<limits>::cell_x_m;
  using Window<limits>::cell_y_m;
  using Window<limits>::origin_x_m;
  using Window<limits>::origin_y_m;
  using Window<limits>::place_at;

  /// Empties the map and places the window. Settings are valid.
  [[gnu::cold]] void init(const WindowSettings& settings, const PlanePrior& prior);

  /// Makes the window follow the robot, unless it is fixed. Clears cells that leave, after calling left(slot) for each
  /// valid one. O(1), or a pass over the window if it moves.
  template <typename Left>
  void follow(const Transform& T_map_base, Left&& left);

  /// Takes a point into its cell. False if it is outside the window, above its ceiling, beyond Pose::furthest_m above
  /// or below, has a place, height or variance that is not finite, or a weight below 1e-9; the weight is the expected
  /// noise over the point's variance plus the ground's texture, 1e9 at most. A growth that is not finite leaves the
  /// cell's as it was. In a cell of more than one surface, the first point of a sweep makes earlier sweeps fade. O(1).
  bool add(const Point& point);

  /// Corrects heights for sweeps that are later than assumed. Cells do not count as touched: neighbours move alike.
  void delay(const BySweep& later_s, const SweepRates& rates);
  /// Corrects them for a laser that looks farther down than assumed, by how far ahead cells lay when they were seen.
  void lean(float by_rad);

  // Its cells.

  const Cell& cell(int slot) const { return cells_[slot]; }
  /// Mean height of a cell above a plane, at the cell's centroid.
  float above_m(int i, int j, const Cell& cell, const Plane& plane) const {
    return cell.height_m - plane.height_m(centroid_x_m(i, cell), centroid_y_m(j, cell));
  }
  float centroid_x_m(int i, const Cell& cell) const { return (static_cast<float>(i) + 0.5f) * cell_x_m() + cell.dx_m; }
  float centroid_y_m(int j, const Cell& cell) const { return (static_cast<float>(j) + 0.5f) * cell_y_m() + cell.dy_m; }
  /// Moments of one cell, its points as if at their centroid, in the window's frame (origin at its lowest corner). n
  /// points that share a part rho of their variance are worth n / (1 + rho (n - 1)) independent ones (Kish's design
  /// effect).
  PlaneMoments moments(int i, int j, const Cell& cell) const {
    PlaneMoments m;
    const float share = 1.0f / (1.0f + prior_.common_share * (cell.points - 1.0f));
    m.cells = 1.0f;
    m.points = cell.points * share;
    m.weight = cell.weight * share;
    m.x = centroid_x_m(i, cell);
    m.y = centroid_y_m(j, cell);
    m.z = cell.height_m;
    m.zz = cell.scatter_m2 * share;
    return m;
  }

  /// Calls visit(i, j, slot) for each valid cell, row by row.
  template <typename Visit>
  void for_each_valid(Visit&& visit) const {
    for (int i = 0; i < rows(); ++i) for_each_valid_in_row(i, visit);
  }
  template <typename Visit>
  void for_each_valid_in_row(int i, Visit&& visit) const {
    for_each_valid_along(1, i, [&](int j, int s) { visit(i, j, s); });
  }
  /// Calls visit(k, slot) for each valid cell k of a column, along x (axis 0), or of a row, along y (1).
  template <typename Visit>
  void for_each_valid_along(int axis, int line, Visit&& visit) const {
    auto at = this->walk_along(axis, line);
    for (int k = 0; k < at.count; ++k, at.next()) {
      if (cell(at.slot).valid()) visit(k, at.slot);
    }
  }
  /// Distance in cells from a valid cell to the next valid one in a direction; 0 if there is none within `reach` cells,
  /// at most max_link_reach. O(1).
  int next_valid(int slot, int direction, int reach) const { return next_.distance(slot, direction, reach); }
  /// The nearest valid unmarked cell on the row and column of a place inside the window, at most `reach` away.
  Place nearest_unmarked(const Place& place, int reach) const;

  // Spread of the heights within a cell, and noise.

  /// The prior, with PlanePrior::common_share as last estimated, but at least the texture's part.
  const PlanePrior& prior() const { return prior_; }
  /// Variance that the points of a cell share: as estimated, at first the prior's.
  float common_m2() const { return common_m2_; }
  /// Variance of the error that the cells of a row share, by the tilt and pose of the scan line that has seen them, for
  /// cells of one point. More points are of more lines: divide by their number.
  float line_m2() const { return line_m2_; }
  /// Sets both as estimated; in evidences the shared part counts as at least the ground's texture.
  void set_common(float found_m2, float found_line_m2) {
    common_m2_ = found_m2;
    line_m2_ = found_line_m2;
    prior_.common_share = std::max(prior_.texture_m2, found_m2) / prior_.noise_m2;
  }

  /// Variance of a cell's mean height, from the noise of its points.
  float height_variance_m2(const Cell& cell) const { return prior_.noise_m2 / cell.weight; }
  /// Scatter of a cell's heights beyond the noise of its points; may be below 0 by chance.
  float spread_m2(const Cell& cell) const { return cell.scatter_m2 - prior_.noise_m2 * cell.points; }
  /// Do its heights spread by two standard deviations of that noise? Then it holds several surfaces, or a steep one, or
  /// one after another.
  bool several_surfaces(const Cell& cell) const { return cell.scatter_m2 > 4.0f * prior_.noise_m2 * cell.points; }
  /// Do heights within cells spread beyond noise as on a slope of 45 degrees? Then they are an obstacle's. For several
  /// cells, pass the sums of their spreads and weights.
  bool steep(float spread_m2, float weight) const { return spread_m2 > (1.0f / 12) * cell_x_m() * cell_y_m() * weight; }
  bool steep(const Cell& cell) const { return steep(spread_m2(cell), cell.weight); }
  /// Variance of a plane's heights within a cell.
  float slope_m2(const Plane& plane) const {
    const float rise_x_m = plane.slope_x * cell_x_m(), rise_y_m = plane.slope_y * cell_y_m();
    return (rise_x_m * rise_x_m + rise_y_m * rise_y_m) * (1.0f / 12);
  }
  /// Do the heights of a cell spread by two standard deviations beyond noise and the slope of its plane? Then it holds
  /// more than the plane.
  bool mixed(const Cell& cell, float slope_m2) const { return spreads(cell, slope_m2, prior_.noise_m2); }
  /// The same on rough ground.
  bool mixed(const Cell& cell, float slope_m2, float rough_m2) const {
    return spreads(cell, slope_m2, prior_.noise_m2 + rough_m2 * cell.weight / cell.points);
  }

  // When and from where a cell was last seen.

  /// Has a cell changed since clear_touched(): by a point, or by being cleared?
  bool touched(int slot) const { return last_seen_.touched(slot); }
  /// Has any cell of a block changed? `first`: the slot of its first cell.
  bool block_touched(int first) const { return last_seen_.block_touched(first); }
  void clear_touched() { last_seen_.clear_touched(); }
  bool any_touched() const { return last_seen_.any_touched(); }

  /// A new sweep begins. A pass over the window.
  void begin_sweep() { last_seen_.begin_sweep(); }
  /// Was the cell seen by an earlier sweep, and not yet by this one?
  bool mapped_before(int slot) const { return cell(slot).valid() && !last_seen_.in_this_sweep(slot); }
  /// Cells seen from now on are marked. A pass over the window.
  void begin_marking() { last_seen_.begin_marking(); }
  bool marked(int slot) const { return last_seen_.marked(slot); }
  /// Where the laser is from now on, in the map frame, and what is ahead: the horizontal part of the tilt axis, turned
  /// to its right.
  void look_from(float x_m, float y_m, const SinCos& ahead = {0.0f, 1.0f}) {
    laser_ = {x_m, y_m};
    ahead_is_ = ahead;
    last_seen_.look_from(x_m, y_m);
  }
  /// From where a cell was last seen: `now`, with the laser's earlier place if it has moved, at the height of now.
  // Not inlined: it is called for edges only.
  [[gnu::noinline]] Viewpoint seen_from(int slot, const Viewpoint& now) const {
    if (!seen_from_several()) return now;
    const LaserWay::Position& from = last_seen_.from(slot);
    Viewpoint view = now;
    view.x_m = from.x_m - origin_x_m();
    view.y_m = from.y_m - origin_y_m();
    return view;
  }
  /// What is ahead, as of look_from(). Scan lines on level ground run across it.
  const SinCos& ahead_is() const { return ahead_is_; }
  /// How far ahead of the tilt axis a place in the map frame lies: by how much a radian more of tilt lowers it. What
  /// lies beyond 30 m counts as there.
  float ahead_m(float x_m, float y_m) const {
    const float ahead_m = (x_m - laser_.x_m) * ahead_is_.cos + (y_m - laser_.y_m) * ahead_is_.sin;
    return std::clamp(ahead_m, -farthest_ahead_m, farthest_ahead_m);
  }
  /// How much farther ahead than the points of this cell, in the mean, when they were seen.
  float farther_m(int slot, float x_m, float y_m) const { return ahead_m(x_m, y_m) - mean_ahead_m(slot); }
  /// Has the laser moved? If not, all cells were seen from one place.
  bool seen_from_several() const { return last_seen_.from_several(); }

  /// Mean growth of its points' heights with the tilt's latency.
  float growth_m_s(int slot) const { return mean_of(growth_[slot]); }
  /// Its parts, G = G_now + G_last + G_before, by the points of this sweep, of the last one, and of the one before,
  /// which turned the other way. A point X ahead grows by -w X in a sweep that turns at w. So, with the rates w of the
  /// last sweep and v of the one before and the mean X of the cell's points (lib/formulas.md, Tilt latency):
  ///   G_last = w (G + v X) / (w - v), G_before + G_now = v (G + w X) / (v - w).
  /// G_now = 0 in ground that this sweep has not seen, or whose G has the sign of the last one's growths. Else G_now =
  /// G, as if the earlier growths had cancelled: of ground seen for long, whose G is about 0, hardly any is this
  /// sweep's.
  BySweep growths_m_s(int slot, const SweepRates& rates) const {
    const float all_m_s = growth_m_s(slot), uncancelled_m_s = -rates.last_rad_s * mean_ahead_m(slot);
    const float this_way_m_s = rates.this_share * (all_m_s - uncancelled_m_s);
    const bool of_earlier = mapped_before(slot) || all_m_s * uncancelled_m_s > 0.0f;
    const float now_m_s = of_earlier ? 0.0f : all_m_s;
    return {now_m_s, all_m_s - this_way_m_s, this_way_m_s - now_m_s};
  }

 private:
  /// Share that the earlier sweeps of a cell with several surfaces keep when a new sweep sees it. After a few sweeps a
  /// person who has left is forgotten, and one who has come is known; ground that stays is known the better the longer
  /// it is seen.
  static constexpr float memory = 0.25f;
  /// A cell's points count as no more than this, in favour of the newest. More would add nothing, since they share a
  /// part of their errors: 512 that share a half leave 1 in 500 to know. A change is known after as many points,
  /// however long the robot has stood there.
  static constexpr float most_points = 512.0f;
  static constexpr int mean_scale = 1024;
  static constexpr float most_mean = most_growth_m_s;  ///< m/s, and m: a little less than 2^15 / mean_scale
  static constexpr float farthest_ahead_m = 30.0f;
  /// Of a point: beyond these, float would lose it beside the others, or the others beside it.
  static constexpr float least_weight = 1e-9f, most_weight = 1e9f;
  /// By two standard deviations beyond slope and noise?
  static bool spreads(const Cell& cell, float slope_m2, float noise_m2) {
    const float freedom = cell.points - 1.0f;  // of the noise's scatter, chi^2
    const float beyond_m2 = cell.scatter_m2 - slope_m2 * cell.weight - noise_m2 * freedom;
    return beyond_m2 > 0.0f && square(beyond_m2) > 4.0f * 2.0f * freedom * square(noise_m2);
  }
  static float mean_of(std::int16_t held) { return static_cast<float>(held) * (1.0f / mean_scale); }
  float mean_ahead_m(int slot) const { return mean_of(ahead_[slot]); }
  static void follow_mean(std::int16_t& held, float value, float share, float lot);
  void add_means(int s, const Point& point, float weight);
  void leave(int s);

  PlanePrior prior_{};
  float common_m2_ = 0.0f;
  PerCell<Cell, limits> cells_{};
  LastSeen<limits> last_seen_{};
  PerCell<std::int16_t, limits> growth_{};  ///< mean of its points, in 1 / mean_scale m/s
  PerCell<std::int16_t, limits> ahead_{};   ///< the same of ahead_m(), in 1 / mean_scale m
  NextCells<limits> next_{};
  float line_m2_ = 0.0f;  ///< CommonNoise::line_m2(). Placed behind the cells: before them it costs the worst line
                          ///< of a Cortex-R5F 9,000 instructions (tools/budget)
  LaserWay::Position laser_{};
  SinCos ahead_is_{0.0f, 1.0f};
};

template <Limits limits>
void Dem<limits>::init(const WindowSettings& settings, const PlanePrior& prior) {
  Window<limits>::init(settings);
  prior_ = prior;
  common_m2_ = prior.common_m2();
  line_m2_ = 0.0f;
  cells_.fill(Cell{});
  last_seen_.init(std::max(this->length_m(0), this->length_m(1)));
  growth_.fill(0);
  ahead_.fill(0);
  laser_ = {};
  ahead_is_ = {0.0f, 1.0f};
  next_.init();
}

template <Limits limits>
template <typename Left>
void Dem<limits>::follow(const Transform& T_map_base, Left&& left) {
  this->lift(T_map_base.translation.z());
  const auto to = this->corner_of(T_map_base);
  if (to == this->corner()) return;
  for (int i = 0; i < rows(); ++i) {
    const bool row_stays = this->row_stays(i, to);
    for (int j = 0; j < cols(); ++j) {
      if (row_stays && this->col_stays(j, to)) continue;
      const int s = this->slot(i, j);
      if (!cell(s).valid()) continue;
      left(s);
      leave(s);
    }
  }
  this->move(to);
}

template <Limits limits>
void Dem<limits>::leave(int s) {
  next_.leave(*this, s);
  cells_[s] = Cell{};
  growth_[s] = ahead_[s] = 0;
  last_seen_.touch(s);
}

template <Limits limits>
auto Dem<limits>::nearest_unmarked(const Place& place, int reach) const -> Place {
  const auto unmarked = [this](int s) { return cell(s).valid() && !marked(s); };
  if (unmarked(this->slot(place.i, place.j))) return place;
  for (int g = 1; g <= reach; ++g) {
    for (std::size_t d = 0; d < directions; ++d) {
      const int i = place.i + g * step_i[d], j = place.j + g * step_j[d];
      if (this->contains(i, j) && unmarked(this->slot(i, j))) return {i, j};
    }
  }
  return {};
}

template <Limits limits>
bool Dem<limits>::add(const Point& point) {
  const bool near = square(point.z_m) <= square(Pose::furthest_m);  // false for NaN
  if (!near || point.z_m > this->ceiling_m() || !(point.variance_m2 >= 0.0f)) return false;
  // Without noise, on ground without texture, infinite.
  const float weight = std::min(most_weight, prior_.noise_m2 / (point.variance_m2 + prior_.texture_m2));
  if (!(weight >= least_weight)) return false;  // false for an infinite variance too
  const Place place = place_at(point.place_x_m(), point.place_y_m());
  if (!place.inside()) return false;
  const int i = place.i, j = place.j;
  const int s = this->slot(i, j);
  if (!cells_[s].valid()) next_.enter(*this, i, j, [this](int other) { return cell(other).valid(); });
  if (mapped_before(s) && several_surfaces(cells_[s])) cells_[s].fade(memory);
  cells_[s].add((place.u - static_cast<float>(i) - 0.5f) * cell_x_m() - point.shift_x_m,
                (place.v - static_cast<float>(j) - 0.5f) * cell_y_m() - point.shift_y_m, point.z_m, weight);
  add_means(s, point, weight);
  if (cells_[s].points > most_points) cells_[s].fade(most_points / cells_[s].points);
  last_seen_.touch(s);
  return true;
}

/// Called after the point has been added. A mean of many points changes by less than the stored resolution, so it is
/// rounded stochastically: up as often as its fraction says, with the last bits of the point's height for random
/// numbers.
template <Limits limits>
void Dem<limits>::add_means(int s, const Point& point, float weight) {
  const float share = weight / cells_[s].weight;
  const float lot = static_cast<float>((std::bit_cast<std::uint32_t>(point.z_m) * 2654435769u) >> 8) * 0x1p-24f;
  follow_mean(growth_[s], point.growth_m_s, share, lot);
  follow_mean(ahead_[s], ahead_m(point.x_m, point.y_m), share, lot);
}

template <Limits limits>
void Dem<limits>::follow_mean(std::int16_t& held, float value, float share, float lot) {
  const float before = mean_of(held), now = before + share * (value - before);
  if (now > -most_mean && now < most_mean) held = static_cast<std::int16_t>(floor_to_int(now * mean_scale + lot));
}

template <Limits limits>
void Dem<limits>::delay(const BySweep& later_s, const SweepRates& rates) {
  for_each_valid([&](int, int, int s) {
    const BySweep by = growths_m_s(s, rates);
    cells_[s].height_m += by.now * later_s.now + by.last * later_s.last + by.before * later_s.before;
  });
}

template <Limits limits>
void Dem<limits>::lean(float by_rad) {
  for_each_valid([&](int, int, int s) { cells_[s].height_m -= by_rad * mean_ahead_m(s); });
}

}  // namespace curbline
