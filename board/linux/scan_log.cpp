#include "scan_log.hpp"

namespace curbline::daemon {

ScanLog::ScanLog(const std::string& path, const LaserSettings& laser) : laser_(laser) {
  tools::CarmenReader reader(path);
  while (auto line = reader.next()) {
    check_geometry(*line, laser, reader.path(), reader.line());
    lines_.push_back(std::move(*line));
  }
}

std::int64_t ScanLog::due_ns() const {
  return front_ns() + laser_.duration_ns(lines_[next_].ranges_m.size());
}

ScanLine ScanLog::take() {
  const tools::CarmenLine& line = lines_[next_++];
  return {line.time_ns, line.ranges_m};
}

}  // namespace curbline::daemon
