// Telegrams of SICK's LMS2xx on a serial line: 0x02, address (0 to the scanner; from the scanner, 0x80 plus its own),
// length u16, that many bytes (command, data and, from the scanner, its status), then a CRC u16 over all of them.
// Numbers are little-endian. Before its reply the scanner acknowledges a telegram with 0x06, or refuses it with 0x15.
// Pure, reentrant. Source: SICK, Telegrams for Configuring and Operating the LMS 2xx, 8007954, chapters 3 and 4.
#pragma once

#include <cstdint>
#include <span>

#include "scanner/telegram_buffer.hpp"

namespace curbline::lms200 {

/// The longest telegram, by chapter 3.
inline constexpr std::size_t most_bytes = 812;

/// Bytes around the content.
inline constexpr std::size_t header_bytes = 4, crc_bytes = 2, frame_bytes = header_bytes + crc_bytes;

inline constexpr std::uint8_t stx = 0x02, acknowledged = 0x06, not_acknowledged = 0x15, from_scanner = 0x80;

/// CRC of a telegram without its last two bytes. SICK's own variant: for each byte, the register is shifted by one bit
/// (polynomial 0x8005) and combined with this byte and the previous one.
constexpr std::uint16_t crc_of(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0;
  std::uint8_t before = 0;
  for (const std::uint8_t byte : bytes) {
    crc = (crc & 0x8000) != 0 ? (crc & 0x7FFF) << 1 ^ 0x8005 : crc << 1;
    crc ^= static_cast<unsigned>(byte) | static_cast<unsigned>(before) << 8;
    before = byte;
  }
  return static_cast<std::uint16_t>(crc);
}

/// Telegrams in the direction that `address` gives: 0 to the scanner, 0x80 from it.
template <std::uint8_t address>
struct Format {
  static constexpr std::size_t header = header_bytes;
  static constexpr std::size_t length_of(std::span<const std::uint8_t> bytes) {
    return static_cast<std::size_t>(bytes[2] | bytes[3] << 8);
  }
  static std::size_t size_of(std::span<const std::uint8_t> bytes) {
    return bytes[0] == stx && (bytes[1] & from_scanner) == address ? length_of(bytes) + frame_bytes : 0;
  }
  static bool plausible(std::span<const std::uint8_t> bytes) {
    return length_of(bytes) >= 1 && length_of(bytes) <= most_bytes - frame_bytes;
  }
  static bool check(std::span<const std::uint8_t> telegram) {
    const std::size_t size = telegram.size() - crc_bytes;
    return crc_of(telegram.first(size)) == static_cast<std::uint16_t>(telegram[size] | telegram[size + 1] << 8);
  }
  static bool filler(std::uint8_t byte) { return byte == acknowledged || byte == not_acknowledged; }
};

/// What the host reads, and what the scanner reads.
using HostBuffer = scanner::TelegramBuffer<Format<from_scanner>, most_bytes>;
using ScannerBuffer = scanner::TelegramBuffer<Format<0>, most_bytes>;

/// Command, data and status of a telegram that passed check().
inline std::span<const std::uint8_t> content_of(std::span<const std::uint8_t> telegram) {
  return telegram.subspan(header_bytes, telegram.size() - frame_bytes);
}

/// Frames `content` into `telegram`, which has room for frame_bytes more. Returns its size.
std::size_t frame(std::uint8_t address, std::span<const std::uint8_t> content, std::span<std::uint8_t> telegram);

}  // namespace curbline::lms200
