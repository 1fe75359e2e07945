// A small set of plane numbers, walked in ascending order at a cost of its members.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace curbline {

template <int planes>
class PlaneSet {
 public:
  void insert(int plane) { words_[static_cast<std::size_t>(plane) / 32] |= 1u << (plane % 32); }
  void insert(const PlaneSet& other) {
    for (std::size_t w = 0; w < words_.size(); ++w) words_[w] |= other.words_[w];
  }

  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint32_t rest = words_[w]; rest != 0; rest &= rest - 1)
        visit(static_cast<int>(32 * w) + std::countr_zero(rest));
    }
  }

 private:
  std::array<std::uint32_t, (planes + 31) / 32> words_{};
};

}  // namespace curbline
