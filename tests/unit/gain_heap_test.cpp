// The heap's first entry against a search through all entries, whatever was changed and removed before.
#include "curbline/regions/gain_heap.hpp"

#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdint>
#include <map>

#include "support/terrain.hpp"

namespace curbline {
namespace {

using Heap = GainHeap<std::uint16_t, 64>;

TEST_CASE("gain heap: the first one gains most, whatever was changed and taken out before") {
  test::Noise noise(3);
  for (const std::size_t count : {1u, 2u, 7u, 63u}) {
    Heap heap;
    std::map<std::uint16_t, float> left;
    const auto gain = [&] { return static_cast<float>(static_cast<int>(8.0 * noise.normal())); };  // equal ones, too
    const auto best = [&] {
      float most = left.begin()->second;
      for (const auto& [number, of_number] : left) most = of_number > most ? of_number : most;
      return most;
    };
    heap.fill(count);
    for (std::uint16_t n = 0; n < count; ++n) heap.set(n, left[n] = gain());
    heap.order();
    while (!left.empty()) {
      REQUIRE(heap.size() == left.size());
      REQUIRE(left.contains(heap.at(0)));
      REQUIRE(heap.gain(heap.at(0)) == best());
      const std::uint16_t first = heap.at(0);
      const float other = gain();
      heap.set_first(left[first] = other);
      REQUIRE(heap.gain(heap.at(0)) == best());
      const auto place = static_cast<std::size_t>(noise.uniform() * static_cast<double>(left.size()));
      const std::uint16_t number = heap.at(place);
      heap.remove(number);
      left.erase(number);
    }
    CHECK(heap.size() == 0);
  }
}

}  // namespace
}  // namespace curbline
