// Where the tilt frames of a replay come from: a candump log, or a live bus on which the recording is played again
// (`canplayer -I LOG vcan0=can0`) while its scan lines are read from their log.
//
// A bus carries frames, not the times at which they were recorded, and canplayer sends each up to some milliseconds
// late. So what a frame says, its order and whether it comes at all are the bus's; its time is
//   1. the recorded one, where the recording's own CAN log lies beside the scan log: NAME.candump beside NAME.carmen,
//      or can.log. Then the curbs are those of reading that log, byte for byte, as long as no frame is lost.
//   2. else the kernel's receive time, moved by a constant: the first frame came at the time of the first scan line.
// A frame that is not in the log has the time of 2, the constant being that of the last one that is.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "curbline/can/signal.hpp"
#include "formats/can_log.hpp"

namespace curbline::tools {

class TiltFrames {
 public:
  virtual ~TiltFrames() = default;

  /// The next frame, in log time; nothing at the end, or when a bus is silent. `line_ns` is the time of the scan line
  /// that waits for it.
  virtual std::optional<can::Frame> next(std::int64_t line_ns) = 0;

  /// Whether no more will come.
  virtual bool ended() const = 0;

  /// Throws BadInput that says what the scan lines still wait for.
  [[noreturn]] virtual void fail_silent() const = 0;

  /// What a user should know of the bus at the end; empty if all is well.
  virtual std::string remarks() const { return {}; }
};

/// Reads a candump log. Its next() throws BadInput for a frame of the signal from a second interface.
std::unique_ptr<TiltFrames> log_frames(const std::string& path, const can::Signal& signal);

/// Frames of the signal, and SYNC frames if it waits for them, on a live interface. `scan_log` is where the recording's
/// CAN log is looked for; beside a live scanner there is none, and frames keep the kernel's times. Throws BadInput if
/// the interface cannot be opened.
std::unique_ptr<TiltFrames> live_frames(const std::string& interface_name, const can::Signal& signal,
                                        std::optional<std::uint16_t> sync_id,
                                        const std::optional<std::string>& scan_log);

/// "vcan0" of "can:vcan0"; nothing if the text names a file.
std::optional<std::string> live_interface(const std::string& can);

}  // namespace curbline::tools
