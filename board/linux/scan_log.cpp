#include "scan_log.hpp"

#include <algorithm>

#include "formats/laser_log.hpp"

namespace curbline::daemon {

ScanLog::ScanLog(const std::string& path, const LaserSettings& laser) : laser_(laser) {
  tools::LaserLog log(path, laser);
  while (auto line = log.next()) lines_.push_back(std::move(*line));
  remarks_ = log.remarks();
}

std::int64_t ScanLog::due_ns() const {
  std::int64_t first_beam_ns = front_ns();
  if (next_ + 1 < lines_.size()) first_beam_ns = std::min(first_beam_ns, lines_[next_ + 1].time_ns);
  return first_beam_ns + laser_.duration_ns(lines_[next_].ranges_m.size());
}

ScanLine ScanLog::take() {
  const tools::CarmenLine& line = lines_[next_++];
  return {line.time_ns, line.ranges_m};
}

}  // namespace curbline::daemon
