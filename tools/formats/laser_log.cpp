#include "formats/laser_log.hpp"

namespace curbline::tools {
namespace {

constexpr std::int64_t longest_wait_ns = 1'000'000'000;

}  // namespace

LaserLog::LaserLog(const std::string& path, const LaserSettings& laser) : reader_(path), laser_(laser) {
  clock_.init(laser);
}

std::optional<CarmenLine> LaserLog::next() {
  auto line = begun_ ? std::move(ahead_) : read();
  begun_ = true;
  ahead_ = line ? read() : std::nullopt;
  if (line) time_ns_ = line->time_ns;
  return line;
}

bool LaserLog::of_the_future() const {
  return ahead_ && ahead_->time_ns < time_ns_ - longest_wait_ns;
}

std::optional<CarmenLine> LaserLog::read() {
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
