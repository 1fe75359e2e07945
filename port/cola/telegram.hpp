// Telegrams of SICK's CoLa B: four bytes 0x02, a length of four bytes (big-endian, as all numbers here), the content,
// and the XOR of the content. The content begins with a command of three letters, a blank and a name: "sEN
// LMDscandata". Pure, reentrant. Source: SICK, Telegram Listing for LMS1xx, 8014631, chapter on framing. Checked with
// the telegrams printed there and in 8023198.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "scanner/telegram_buffer.hpp"

namespace curbline::cola {

/// The largest telegram that a scanner sends: five channels of 1141 16-bit values, and the surrounding fields.
inline constexpr std::size_t most_bytes = 12 * 1024;

struct Format {
  static constexpr std::size_t header = 8;
  static std::size_t size_of(std::span<const std::uint8_t> bytes);
  static bool plausible(std::span<const std::uint8_t> bytes);
  static bool check(std::span<const std::uint8_t> telegram);
  static bool filler(std::uint8_t) { return false; }
};

using TelegramBuffer = scanner::TelegramBuffer<Format, most_bytes>;

/// Content of a telegram that passed check().
inline std::span<const std::uint8_t> content_of(std::span<const std::uint8_t> telegram) {
  return telegram.subspan(Format::header, telegram.size() - Format::header - 1);
}

/// True if the content begins with these letters.
bool begins(std::span<const std::uint8_t> content, std::string_view letters);

/// Frames the `size` bytes of content that start at `telegram[Format::header]`. There must be room for header, content
/// and checksum.
void frame(std::span<std::uint8_t> telegram, std::size_t size);

}  // namespace curbline::cola
