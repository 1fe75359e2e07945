// Encoding of numbers as characters in SCIP 2.0, and its checksums: six bits a character, from '0' (0x30) to 'o'
// (0x6F), most significant first. Source: Hokuyo, Communication Protocol Specification for SCIP2.0, C-42-03320B,
// chapters 6 (encoding) and 7 (sum). Pure, reentrant.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "text/part.hpp"

namespace curbline::scip2 {

/// Checksum of a string: the low six bits of its sum, as a character.
constexpr char sum_of(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return static_cast<char>((sum & 0x3F) + 0x30);
}

/// True if the last character is the checksum of those before it.
constexpr bool sum_is_right(std::string_view line) {
  return line.size() >= 2 && line.back() == sum_of(port::part(line, 0, line.size() - 1));
}

/// A number of 2, 3 or 4 characters. Characters outside the code also give a number: check the checksum first.
constexpr std::uint32_t decode(std::string_view characters) {
  std::uint32_t value = 0;
  for (const char c : characters)
    value = value << 6 | ((static_cast<std::uint32_t>(static_cast<unsigned char>(c)) - 0x30) & 0x3F);
  return value;
}

/// Writes `value` into all of `characters`; bits beyond them are lost.
constexpr void encode(std::uint32_t value, std::span<char> characters) {
  for (std::size_t i = characters.size(); i-- > 0; value >>= 6)
    characters[i] = static_cast<char>((value & 0x3F) + 0x30);
}

}  // namespace curbline::scip2
