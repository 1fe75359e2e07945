// Converts lines of a candump log (can-utils, `candump -L`, `candump -l`) to CAN frames and back. This is a port: a log
// can take the place of a bus. No I/O, heap, exceptions or state, so that a board can replay a log that it is fed;
// reentrant. Cost: one pass over the line.
//
//   (1290682980.025000) can0 181#3706D317FDFF        classic, 11-bit id
//   (1290682980.025000) can0 00001005#0011223344556677   29-bit id: 8 digits
//   (1290682980.025000) can0 123#R4                  remote request for 4 bytes
//   (1290682980.025000) can0 123##3112233            CAN FD, flags 3
//   (1290682980.025000) can0 20000004#0000000000000000   error message of the controller: bit 29 of the id
//   (1290682980.025000) can0 123#0011223344556677_F  classic, 8 bytes, with length code 15 on the bus
// Newer versions append the direction, " R" or " T". In a log of several interfaces, names are right-aligned to the
// width of the longest: "(1.5)  can0 181#00" beside "(1.5) vcan0 181#00". Source: can-utils, lib.h and candump.c.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "curbline/can/frame.hpp"

namespace curbline::candump {

/// The contents of a line. Either `error` is empty and the other members are valid, or it says what is wrong and what
/// was expected.
struct ParsedLine {
  can::Frame frame{};                 ///< with the line's time
  std::string_view interface_name{};  ///< points into the line
  std::string_view error{};           ///< static storage

  bool ok() const { return error.empty(); }
};

/// Parses one line without its line end. Anything that candump does not write is an error, except a time with fewer
/// decimals (at least one) and trailing blanks.
ParsedLine parse_line(std::string_view line);

/// Converts decimal seconds, "1290682980.025", exactly to nanoseconds; digits past the ninth are truncated. Nothing if
/// the text is not a time or exceeds 63 bits (the year 2262).
std::optional<std::int64_t> parse_time(std::string_view seconds);

/// Longest line that format_line() writes: a time of 21 characters, an interface name of 15, an id of 8, 64 bytes.
constexpr std::size_t max_line = 192;

/// Writes the line without a line end, with microseconds as candump does (the rest is truncated). Returns its length,
/// or 0 if no bus can carry the frame, the interface name does not have 1 to 15 characters, or `line` is shorter than
/// max_line.
std::size_t format_line(const can::Frame& frame, std::string_view interface_name, std::span<char> line);

}  // namespace curbline::candump
