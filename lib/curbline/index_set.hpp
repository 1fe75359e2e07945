// A set of integers below a size, one bit each; iterates in ascending order, at a cost of its members.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>

namespace curbline {

template <int size>
class IndexSet {
 public:
  void clear() { words_.fill(0); }
  void insert(std::integral auto index) { words_[static_cast<std::size_t>(index) / 32] |= 1u << (index % 32); }
  void insert(const IndexSet& other) {
    for (std::size_t w = 0; w < words_.size(); ++w) words_[w] |= other.words_[w];
  }
  bool empty() const {
    for (const std::uint32_t word : words_) {
      if (word != 0) return false;
    }
    return true;
  }
  bool contains(std::integral auto index) const {
    return (words_[static_cast<std::size_t>(index) / 32] >> (index % 32) & 1u) != 0;
  }

  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint32_t rest = words_[w]; rest != 0; rest &= rest - 1)
        visit(static_cast<int>(32 * w) + std::countr_zero(rest));
    }
  }

 private:
  std::array<std::uint32_t, (size + 31) / 32> words_{};
};

}  // namespace curbline
