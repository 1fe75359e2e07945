// A binary heap of numbered items by gain, which knows the place of each, so that any can be removed. O(1) to query,
// O(log n) to change. The order of equal gains depends on the calls alone.
#pragma once

#include <array>
#include <cstddef>

namespace curbline {

template <typename Index, std::size_t capacity>
class GainHeap {
 public:
  /// Holds items 0 to count - 1 (count at most `capacity`), unordered: set() each, then order().
  void fill(std::size_t count) {
    size_ = count;
    for (std::size_t place = 0; place < count; ++place) put(place, static_cast<Index>(place));
  }
  /// Changes a gain without moving the item; order() must follow.
  void set(Index number, float gain) { gain_[number] = gain; }
  void order() {
    for (std::size_t place = size_ / 2; place > 0; --place) sift_down(place - 1);
  }

  std::size_t size() const { return size_; }
  float gain(Index number) const { return gain_[number]; }
  /// The item at a place, 0 <= place < size(); the first has the largest gain.
  Index at(std::size_t place) const { return heap_[place]; }
  /// Changes the gain of the first item.
  void set_first(float gain) {
    set(heap_[0], gain);
    sift_down(0);
  }
  void remove(Index number) {
    const std::size_t place = place_[number];
    const Index last = heap_[--size_];
    if (place == size_) return;
    put(place, last);
    sift_up(place);
    sift_down(place_[last]);
  }

 private:
  void put(std::size_t place, Index number) {
    heap_[place] = number;
    place_[number] = static_cast<Index>(place);
  }
  void sift_up(std::size_t place);
  // Not inlined: with RegionGraph::gain(), inlining costs half a kilobyte of flash and saves 900 instructions a line.
  [[gnu::noinline]] void sift_down(std::size_t place);

  std::array<float, capacity> gain_;   ///< by number
  std::array<Index, capacity> place_;  ///< of each in the heap
  std::array<Index, capacity> heap_;
  std::size_t size_ = 0;
};

template <typename Index, std::size_t capacity>
void GainHeap<Index, capacity>::sift_up(std::size_t place) {
  const Index number = heap_[place];
  while (place > 0) {
    const std::size_t parent = (place - 1) / 2;
    if (gain_[heap_[parent]] >= gain_[number]) break;
    put(place, heap_[parent]);
    place = parent;
  }
  put(place, number);
}

template <typename Index, std::size_t capacity>
void GainHeap<Index, capacity>::sift_down(std::size_t place) {
  const Index number = heap_[place];
  for (;;) {
    std::size_t child = 2 * place + 1;
    if (child >= size_) break;
    if (child + 1 < size_ && gain_[heap_[child + 1]] > gain_[heap_[child]]) ++child;
    if (gain_[number] >= gain_[heap_[child]]) break;
    put(place, heap_[child]);
    place = child;
  }
  put(place, number);
}

}  // namespace curbline
