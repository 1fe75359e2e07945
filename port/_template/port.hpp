// Copy this folder and fill in port.cpp for your board. Until then every call returns "nothing has come".
// port/README.md says what a port promises. "Now" and all stamps are nanoseconds of the same clock, which only goes
// forward.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "curbline/can/curb_frames.hpp"
#include "curbline/can/frame.hpp"
#include "curbline/can/signal.hpp"
#include "curbline/pose.hpp"
#include "curbline/scan_line.hpp"

/// What a robot's firmware needs from its board. All calls come from one context; none waits.
class Port {
 public:
  /// Starts the clock, the bus (with a filter that passes `tilt`) and the scanner. False if one of them fails.
  bool open(const curbline::can::Signal& tilt);

  std::int64_t now_ns();

  /// Fills `out` from its start with the frames received from the bus, oldest first, each with its time of reception,
  /// and returns their number. A delay of up to a millisecond in that time is no worse than the servo's own.
  int receive(std::span<curbline::can::Frame> out);

  /// A complete scan line. Its time is that of its first beam; its ranges are valid until the next call. Its bearings
  /// are taken to be those of LaserSettings: compare them if the scanner tells its own, as scanner::Line does, since a
  /// scanner that is set to another step or sector maps the ground where it is not.
  std::optional<curbline::ScanLine> scan_line();

  /// A pose of the robot. Always nothing if the settings say that the robot is stationary.
  std::optional<curbline::Pose> pose();

  /// Queues a frame to be sent to the rest of the robot. False if there is no room.
  bool send(const curbline::can::Frame& frame);

  /// Called after each pass of the main loop: lets the board sleep until the next interrupt, and feeds the watchdog.
  void rest();

  /// Called if the robot cannot start: reports `why` wherever the board can. Never returns.
  [[noreturn]] void stop(const char* why);
};
