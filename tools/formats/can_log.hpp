// CAN frames in a candump log (candump/candump.hpp describes its lines), in the log's order, whatever their times.
#pragma once

#include <optional>
#include <ostream>
#include <string>

#include "curbline/can/frame.hpp"
#include "curbline/can/signal.hpp"
#include "formats/line_reader.hpp"

namespace curbline::tools {

class CanLogReader {
 public:
  explicit CanLogReader(const std::string& path) : source_(path) {}

  /// The next frame, whatever its id; nothing at the end. Blank lines and # comments are skipped; candump -d's reports
  /// of lost frames are counted. Throws BadInput for any other line that candump does not write, for a time that the
  /// pipeline would not take, and for a file without a frame.
  std::optional<can::Frame> next();

  const std::string& path() const { return source_.path(); }
  long line() const { return source_.line(); }                           ///< of the last frame returned
  const std::string& interface_name() const { return interface_name_; }  ///< the same
  std::uint64_t frames_lost() const { return frames_lost_; }             ///< lost by candump, so far

 private:
  LineReader source_;
  std::string interface_name_;
  std::uint64_t frames_lost_ = 0;
};

/// Two servos with one id, on separate buses, would look like one servo that jumps.
class OneInterface {
 public:
  /// Throws BadInput if the frame that the log returned last carries the signal and is of another interface than those
  /// before.
  void check(const CanLogReader& log, const can::Signal& signal, const can::Frame& frame);

 private:
  std::string name_;
};

/// The frame that contains a signal, for the user: "id 0x181 of 11 bits", "id 0x181 of 11 bits with multiplexor 9".
std::string frame_of(const can::Signal& signal);

/// Writes one line. The frame must be one that a bus can carry; times are truncated to the microsecond, as by candump.
void write_can_frame(std::ostream& out, const can::Frame& frame, std::string_view interface_name);

}  // namespace curbline::tools
