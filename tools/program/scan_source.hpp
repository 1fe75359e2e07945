// Where replay has its scan lines from: a CARMEN log (laser_log.hpp), or a scanner that is read live over its own
// protocol:
//   scip2:HOST[:PORT]   Hokuyo SCIP 2.0 over TCP (port 10940)
//   cola:HOST[:PORT]    SICK CoLa B over TCP (port 2112)
//   lms200:DEVICE       SICK LMS2xx on a serial line
//
// The times of live lines are those of the host, as the kernel's stamps of live CAN frames are. Beside a CAN or pose
// log they are those of the log: the scanner's counter is then the log's time, modulo its width, as curbline-scanner
// has it; the line's time is exact to the millisecond (SCIP 2.0) or microsecond (CoLa). LMS2xx telegrams bear no time
// and cannot be joined with a log.
//
// A live source ends when the scanner closes the connection or falls silent, of which a line on stderr tells, or at
// Ctrl-C (SIGINT), as a log ends; a second Ctrl-C kills.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "formats/carmen.hpp"
#include "program/scanner_link.hpp"
#include "robot/robot.hpp"

namespace curbline::tools {

class ScanSource {
 public:
  virtual ~ScanSource() = default;

  /// The next scan line, with the beams of the robot's laser; nothing at the end. Throws BadInput: for a log as
  /// CarmenReader does, for a scanner that sends nothing within a few seconds, and where the beams are others than the
  /// robot's.
  virtual std::optional<CarmenLine> next() = 0;

  /// What a user should know at the end of how lines came; empty if all is well.
  virtual std::string remarks() const { return {}; }
};

/// `log_time_ns`: a time in the logs that belong to the lines; nothing if there is none, or CAN is live. Throws
/// BadInput if it cannot be opened.
std::unique_ptr<ScanSource> open_scan_source(const std::string& scans, const LaserSettings& laser,
                                             std::optional<std::int64_t> log_time_ns);

}  // namespace curbline::tools
