// What a stage stores for the window's cells, by their slots (window.hpp).
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include "curbline/grid.hpp"
#include "curbline/index_set.hpp"
#include "curbline/limits.hpp"

namespace curbline {

/// One T for each cell. Not set until filled, unless made with {}.
template <typename T, Limits limits>
class PerCell {
 public:
  void fill(const T& value) { all_.fill(value); }

  T& operator[](std::integral auto slot) { return all_[static_cast<std::size_t>(slot)]; }
  const T& operator[](std::integral auto slot) const { return all_[static_cast<std::size_t>(slot)]; }

  auto begin() { return all_.begin(); }
  auto end() { return all_.end(); }

 private:
  std::array<T, static_cast<std::size_t>(limits.rows* limits.cols)> all_;
};

/// A label for each cell; no_label for none.
template <Limits limits>
using CellLabels = PerCell<Label, limits>;

/// A set of cells.
template <Limits limits>
using CellSet = IndexSet<limits.rows * limits.cols>;

}  // namespace curbline
