#include <cmath>
#include <numbers>

#include "curbline/setting_ranges.hpp"
#include "robot/parts.hpp"

namespace curbline::tools {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

struct LaserModel {
  const char* name;
  double first_bearing_deg, step_deg;
  int beams;
  double rate_hz;
  double turn_s;  ///< of the mirror; a turn has 360 / step beams, including those behind the housing
  double min_range_m, max_range_m;
  double range_sd_m;
  double beam_divergence_rad = static_cast<double>(LaserSettings{}.beam_divergence_rad);
};

/// Where a data sheet states no divergence, it is the default of LaserSettings.
constexpr LaserModel models[] = {
    // Hokuyo UTM-30LX data sheet: 270 deg, 0.25 deg, 25 ms a scan, 0.1 to 30 m guaranteed (60 m at most), repeatability
    // below 10 mm to 10 m (accuracy +-30 mm); SCIP 2.0 manual C-42-03320B: 1440 steps a turn, 1081 of
    // them measured.
    {"utm-30lx", -135.0, 0.25, 1081, 40.0, 0.025, 0.1, 30.0, 0.010},
    // SICK LMS1xx operating instructions 8012471: 270 deg, 0.5 deg at 50 Hz or 0.25 deg at 25 Hz, to 50 m; the LMS151
    // from 0.5 m; statistical error 12 mm (systematic +-30 mm); divergence 15 mrad. 50 Hz gives as many points a
    // second, and more lines while nodding.
    {"lms-151", -135.0, 0.5, 541, 50.0, 0.020, 0.5, 50.0, 0.012, 0.015},
    // SICK LMS2xx technical description: 180 deg, mirror at 75 Hz, mm mode to 8 m, statistical error 5 mm. Steps of 1
    // deg: for 0.5 deg the scanner interlaces two turns, so neighbouring beams are 13 ms apart, which is unusable on a
    // nodding laser.
    {"lms-200", -90.0, 1.0, 181, 75.0, 1.0 / 75.0, 0.1, 8.0, 0.005},
};

bool set_model(const std::string& name, Robot& robot) {
  for (const LaserModel& model : models) {
    if (name != model.name) continue;
    robot.scan_rate_hz = model.rate_hz;
    robot.laser.beams = model.beams;
    robot.laser.first_bearing_rad = static_cast<float>(model.first_bearing_deg * degree);
    robot.laser.bearing_step_rad = static_cast<float>(model.step_deg * degree);
    robot.laser.beam_interval_s = static_cast<float>(model.turn_s * model.step_deg / 360.0);
    robot.laser.min_range_m = static_cast<float>(model.min_range_m);
    robot.laser.max_range_m = static_cast<float>(model.max_range_m);
    robot.laser.range_sd_m = static_cast<float>(model.range_sd_m);
    robot.laser.beam_divergence_rad = static_cast<float>(model.beam_divergence_rad);
    return true;
  }
  return false;
}

/// Checks beyond the range of each key.
void check_scan(const TomlTable& table, const Robot& robot) {
  const LaserSettings& laser = robot.laser;
  if (laser.bearing_step_rad == 0.0f) table.refuse("bearing_step_rad", "is 0; expected another number");
  const auto first_rad = static_cast<double>(laser.first_bearing_rad),
             step_rad = static_cast<double>(laser.bearing_step_rad);
  if (std::abs(first_rad + laser.beams * step_rad) > 4.0 * std::numbers::pi) {
    table.refuse("bearing_step_rad", "times the beams, from first_bearing_rad on, is beyond two turns; expected less");
  }
  if ((laser.beams - 1) * static_cast<double>(laser.beam_interval_s) > 1.0 / robot.scan_rate_hz) {
    table.refuse("beam_interval_s", "times the beams is longer than a scan; expected 1 / scan_rate_hz at most");
  }
  if (!(laser.min_range_m < laser.max_range_m))
    table.refuse("max_range_m", "is not above min_range_m; expected a longer range");
}

}  // namespace

void read_laser(TomlTable table, Robot& robot) {
  namespace ranges = setting_ranges;
  table.read("model", robot.laser_model);
  if (!set_model(robot.laser_model, robot)) {
    table.refuse_word("model", robot.laser_model, "utm-30lx, lms-151 or lms-200");
  }
  LaserSettings& laser = robot.laser;
  table.read("scan_rate_hz", robot.scan_rate_hz, {0.1, 1000.0});
  table.read_whole("beams", laser.beams, 1, most_beams);
  table.read("first_bearing_rad", laser.first_bearing_rad, ranges::angle_rad);
  table.read("bearing_step_rad", laser.bearing_step_rad, ranges::bearing_step_rad);
  table.read("beam_interval_s", laser.beam_interval_s, ranges::beam_interval_s);
  table.read("min_range_m", laser.min_range_m, ranges::range_m);
  table.read("max_range_m", laser.max_range_m, ranges::range_m);
  table.read("range_sd_m", laser.range_sd_m, ranges::deviation_m);
  table.read("bearing_sd_rad", laser.bearing_sd_rad, ranges::deviation_rad);
  table.read("beam_divergence_rad", laser.beam_divergence_rad, ranges::divergence_rad);
  table.done();
  check_scan(table, robot);
}

}  // namespace curbline::tools
