// The scan lines of a CARMEN log as a robot's laser measured them. Their beams must be those of the laser. If they are
// stamped on arrival at a host, their times are corrected to the turns of the mirror (curbline/intake/line_clock.hpp).
// Stamps that already lie on turns are kept to the nanosecond. A line whose time goes back is passed on: the pipeline
// drops and counts it, as on the robot.
#pragma once

#include <optional>
#include <string>

#include "curbline/intake/line_clock.hpp"
#include "formats/carmen.hpp"

namespace curbline::tools {

class LaserLog {
 public:
  LaserLog(const std::string& path, const LaserSettings& laser);

  /// The next scan line; nothing at the end. Throws BadInput as CarmenReader and check_geometry() do.
  std::optional<CarmenLine> next();

  /// Is the line that next() gave last stamped later than the one behind it, by more than a busy machine may delay
  /// frames and poses? Its stamp is damaged, and waiting for them would use up those of all other lines.
  bool of_the_future() const;

  /// Remarks for the user about the stamps, at the end; empty if all were kept.
  std::string remarks() const;

 private:
  std::optional<CarmenLine> read();

  CarmenReader reader_;
  LaserSettings laser_;
  LineClock clock_;
  std::optional<CarmenLine> ahead_;  ///< read, and not given yet
  bool begun_ = false;
  std::int64_t time_ns_ = 0;  ///< of the line given last
};

}  // namespace curbline::tools
