// Decodes the replies of a SCIP 2.0 scanner from its bytes. A reply consists of the echo of the command, a status of
// two characters with its checksum, lines of at most 64 characters with a checksum, and an empty line. Replies to MD
// and MS with status 99 are scan lines: a time stamp of four characters (24 bits of milliseconds), then ranges in
// millimetres of three (MD) or two (MS) characters, which may be split across lines.
//
//   MD0000108000000   echo: steps 0 to 1080, no clusters, every scan, without end
//   99b               status, sum
//   5^@1:             stamp, sum
//   ...               64 characters, sum
//                     empty: the end
//
// 10 KiB, of which the ranges take 6; a Session takes 16. O(1) a byte. Source: Hokuyo C-42-03320B, chapters 7 to 9.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "scanner/session.hpp"

namespace curbline::scip2 {

inline constexpr int most_steps = 1441;  ///< a full turn of a UTM-30LX

struct Scan {
  std::uint32_t stamp_ms = 0;  ///< 24 bits
  int first_step = 0, last_step = 0;
  std::span<const std::uint32_t> ranges_mm;  ///< below the scanner's DMIN: an error code
};

/// Any other reply. Its checksums are valid.
struct Reply {
  std::string_view echo;
  std::string_view status;  ///< two characters
  std::string_view body;    ///< its lines without their checksums, each ended by '\n'
};

class Decoder {
 public:
  enum class Event : unsigned char { none, scan, reply };

  explicit Decoder(scanner::Counters& counters) : counters_(counters) {}

  void restart();

  /// Reads to the end of the next reply and removes the bytes used from the front; none: all were used.
  Event take(std::span<const std::uint8_t>& bytes);

  const Scan& scan() const { return scan_; }     ///< valid until the next take()
  const Reply& reply() const { return reply_; }  ///< valid until the next take()

 private:
  enum class State : unsigned char { echo, status, stamp, ranges, body, skip };

  Event take_line(std::string_view line);
  Event end_reply();
  Event end_scan();
  void take_echo(std::string_view line);
  void take_status(std::string_view line);
  void take_ranges(std::string_view characters);
  void take_body(std::string_view line);
  void drop(std::uint64_t& counter, std::string_view line);
  bool begin_scan_echo(std::string_view line);
  std::string_view echo() const { return {echo_.data(), echo_size_}; }

  scanner::Counters& counters_;
  State state_ = State::echo;
  bool too_long_ = false;
  std::array<char, 80> line_{};
  std::size_t line_size_ = 0;
  std::array<char, 64> echo_{};
  std::size_t echo_size_ = 0;
  std::array<char, 2> status_{};
  std::array<char, 3 * most_steps> text_{};  ///< the ranges, or the body of a reply
  std::size_t text_size_ = 0;
  std::array<std::uint32_t, most_steps> ranges_mm_{};
  Scan scan_{};
  Reply reply_{};
};

}  // namespace curbline::scip2
