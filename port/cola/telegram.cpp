#include "cola/telegram.hpp"

#include <algorithm>
#include <cstring>

namespace curbline::cola {
namespace {

constexpr std::uint8_t start = 0x02;

std::size_t length_of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::size_t>(bytes[4]) << 24 | static_cast<std::size_t>(bytes[5]) << 16 |
         static_cast<std::size_t>(bytes[6]) << 8 | bytes[7];
}

std::uint8_t xor_of(std::span<const std::uint8_t> content) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : content) sum ^= byte;
  return sum;
}

}  // namespace

std::size_t Format::size_of(std::span<const std::uint8_t> bytes) {
  const bool starts = std::all_of(bytes.begin(), bytes.begin() + 4, [](std::uint8_t byte) { return byte == start; });
  return starts ? header + length_of(bytes) + 1 : 0;
}

bool Format::plausible(std::span<const std::uint8_t> bytes) {
  return length_of(bytes) >= 4 && length_of(bytes) <= most_bytes - header - 1;
}

bool Format::check(std::span<const std::uint8_t> telegram) {
  return xor_of(content_of(telegram)) == telegram.back();
}

bool begins(std::span<const std::uint8_t> content, std::string_view letters) {
  return content.size() >= letters.size() && std::memcmp(content.data(), letters.data(), letters.size()) == 0;
}

void frame(std::span<std::uint8_t> telegram, std::size_t size) {
  std::fill_n(telegram.begin(), 4, start);
  for (std::size_t i = 0; i < 4; ++i) telegram[4 + i] = static_cast<std::uint8_t>(size >> (24 - 8 * i));
  telegram[Format::header + size] = xor_of(telegram.subspan(Format::header, size));
}

}  // namespace curbline::cola
