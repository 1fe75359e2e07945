// A border point between two planes on a row or column of the window, and a part of a chain of them (borders.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "curbline/borders/beside.hpp"
#include "curbline/grid.hpp"
#include "curbline/plane.hpp"

namespace curbline {

struct Border {
  using Index = std::uint16_t;

  float x_m, y_m;                   ///< in the window's frame
  float probability;                ///< that the cells on both sides belong to different planes
  float half_gap_m;                 ///< half the distance between the cells of both planes
  float drop_m;                     ///< of a brink: down to the lowest visible behind it; else 0
  float sloped_cells;               ///< length of the slope from plane to plane that the cells in between show
  Beside beside_one, beside_other;  ///< on the sides of `one` and `other`
  Label one, other;  ///< the planes, one < other by number; other is no_label at the end of a face and at a brink
  std::int8_t axis;  ///< 0: found along x, 1: along y
  std::int8_t sign;  ///< +1 if `other` is in the positive direction of the axis
  bool open : 1;     ///< the edge may be anywhere in the gap: an obstacle stands there, or hides it
  bool parted : 1;   ///< a step up between two cells side by side, each of one height: it lies between two scan lines
  bool chained : 1;
  std::uint8_t empty;  ///< cells of the gap without a point, 255 at most
  Index next_in_cell;  ///< another border in the same cell

  /// In the fit of a line: residuals are in half gaps.
  float weight() const { return 1.0f / (half_gap_m * half_gap_m); }
  /// The direction (grid.hpp) toward the side of one of its planes.
  std::size_t toward(Label label) const {
    return static_cast<std::size_t>(direction(axis, label == other ? sign : -sign));
  }
};

/// Consecutive borders of a chain. Open ones err alike, as the obstacle before them hides the edge from all: together
/// they count as one observation, each of k as 1 / k. If all are open, each counts as one.
class ChainPart {
 public:
  /// Residuals of borders from their line, in half gaps, are normal with an unknown variance, inverse gamma a priori:
  /// a0, and b0 as for residuals anywhere from -1 to 1. place_prior is 2 b0, to which the sum of squares is added.
  static constexpr float place_a0 = 2.0f, place_prior = 2.0f * place_a0 / 3.0f;

  struct Iterator {
    const Border* all;
    const Border::Index* at;
    const Border& operator*() const { return all[*at]; }
    Iterator& operator++() { return ++at, *this; }
    bool operator!=(const Iterator& other) const { return at != other.at; }
  };

  /// Whether its first and last border are those of its chain.
  struct Ends {
    bool first, second;
  } ends;

  ChainPart(const Border* all, std::span<const Border::Index> part, Ends of_chain);

  int size() const { return static_cast<int>(part_.size()); }
  const Border& operator[](int k) const { return all_[part_[static_cast<std::size_t>(k)]]; }
  const Border& front() const { return all_[part_.front()]; }
  const Border& back() const { return all_[part_.back()]; }
  Iterator begin() const { return {all_, part_.data()}; }
  Iterator end() const { return {all_, part_.data() + part_.size()}; }

  /// Number of observations that a border counts for, and all of them.
  float share(const Border& border) const { return border.open ? open_share_ : 1.0f; }
  float observations() const { return observations_; }

 private:
  const Border* all_;
  std::span<const Border::Index> part_;
  float open_share_ = 1.0f, observations_ = 0.0f;
};

}  // namespace curbline
