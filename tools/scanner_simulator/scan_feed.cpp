#include "scanner_simulator/scan_feed.hpp"

#include <memory>
#include <variant>

#include "simulator/simulation.hpp"

namespace curbline::tools {
namespace {

std::optional<CarmenLine> next_line(Simulation& simulation, const LaserSettings& laser) {
  while (const auto event = simulation.next()) {
    if (const auto* line = std::get_if<ScanLine>(&*event)) return to_carmen(*line, laser);
  }
  return std::nullopt;
}

/// The geometry with which misfit_of() compares the other lines.
LaserSettings beams_of(const CarmenLine& line) {
  LaserSettings laser;
  laser.beams = static_cast<int>(line.ranges_m.size());
  laser.first_bearing_rad = static_cast<float>(line.start_angle_rad);
  laser.bearing_step_rad = static_cast<float>(line.angular_resolution_rad);
  return laser;
}

}  // namespace

ScanFeed ScanFeed::from_log(const std::string& path) {
  return ScanFeed([reader = std::make_shared<CarmenReader>(path), laser = LaserSettings{.beams = 0},
                   newest_ns = std::int64_t{0}]() mutable {
    auto line = reader->next();
    if (!line) return line;
    if (line->time_ns < newest_ns)
      throw BadInput(reader->path(), reader->line(),
                     "ipc_timestamp goes back; expected no less than that of the scan line before");
    newest_ns = line->time_ns;
    if (laser.beams == 0) {
      laser = beams_of(*line);
    } else if (misfit_of(line->ranges_m.size(), line->start_angle_rad, line->angular_resolution_rad, laser) !=
               Misfit::none) {
      throw BadInput(reader->path(), reader->line(),
                     "not the beams of the first scan line; expected the same number, start_angle and "
                     "angular_resolution");
    }
    return line;
  });
}

ScanFeed ScanFeed::from_scene(const Scene& scene, const Robot& robot) {
  return ScanFeed([simulation = std::make_shared<Simulation>(scene, robot, 1), laser = robot.laser] {
    return next_line(*simulation, laser);
  });
}

std::optional<CarmenLine> ScanFeed::next() {
  auto line = std::move(front_);
  front_ = line ? source_() : std::nullopt;
  return line;
}

}  // namespace curbline::tools
