#include "formats/laser_log.hpp"

namespace curbline::tools {

LaserLog::LaserLog(const std::string& path, const LaserSettings& laser) : reader_(path), laser_(laser) {
  clock_.init(laser);
}

std::optional<CarmenLine> LaserLog::next() {
  while (auto line = reader_.next()) {
    check_geometry(*line, laser_, reader_.path(), reader_.line());
    const auto time_ns = clock_.time_of(line->time_ns);
    if (!time_ns) continue;
    line->time_ns = *time_ns;
    return line;
  }
  return std::nullopt;
}

std::string LaserLog::remarks() const {
  if (clock_.set_back() + clock_.left_out() == 0) return {};
  return reader_.path() + ": scan lines came late, each by another time: " + std::to_string(clock_.set_back()) +
         " were set back to the laser's turns, " + std::to_string(clock_.left_out()) + " left out, of no turn for sure";
}

}  // namespace curbline::tools
