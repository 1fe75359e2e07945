// The source of replay's scan lines: a CARMEN log (laser_log.hpp), or a scanner that is read live over its own
// protocol:
//   scip2:HOST[:PORT]   Hokuyo SCIP 2.0 over TCP (port 10940)
//   cola:HOST[:PORT]    SICK CoLa B over TCP (port 2112)
//   lms200:DEVICE       SICK LMS2xx on a serial line
//
// Live lines have the host's time, as the kernel's stamps of live CAN frames do. Beside a CAN or pose log they have the
// log's time: the scanner's counter is then the log's time modulo its width, as with curbline-scanner; a line's time is
// exact to the millisecond (SCIP 2.0) or microsecond (CoLa). LMS2xx telegrams have no time stamps and cannot be
// combined with a log.
//
// A live source ends when the scanner closes the connection or falls silent, which is reported on stderr, or at Ctrl-C
// (SIGINT), which acts like the end of a log; a second Ctrl-C kills.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "formats/carmen.hpp"
#include "robot/robot.hpp"
#include "streams/scanner_link.hpp"

namespace curbline::tools {

class ScanSource {
 public:
  virtual ~ScanSource() = default;

  /// The next scan line, with the number of beams of the robot's laser; nothing at the end. Throws BadInput: for a log
  /// as CarmenReader does, for a scanner that sends nothing within a few seconds, and if the number of beams is not the
  /// robot's.
  virtual std::optional<CarmenLine> next() = 0;

  /// LaserLog::of_the_future().
  virtual bool of_the_future() const { return false; }

  /// Remarks for the user, at the end, about the arrival of the lines; empty if there are none.
  virtual std::string remarks() const { return {}; }
};

/// `log_time_ns`: a time in the logs that belong to the lines; nothing if there are none, or CAN is live. Throws
/// BadInput if it cannot be opened.
std::unique_ptr<ScanSource> open_scan_source(const std::string& scans, const LaserSettings& laser,
                                             std::optional<std::int64_t> log_time_ns);

}  // namespace curbline::tools
