// How a call ended.
#pragma once

#include <cstdint>

namespace curbline {

/// What init() returns, naming the part of the settings at fault, and what a call that takes data returns.
enum class Status : std::uint8_t {
  ok,
  not_initialised,    ///< init() has not succeeded
  bad_window,         ///< a size, corner or height out of range, or rows or cols no multiple of 4
  bad_laser,          ///< beams, bearings, intervals, ranges or noise out of range
  bad_tilt,           ///< mount, angle, latency, noise or bound out of range
  bad_pose,           ///< noise or bound out of range
  bad_inference,      ///< a prior, coupling or bound out of range
  line_out_of_order,  ///< the line is not later than the one before it (rising_times.hpp): dropped
  line_too_long,      ///< more beams than the laser has: dropped
  no_tilt,            ///< no tilt angle near the line's time: dropped
  no_pose,            ///< no pose near the line's time: dropped
};

/// A word for logs, static storage.
const char* to_string(Status status);

}  // namespace curbline
