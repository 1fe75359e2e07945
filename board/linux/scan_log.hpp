// Scan lines of a CARMEN log, each released at the time of its last beam. The log is read whole before the start (4.3
// kB a line of 1081 beams), so that nothing is allocated later and its errors are reported at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "curbline/scan_line.hpp"
#include "curbline/settings.hpp"
#include "formats/carmen.hpp"

namespace curbline::daemon {

class ScanLog {
 public:
  /// Throws BadInput for errors in the log, and if its number of beams is not that of the laser.
  ScanLog(const std::string& path, const LaserSettings& laser);

  bool ended() const { return next_ == lines_.size(); }

  /// Time of the next line's first beam, and when the line is due: with its last beam or, if the line behind it is
  /// earlier, with that line's. The log must not have ended.
  std::int64_t front_ns() const { return lines_[next_].time_ns; }
  std::int64_t due_ns() const;

  ScanLine take();

  const std::string& remarks() const { return remarks_; }  ///< LaserLog::remarks()

 private:
  std::vector<tools::CarmenLine> lines_;
  std::size_t next_ = 0;
  LaserSettings laser_;
  std::string remarks_;
};

}  // namespace curbline::daemon
