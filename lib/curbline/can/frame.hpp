// A CAN or CAN FD frame, as bytes. Plain data, copied freely; ports fill it, signal.hpp reads it.
#pragma once

#include <array>
#include <cstdint>

namespace curbline::can {

struct Frame {
  std::int64_t time_ns = 0;
  std::uint32_t id = 0;  ///< 11 bits, or 29 if extended; of an error message, its class
  bool extended = false;
  bool remote = false;        ///< a request, without data
  bool error = false;         ///< an error message of the controller, not of the bus
  bool fd = false;            ///< CAN FD
  std::uint8_t fd_flags = 0;  ///< bit 0: bit rate switch, bit 1: error state indicator
  std::uint8_t length = 0;    ///< bytes of data in use (asked for, if remote): 0 to 8, to 64 if fd
  std::array<std::uint8_t, 64> data{};
};

/// The highest id of a frame: 11 bits, or 29 if extended.
constexpr std::uint32_t highest_id(bool extended) {
  return extended ? 0x1FFFFFFFu : 0x7FFu;
}

/// The length of the shortest CAN FD frame that holds so many bytes, 0 to 64 (ISO 11898-1, data length code).
constexpr std::uint8_t fd_length(std::uint8_t bytes) {
  constexpr std::array<std::uint8_t, 7> long_lengths{12, 16, 20, 24, 32, 48, 64};
  if (bytes <= 8) return bytes;
  for (const std::uint8_t length : long_lengths) {
    if (bytes <= length) return length;
  }
  return 64;
}

/// Are id and length those of a frame? A remote request is a classic frame.
constexpr bool valid(const Frame& frame) {
  if (frame.id > highest_id(frame.extended || frame.error)) return false;
  return frame.fd ? !frame.remote && fd_length(frame.length) == frame.length : frame.length <= 8;
}

}  // namespace curbline::can
