// Border points between two planes on the rows and columns of the window (BorderFinder), chained into polylines.
// Working memory of one CurbTracer::trace().
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "curbline/borders/border.hpp"
#include "curbline/grid.hpp"
#include "curbline/map/cell_line.hpp"
#include "curbline/map/dem.hpp"
#include "curbline/math.hpp"
#include "curbline/per_cell.hpp"

namespace curbline {

template <Limits limits>
class Borders {
 public:
  using Index = Border::Index;

  /// A border on a row or column, with only its place set.
  static Border on(const CellLine<limits>& line, float along_m) {
    Border border{};
    border.x_m = line.x_m(along_m);
    border.y_m = line.y_m(along_m);
    border.axis = static_cast<std::int8_t>(line.axis);
    return border;
  }

  void clear() {
    size_ = 0;
    in_cell_.fill(none);
  }
  int size() const { return size_; }
  bool chained(int border) const { return border_[static_cast<std::size_t>(border)].chained; }

  /// False if the store is full.
  [[gnu::noinline]] bool add(const Dem<limits>& dem, const Border& border);  // as CellLine::slot()

  /// Chains the polyline from one of its ends, found from a border: each is followed by the nearest border of the same
  /// planes, within two cells, else within `reach`. Returns its length; the borders are at(0), at(1) and so on. Where
  /// borders lie side by side it may pass over some, at times even the one it was found from, which then is in no
  /// chain. About 50 look-ups a border; (2 reach + 1)^2 where no other is within two cells.
  int chain(const Dem<limits>& dem, int border, int reach);
  const Border& at(int place) const { return border_[chain_[static_cast<std::size_t>(place)]]; }
  /// Is the edge another one between at(place) and at(place + 1), more than two cells apart? It is if one of their
  /// planes borders on others there, with steps for which is_other(border); if both do, a strip of a third plane lies
  /// along the edge: cells that it crosses. Brinks, of which no other ground is seen, do not count. Returns the cells
  /// between them, 0 if it is the same edge.
  template <typename IsOther>
  int other_edge_after(const Dem<limits>& dem, int place, IsOther&& is_other) const;
  /// From here on only at(first) to at(last) are the chain.
  void narrow(int first, int last) {
    first_ = first;
    last_ = last;
  }
  /// The borders at(first) to at(last).
  ChainPart part(int first, int last) const {
    const auto size = static_cast<std::size_t>(last - first) + 1;
    return ChainPart(border_.data(), std::span<const Index>(chain_).subspan(static_cast<std::size_t>(first), size),
                     {first == first_, last == last_});
  }

 private:
  static constexpr Index none = 0xFFFF;

  int walk(const Dem<limits>& dem, Index start, int reach);
  Index nearest(const Dem<limits>& dem, const Border& from, int reach) const;
  /// Cells are numbered row by row, not by slot: nothing is kept until the window moves.
  static int number(int i, int j) { return i * limits.cols + j; }
  /// A border beyond the window's ends belongs to the first or last cell.
  static int cell_of(const Dem<limits>& dem, const Border& border) {
    const auto within = [](float cells, int count) { return std::clamp(static_cast<int>(cells), 0, count - 1); };
    return number(within(border.x_m / dem.cell_x_m(), dem.rows()), within(border.y_m / dem.cell_y_m(), dem.cols()));
  }

