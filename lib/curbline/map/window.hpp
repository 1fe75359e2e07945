// The rolling window: where its cells lie, in the map and in memory. A two-dimensional ring buffer: no cell is copied
// when the window moves. Cells are addressed by (i, j), i along x, from the window's lowest corner; stages store what
// belongs to a cell under its slot, which stays the same while the cell is in the window.
#pragma once

#include <cstdint>

#include "curbline/frames.hpp"
#include "curbline/grid.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/point.hpp"
#include "curbline/settings.hpp"

namespace curbline {

template <Limits limits>
class Window {
 public:
  /// Places it. Settings are valid.
  void init(const WindowSettings& settings) {
    settings_ = settings;
    ceiling_m_ = settings.max_height_m;
    corner_ = {};
    row_shift_ = col_shift_ = 0;
  }

  int rows() const { return settings_.rows; }
  int cols() const { return settings_.cols; }
  float cell_x_m() const { return settings_.cell_x_m; }
  float cell_y_m() const { return settings_.cell_y_m; }
  /// Along x (axis 0) or y (1).
  int cells_along(int axis) const { return axis == 0 ? settings_.rows : settings_.cols; }
  float cell_m(int axis) const { return axis == 0 ? settings_.cell_x_m : settings_.cell_y_m; }
  /// Mean of both sides of a cell.
  float pitch_m() const { return 0.5f * (cell_x_m() + cell_y_m()); }
  float length_m(int axis) const { return static_cast<float>(cells_along(axis)) * cell_m(axis); }
  /// Lowest corner in the map frame.
  float origin_x_m() const { return static_cast<float>(corner_.row) * settings_.cell_x_m + settings_.origin_x_m; }
  float origin_y_m() const { return static_cast<float>(corner_.col) * settings_.cell_y_m + settings_.origin_y_m; }
  /// The middle of cells of row i, and of column j, in the map frame.
  float middle_x_m(int i) const { return origin_x_m() + (static_cast<float>(i) + 0.5f) * settings_.cell_x_m; }
  float middle_y_m(int j) const { return origin_y_m() + (static_cast<float>(j) + 0.5f) * settings_.cell_y_m; }

  /// Points above are ignored; z of the map frame.
  float ceiling_m() const { return ceiling_m_; }
  /// The window and one cell around it: what lies outside is outside the window, however places are rounded.
  Bounds surroundings() const {
    const float x_m = origin_x_m(), y_m = origin_y_m();
    return {x_m - cell_x_m(), y_m - cell_y_m(), x_m + static_cast<float>(rows() + 1) * cell_x_m(),
            y_m + static_cast<float>(cols() + 1) * cell_y_m(), ceiling_m_};
  }

  bool contains(int i, int j) const { return i >= 0 && j >= 0 && i < settings_.rows && j < settings_.cols; }
  int slot(int i, int j) const {
    i += row_shift_;
    j += col_shift_;
    if (i >= settings_.rows) i -= settings_.rows;
    if (j >= settings_.cols) j -= settings_.cols;
    return i * limits.cols + j;
  }
  /// Slot of the cell that lies so many cells from another in a direction (grid.hpp), both in the window.
  int slot_beside(int slot, int direction, int distance) const {
    const bool along_x = direction < 2;
    const int step = along_x ? limits.cols : 1, end = cells_along(along_x ? 0 : 1) * step;
    const int way = (direction % 2 == 0 ? distance : -distance) * step;
    const int there = (along_x ? slot : slot % limits.cols) + way;
    return slot + way + (there < 0 ? end : there >= end ? -end : 0);
  }
  /// Slot of the k-th cell of a block, row by row, from that of its first: no block lies across the ends of the ring.
  static int slot_in_block(int first, int k) { return first + k / block_side * limits.cols + k % block_side; }
  /// A place in the window.
  struct Place {
    int i = -1, j = -1;        ///< its cell; -1 outside the window
    float u = 0.0f, v = 0.0f;  ///< in cells from the window's lowest corner

