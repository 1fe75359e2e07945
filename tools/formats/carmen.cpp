#include "formats/carmen.hpp"

#include <cmath>
#include <limits>

#include "formats/decimals.hpp"
#include "formats/fields.hpp"

namespace curbline::tools {
namespace {

constexpr std::int64_t most_beams = 100'000;
constexpr double furthest_m = 1e6;

/// CARMEN's message names consist of capitals, digits and underscores.
bool is_message_name(std::string_view word) {
  return word.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == std::string_view::npos;
}

void read_ranges(Fields& fields, CarmenLine& scan) {
  const std::int64_t beams = fields.whole("the number of ranges", 1, most_beams);
  scan.ranges_m.reserve(static_cast<std::size_t>(beams));
  for (std::int64_t i = 0; i < beams; ++i) {
    const double range_m = fields.number_or_nan("a range");
    const bool is_return = range_m > 0.0 && range_m < scan.maximum_range_m;
    scan.ranges_m.push_back(is_return ? static_cast<float>(range_m) : std::numeric_limits<float>::quiet_NaN());
  }
  const std::int64_t remissions = fields.whole("the number of remissions", 0, most_beams);
  for (std::int64_t i = 0; i < remissions; ++i) fields.number("a remission");
}

/// Parses what follows the message's name.
CarmenLine parse_scan(Fields& fields) {
  CarmenLine scan;
  fields.number("laser_type");
  scan.start_angle_rad = fields.number("start_angle");
  scan.field_of_view_rad = fields.number("field_of_view");
  scan.angular_resolution_rad = fields.number("angular_resolution");
  scan.maximum_range_m = fields.number("maximum_range");
  if (!(scan.maximum_range_m > 0.0 && scan.maximum_range_m <= furthest_m)) {
    fields.fail("maximum_range", readable(scan.maximum_range_m, 3), "metres above 0 and below a million");
  }
  scan.accuracy_m = fields.number("accuracy");
  fields.number("remission_mode");
  read_ranges(fields, scan);
  scan.time_ns = fields.time_ns("ipc_timestamp");
  fields.word("host");
  fields.time_ns("logger_timestamp");
  fields.expect_end();
  return scan;
}

}  // namespace

std::optional<CarmenLine> CarmenReader::next() {
  while (const auto text = source_.next()) {
    Fields fields(source_, *text);
    if (fields.at_end() || text->starts_with('#')) continue;
    const std::string_view message = fields.word("message");
    if (message != "RAWLASER1") {
      if (!is_message_name(message)) fields.fail("message", message, "RAWLASER1 or another CARMEN message");
      continue;
    }
    any_ = true;
    return parse_scan(fields);
  }
  if (!any_) throw BadInput(path() + ": no scan line; expected at least one RAWLASER1 message");
  return std::nullopt;
}

Misfit misfit_of(std::size_t beams, double first_bearing_rad, double bearing_step_rad, const LaserSettings& laser) {
  if (beams != static_cast<std::size_t>(laser.beams)) return Misfit::beams;
  const double first_rad = laser.first_bearing_rad, step_rad = laser.bearing_step_rad;
  const double tolerance_rad = 0.5 * std::abs(step_rad);
  if (!(std::abs(first_bearing_rad - first_rad) <= tolerance_rad)) return Misfit::first_bearing;
  const double at_last_rad = std::abs(bearing_step_rad - step_rad) * (laser.beams - 1);
  return at_last_rad <= tolerance_rad ? Misfit::none : Misfit::bearing_step;
}

void check_geometry(const CarmenLine& scan, const LaserSettings& laser, const std::string& file, long line) {
  const auto refuse = [&](const std::string& what, const std::string& expected, const char* name) {
    throw BadInput(file, line, what + "; expected " + expected + ", " + name + " of the robot's laser");
  };
  const std::size_t beams = scan.ranges_m.size();
  switch (misfit_of(beams, scan.start_angle_rad, scan.angular_resolution_rad, laser)) {
    case Misfit::none:
      return;
    case Misfit::beams:
      return refuse(std::to_string(beams) + " ranges", std::to_string(laser.beams), "the beams");
    case Misfit::first_bearing:
      return refuse("start_angle is " + readable(scan.start_angle_rad, 6), decimals(laser.first_bearing_rad, 6),
                    "first_bearing_rad");
    case Misfit::bearing_step:
      return refuse("angular_resolution is " + readable(scan.angular_resolution_rad, 9),
                    decimals(laser.bearing_step_rad, 9), "bearing_step_rad");
  }
}

CarmenLine to_carmen(const ScanLine& line, const LaserSettings& laser) {
  CarmenLine scan;
  scan.time_ns = line.time_ns;
  scan.start_angle_rad = static_cast<double>(laser.first_bearing_rad);
  scan.angular_resolution_rad = static_cast<double>(laser.bearing_step_rad);
  scan.field_of_view_rad = scan.angular_resolution_rad * (laser.beams - 1);
  scan.maximum_range_m = static_cast<double>(laser.max_range_m);
  scan.accuracy_m = static_cast<double>(laser.range_sd_m);
  scan.ranges_m.assign(line.ranges_m.begin(), line.ranges_m.end());
  return scan;
}

void write_carmen(std::ostream& out, const CarmenLine& scan) {
  std::string line = "RAWLASER1 0";
  for (const double angle_rad : {scan.start_angle_rad, scan.field_of_view_rad, scan.angular_resolution_rad}) {
    line += " " + decimals(angle_rad, 9);
  }
  line += " " + decimals(scan.maximum_range_m, 3) + " " + decimals(scan.accuracy_m, 3) + " 0 ";
  line += std::to_string(scan.ranges_m.size());
  for (const float range_m : scan.ranges_m) {
    line += ' ';
    append_decimals(line, std::isnan(range_m) ? scan.maximum_range_m : static_cast<double>(range_m), 3);
  }
  const std::string time = seconds(scan.time_ns, 6);
  out << line << " 0 " << time << " curbline " << time << '\n';
}

}  // namespace curbline::tools