  std::array<Border, limits.borders> border_;
  PerCell<Index, limits> in_cell_;
  std::array<Index, limits.borders> chain_;  ///< the current polyline, in order
  int first_, last_;                         ///< its places
  int size_;
};

template <Limits limits>
bool Borders<limits>::add(const Dem<limits>& dem, const Border& border) {
  if (size_ == limits.borders) return false;
  Index& head = in_cell_[cell_of(dem, border)];
  Border& added = border_[static_cast<std::size_t>(size_)];
  added = border;
  added.next_in_cell = head;
  head = static_cast<Index>(size_++);
  return true;
}

template <Limits limits>
int Borders<limits>::chain(const Dem<limits>& dem, int border, int reach) {
  // Walk to an end of the polyline, then chain it from there.
  const int walked = walk(dem, static_cast<Index>(border), reach);
  for (int k = 0; k < walked; ++k) border_[chain_[static_cast<std::size_t>(k)]].chained = false;
  const int length = walk(dem, chain_[static_cast<std::size_t>(walked - 1)], reach);
  narrow(0, length - 1);
  return length;
}

template <Limits limits>
int Borders<limits>::walk(const Dem<limits>& dem, Index start, int reach) {
  int length = 0;
  for (Index b = start; b != none;) {
    border_[b].chained = true;
    chain_[static_cast<std::size_t>(length++)] = b;
    const Index near = nearest(dem, border_[b], 2);
    b = near != none ? near : nearest(dem, border_[b], reach);
  }
  return length;
}

/// The nearest border of the same planes that is in no chain yet.
template <Limits limits>
auto Borders<limits>::nearest(const Dem<limits>& dem, const Border& from, int reach) const -> Index {
  const int ci = static_cast<int>(from.x_m / dem.cell_x_m()), cj = static_cast<int>(from.y_m / dem.cell_y_m());
  const int first_i = std::max(ci - reach, 0), last_i = std::min(ci + reach, dem.rows() - 1);
  const int first_j = std::max(cj - reach, 0), last_j = std::min(cj + reach, dem.cols() - 1);
  Index best = none;
  float best_m2 = 1e30f;
  for (int i = first_i; i <= last_i; ++i) {
    for (int j = first_j; j <= last_j; ++j) {
      for (Index b = in_cell_[number(i, j)]; b != none; b = border_[b].next_in_cell) {
        const Border& border = border_[b];
        if (border.chained || border.one != from.one || border.other != from.other) continue;
        const float dx = border.x_m - from.x_m, dy = border.y_m - from.y_m;
        const float m2 = dx * dx + dy * dy;
        if (m2 < best_m2) {
          best_m2 = m2;
          best = b;
        }
      }
    }
  }
  return best;
}

template <Limits limits>
template <typename IsOther>
int Borders<limits>::other_edge_after(const Dem<limits>& dem, int place, IsOther&& is_other) const {
  const Border &from = at(place), &to = at(place + 1);
  const float u = from.x_m / dem.cell_x_m(), du = to.x_m / dem.cell_x_m() - u;
  const float v = from.y_m / dem.cell_y_m(), dv = to.y_m / dem.cell_y_m() - v;
  const bool along_x = du * du > dv * dv;
  const int steps = static_cast<int>(magnitude(along_x ? du : dv) + 0.5f);
  if (steps <= 2 || from.other == no_label) return 0;
  bool of_one = false, of_other = false;
  for (int k = 1; k < steps; ++k) {
    const float share = static_cast<float>(k) / static_cast<float>(steps);
    const int i = static_cast<int>(u + share * du), j = static_cast<int>(v + share * dv);
    for (int aside = -1; aside <= 1; ++aside) {
      const int a = along_x ? i : i + aside, c = along_x ? j + aside : j;
      if (!dem.contains(a, c)) continue;
      for (Index b = in_cell_[number(a, c)]; b != none; b = border_[b].next_in_cell) {
        const Border& there = border_[b];
        // Not of an edge that leads across, nor a brink: it shows no other ground.
        if ((there.axis == 1) != along_x || there.other == no_label) continue;
        const bool has_one = there.one == from.one || there.other == from.one;
        const bool has_other = there.one == from.other || there.other == from.other;
        if (has_one == has_other || !is_other(there)) continue;
        (has_one ? of_one : of_other) = true;
      }
    }
  }
  return of_one != of_other ? steps - 1 : 0;
}

}  // namespace curbline
