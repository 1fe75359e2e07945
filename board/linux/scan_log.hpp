// Scan lines of a CARMEN log, each when its last beam would be there. The log is read whole before the start (4.3 kB a
// line of 1081 beams), so that nothing is allocated later and what is wrong with it is said at once.
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
  /// Throws BadInput for what is wrong with the log, and for beams that are not those of the laser.
  ScanLog(const std::string& path, const LaserSettings& laser);

  bool ended() const { return next_ == lines_.size(); }

  /// Times of the next line's first beam and of its last; of a log that has not ended.
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
