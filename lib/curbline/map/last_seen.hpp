// Of each cell: was it seen since the stages last ran, in this sweep, since the last mark; and from which place on the
// laser's way. One byte a cell. O(1); a pass over the window where a sweep, a mark or the stages' turn begins.
#pragma once

#include <cstdint>

#include "curbline/limits.hpp"
#include "curbline/map/laser_way.hpp"
#include "curbline/map/window.hpp"
#include "curbline/per_cell.hpp"

namespace curbline {

template <Limits limits>
class LastSeen {
 public:
  void init(float window_side_m) {
    way_.init(window_side_m);
    seen_.fill(0);
    now_ = all_bits;
    any_touched_ = false;
  }

  /// Where the laser is from now on, in the map frame.
  void look_from(float x_m, float y_m) {
    way_.look_from({x_m, y_m});
    now_ = static_cast<std::uint8_t>(way_.newest() * a_place + all_bits);
  }
  /// A cell is seen, or cleared.
  void touch(int slot) {
    seen_[slot] = now_;
    any_touched_ = true;
  }

  /// Since clear_touched().
  bool touched(int slot) const { return (seen_[slot] & touched_bit) != 0; }
  /// Any cell of a block, given by the slot of its first.
  bool block_touched(int first) const {
    int seen = 0;
    for (int i = 0; i < block_side; ++i) {
      for (int j = 0; j < block_side; ++j) seen |= seen_[Window<limits>::slot_in_block(first, block_side * i + j)];
    }
    return (seen & touched_bit) != 0;
  }
  void clear_touched() {
    if (any_touched_) clear_all(touched_bit);
    any_touched_ = false;
  }
  bool any_touched() const { return any_touched_; }

  void begin_sweep() { clear_all(sweep_bit); }
  bool in_this_sweep(int slot) const { return (seen_[slot] & sweep_bit) != 0; }
  /// Cells seen from now on are marked.
  void begin_marking() { clear_all(marked_bit); }
  bool marked(int slot) const { return (seen_[slot] & marked_bit) != 0; }

  /// The laser's place then, in the map frame.
  const LaserWay::Position& from(int slot) const { return way_.at(seen_[slot] / a_place); }
  /// Has the laser moved? If not, all cells were seen from one place.
  bool from_several() const { return way_.moved(); }

 private:
  static constexpr std::uint8_t touched_bit = 1, marked_bit = 2, sweep_bit = 4, a_place = 8;
  static constexpr std::uint8_t all_bits = touched_bit | marked_bit | sweep_bit;
  static_assert(LaserWay::numbers * a_place == 256, "one byte holds the bits and a number");

  void clear_all(std::uint8_t bit) {
    for (std::uint8_t& seen : seen_) seen &= static_cast<std::uint8_t>(~bit);
  }

  LaserWay way_{};
  PerCell<std::uint8_t, limits> seen_{};  ///< three bits, and above them the number of the place on the laser's way
  std::uint8_t now_ = all_bits;           ///< of a cell seen now
  bool any_touched_ = false;
};

}  // namespace curbline
