// Numbers from the bytes of a fuzzer: likely ones, and ones that nobody expects.
#pragma once

#include <fuzzer/FuzzedDataProvider.h>

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>

namespace curbline::fuzz {

class Numbers {
 public:
  Numbers(const std::uint8_t* bytes, std::size_t size) : data_(bytes, size) {}

  bool used_up() { return data_.remaining_bytes() == 0; }
  bool flag() { return data_.ConsumeBool(); }
  bool seldom() { return data_.ConsumeIntegralInRange(0, 15) == 15; }
  int whole(int low, int high) { return data_.ConsumeIntegralInRange(low, high); }
  float number(float low, float high) { return data_.ConsumeFloatingPointInRange(low, high); }
  /// Any float, including NaN and infinities.
  float any() {
    using Floats = std::numeric_limits<float>;
    constexpr std::array<float, 8> odd{Floats::quiet_NaN(),
                                       Floats::infinity(),
                                       -Floats::infinity(),
                                       Floats::max(),
                                       -Floats::max(),
                                       Floats::denorm_min(),
                                       -0.0f,
                                       1e-20f};
    if (flag()) return data_.PickValueInArray(odd);
    return std::bit_cast<float>(data_.ConsumeIntegral<std::uint32_t>());
  }
  float rarely_any(float usual) { return seldom() ? any() : usual; }
  std::uint32_t bits32() { return data_.ConsumeIntegral<std::uint32_t>(); }
  std::uint8_t byte() { return data_.ConsumeIntegral<std::uint8_t>(); }
  std::string text() { return data_.ConsumeRandomLengthString(); }
  /// Any time within 146 years of 0, mostly near it.
  std::int64_t time_ns() { return data_.ConsumeIntegral<std::int64_t>() >> whole(1, 40); }

  /// Leaves the value, replaces it by one in its range, or by any.
  void change(float& value, float low, float high) {
    const int how = whole(0, 7);
    if (how == 7) value = any();
    if (how == 6) value = number(low, high);
  }
  void change(int& value, int low, int high) {
    const int how = whole(0, 7);
    if (how == 7) value = data_.ConsumeIntegral<int>();
    if (how == 6) value = whole(low, high);
  }

 private:
  FuzzedDataProvider data_;
};

}  // namespace curbline::fuzz
