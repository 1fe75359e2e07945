// Laser scan lines in a CARMEN log, message RAWLASER1:
//   RAWLASER1 type start_angle field_of_view angular_resolution maximum_range accuracy remission_mode
//             n range... n_remissions remission... ipc_timestamp host logger_timestamp
// Radians, metres, seconds; one message a line. Other messages and # comments are skipped.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "curbline/scan_line.hpp"
#include "curbline/settings.hpp"
#include "formats/line_reader.hpp"

namespace curbline::tools {

struct CarmenLine {
  std::int64_t time_ns = 0;  ///< ipc_timestamp: time of beam 0
  double start_angle_rad = 0.0;
  double field_of_view_rad = 0.0;
  double angular_resolution_rad = 0.0;  ///< from beam to beam
  double maximum_range_m = 0.0;
  double accuracy_m = 0.03;
  std::vector<float> ranges_m;  ///< NaN: no return (written as maximum_range; read from r >= maximum_range, r <= 0 and
                                ///< NaN)
};

class CarmenReader {
 public:
  explicit CarmenReader(const std::string& path) : source_(path) {}

  /// The next scan line; nothing at the end. Throws BadInput for a line that is truncated or contains anything but
  /// numbers, and for a file without a scan line. A time before the last one is for the caller to judge.
  std::optional<CarmenLine> next();

  const std::string& path() const { return source_.path(); }
  long line() const { return source_.line(); }  ///< of the last scan line returned

 private:
  LineReader source_;
  bool any_ = false;  ///< scan line
};

/// How a scan line differs from the robot's laser. Without a misfit, the number of beams is the same, and the bearings
/// of the first and the last agree within half a step.
enum class Misfit : unsigned char { none, beams, first_bearing, bearing_step };
Misfit misfit_of(std::size_t beams, double first_bearing_rad, double bearing_step_rad, const LaserSettings& laser);

/// Throws BadInput("file:line: ...") unless the scan line has the beams and bearings of the robot's laser.
void check_geometry(const CarmenLine& scan, const LaserSettings& laser, const std::string& file, long line);

/// A scan line in CARMEN's form, with the bearings, longest range and accuracy of the laser.
CarmenLine to_carmen(const ScanLine& line, const LaserSettings& laser);

/// Writes one line: ranges to the millimetre, angles to 1e-9 rad, times to the microsecond.
void write_carmen(std::ostream& out, const CarmenLine& scan);

}  // namespace curbline::tools
