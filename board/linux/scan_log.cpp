#include "scan_log.hpp"

namespace curbline::daemon {

ScanLog::ScanLog(const std::string& path, const LaserSettings& laser) : beam_interval_s_(laser.beam_interval_s) {
  tools::CarmenReader reader(path);
  while (auto line = reader.next()) {
    check_geometry(*line, laser, reader.path(), reader.line());
    lines_.push_back(std::move(*line));
  }
}

std::int64_t ScanLog::due_ns() const {
  const auto beams = static_cast<float>(lines_[next_].ranges_m.size());
  return front_ns() + static_cast<std::int64_t>(beam_interval_s_ * beams * 1e9f);
}

ScanLine ScanLog::take() {
  const tools::CarmenLine& line = lines_[next_++];
  return {line.time_ns, line.ranges_m};
}

}  // namespace curbline::daemon
