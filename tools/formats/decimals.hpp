// Converts numbers to text, without locale or stream state. For the writers.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

namespace curbline::tools {

/// Appends a value, "-0.250" for 3 places; at most 16 places.
inline void append_decimals(std::string& text, double value, int places) {
  std::array<char, 336> buffer{};  // the largest double has 309 digits
  const auto result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, places);
  text.append(buffer.data(), result.ptr);
}

inline std::string decimals(double value, int places) {
  std::string text;
  append_decimals(text, value, places);
  return text;
}

/// The shortest text that reads back as the same number, "1e+300".
template <typename Number>
std::string shortest(Number value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// For messages: decimals, or the shortest form for very large values.
inline std::string readable(double value, int places) {
  return std::abs(value) < 1e12 ? decimals(value, places) : shortest(value);
}

/// "0x181".
inline std::string hexadecimal(std::uint32_t value) {
  std::array<char, 8> text{};
  return "0x" + std::string(text.data(), std::to_chars(text.data(), text.data() + text.size(), value, 16).ptr);
}

/// Nanoseconds >= 0 as seconds with 6 or 9 decimals; with 6 the rest is truncated, so that times stay in order.
inline std::string seconds(std::int64_t time_ns, int places) {
  std::string fraction = std::to_string(1'000'000'000 + time_ns % 1'000'000'000).substr(1);
  fraction.resize(static_cast<std::size_t>(places));
  return std::to_string(time_ns / 1'000'000'000) + "." + fraction;
}

}  // namespace curbline::tools