    bool inside() const { return i >= 0; }
  };
  /// That of a point of the map; one that is not finite lies outside.
  Place place_at(float x_m, float y_m) const { return place_within(x_m - origin_x_m(), y_m - origin_y_m()); }
  /// The same, from the window's lowest corner.
  Place place_within(float x_m, float y_m) const {
    const float u = x_m / settings_.cell_x_m, v = y_m / settings_.cell_y_m;
    if (!(u >= 0.0f) || !(v >= 0.0f) || !(u < static_cast<float>(settings_.rows)) ||
        !(v < static_cast<float>(settings_.cols)))
      return {};
    return {static_cast<int>(u), static_cast<int>(v), u, v};
  }
  /// The cell at a place, from the window's lowest corner; -1 outside the window.
  int slot_within(float x_m, float y_m) const {
    const Place place = place_within(x_m, y_m);
    return place.inside() ? slot(place.i, place.j) : -1;
  }

 protected:
  /// Iterates over the slots of a column, along x (axis 0), or of a row, along y (1).
  struct Walk {
    int slot, step, end, count;
    void next() {
      slot += step;
      if (slot == end) slot -= count * step;
    }
  };
  Walk walk_along(int axis, int line) const {
    const bool along_x = axis == 0;
    const int first = along_x ? slot(0, line) : slot(line, 0), step = along_x ? limits.cols : 1;
    const int count = cells_along(axis);
    return {first, step, first + (count - (along_x ? row_shift_ : col_shift_)) * step, count};
  }

  /// The lowest corner, in cells of an infinite grid whose (0, 0) is where the window's corner first was.
  struct Corner {
    std::int32_t row = 0, col = 0;
    bool operator==(const Corner&) const = default;
  };
  const Corner& corner() const { return corner_; }
  /// The corner with the robot there, so that the window's middle keeps its place in the base frame, whatever the
  /// heading: in steps of a block, with a hysteresis of half a cell, so that a noisy pose does not move it to and fro.
  /// A fixed window stays.
  Corner corner_of(const Transform& T_map_base) const {
    if (settings_.fixed) return corner_;
    const float middle_x = settings_.origin_x_m + 0.5f * length_m(0);
    const float middle_y = settings_.origin_y_m + 0.5f * length_m(1);
    const SinCos ahead = heading(T_map_base);
    // How far the middle is from where it would be if the robot headed along the map's x axis.
    const float aside_x = (ahead.cos - 1.0f) * middle_x - ahead.sin * middle_y;
    const float aside_y = ahead.sin * middle_x + (ahead.cos - 1.0f) * middle_y;
    const float x_m = T_map_base.translation.x() + aside_x, y_m = T_map_base.translation.y() + aside_y;
    return {nearest_block(x_m / (settings_.cell_x_m * block_side), corner_.row),
            nearest_block(y_m / (settings_.cell_y_m * block_side), corner_.col)};
  }
  /// The ceiling keeps its height above the robot, unless the window is fixed.
  void lift(float base_z_m) {
    if (!settings_.fixed) ceiling_m_ = settings_.max_height_m + base_z_m;
  }
  /// Does a row, or a column, stay in the window when the corner is there?
  bool row_stays(int i, const Corner& to) const { return stays(i, corner_.row, to.row, settings_.rows); }
  bool col_stays(int j, const Corner& to) const { return stays(j, corner_.col, to.col, settings_.cols); }
  void move(const Corner& to) {
    corner_ = to;
    row_shift_ = wrap(to.row, settings_.rows);
    col_shift_ = wrap(to.col, settings_.cols);
  }

 private:
  /// First cell of the block whose border is nearest; the previous one within the hysteresis.
  static std::int32_t nearest_block(float blocks, std::int32_t before) {
    constexpr float late = 0.5f + 0.5f / block_side;
    const float moved = blocks - static_cast<float>(before) / block_side;
    if (moved > -late && moved < late) return before;
    return floor_to_int(blocks + 0.5f) * block_side;
  }
  static bool stays(int place, std::int32_t first, std::int32_t first_then, int count) {
    const auto place_then =  // wraps to a large number before the window
        static_cast<std::uint32_t>(place) + static_cast<std::uint32_t>(first) - static_cast<std::uint32_t>(first_then);
    return place_then < static_cast<std::uint32_t>(count);
  }
  static int wrap(std::int32_t index, int size) {
    const int r = index % size;
    return r < 0 ? r + size : r;
  }

  WindowSettings settings_{};
  float ceiling_m_ = 0.0f;
  Corner corner_{};
  int row_shift_ = 0, col_shift_ = 0;  ///< of the ring
};

}  // namespace curbline
