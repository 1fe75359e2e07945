// The source of a replay's tilt frames: a candump log, or a live bus on which the recording is replayed (`canplayer -I
// LOG vcan0=can0`) while its scan lines are read from their log.
//
// A bus carries frames, not the times at which they were recorded, and canplayer sends each up to some milliseconds
// late. So the contents, the order and the losses of frames are those of the bus; the time of a frame is
//   1. the recorded one, if the recording's own CAN log lies beside the scan log: NAME.candump beside NAME.carmen, or
//      can.log. The curbs then equal those from that log, byte for byte, as long as no frame is lost.
//   2. otherwise the kernel's receive time, shifted by a constant, as if the first frame had come with the first line.
// A frame that is not in the log gets the time by rule 2, with the constant of the last frame that is in the log.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "curbline/can/signal.hpp"
#include "formats/can_log.hpp"

namespace curbline::tools {

class TiltFrames {
 public:
  virtual ~TiltFrames() = default;

  /// The next frame, in log time; nothing at the end, or while a bus is silent. `line_ns` is the time of the scan line
  /// that waits for it.
  virtual std::optional<can::Frame> next(std::int64_t line_ns) = 0;

  /// Time of the first frame of a log, before any is taken; nothing for a live bus.
  virtual std::optional<std::int64_t> first_time_ns() { return std::nullopt; }

  /// Whether there will be no more frames.
  virtual bool ended() const = 0;

  /// Throws BadInput that says what the scan lines are still waiting for.
  [[noreturn]] virtual void fail_silent() const = 0;

  /// Remarks for the user, at the end, about the bus; empty if there are none.
  virtual std::string remarks() const { return {}; }
};

/// Reads a candump log. Its next() throws BadInput for a frame of the signal from a second interface.
std::unique_ptr<TiltFrames> log_frames(const std::string& path, const can::Signal& signal);

/// Frames of the signal, and SYNC frames if it needs them, on a live interface. The recording's CAN log is looked for
/// beside `scan_log`; with a live scanner there is none, and frames keep the kernel's times. Throws BadInput if the
/// interface cannot be opened.
std::unique_ptr<TiltFrames> live_frames(const std::string& interface_name, const can::Signal& signal,
                                        std::optional<std::uint16_t> sync_id,
                                        const std::optional<std::string>& scan_log);

/// "vcan0" of "can:vcan0"; nothing if the text names a file.
std::optional<std::string> live_interface(const std::string& can);

}  // namespace curbline::tools
