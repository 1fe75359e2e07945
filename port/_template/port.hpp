// Copy this folder, and write in port.cpp what your board has. Until then everything answers "nothing has come". What a
// port promises is in port/README.md; the numbers behind "now" and every stamp are nanoseconds of one clock that only
// goes forward.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "curbline/can/curb_frames.hpp"
#include "curbline/can/frame.hpp"
#include "curbline/can/signal.hpp"
#include "curbline/pose.hpp"
#include "curbline/scan_line.hpp"

/// What a robot's firmware needs of its board. All calls come from one context; none waits.
class Port {
 public:
  /// Starts the clock, the bus (a filter that lets `tilt` through) and the scanner. False if one of them does not.
  bool open(const curbline::can::Signal& tilt);

  std::int64_t now_ns();

  /// Fills `out` from its start with the frames of the bus, oldest first, each with the time at which it came in, and
  /// returns how many. Up to a millisecond of delay in that time is as good as a servo's own.
  int receive(std::span<curbline::can::Frame> out);

  /// A scan line that is complete. Its time is that of its first beam; its ranges stay until the next call.
  std::optional<curbline::ScanLine> scan_line();

  /// A pose of the robot. Never one, if settings say that it stands still.
  std::optional<curbline::Pose> pose();

  /// Queues a frame for the rest of the robot. False if there is no room.
  bool send(const curbline::can::Frame& frame);

  /// Called after each pass of the main loop: where a board sleeps until the next interrupt, and feeds its watchdog.
  void rest();

  /// The robot cannot start: `why` to wherever the board can say it. Never returns.
  [[noreturn]] void stop(const char* why);
};
