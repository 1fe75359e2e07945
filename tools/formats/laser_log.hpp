// The scan lines of a CARMEN log as a robot's laser measured them. Their beams must be those of the laser. If they are
// stamped on arrival at a host, their times are corrected to the turns of the mirror (curbline/intake/line_clock.hpp).
// Stamps that already lie on turns are kept to the nanosecond.
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

  /// Remarks for the user about the stamps, at the end; empty if all were kept.
  std::string remarks() const;

 private:
  CarmenReader reader_;
  LaserSettings laser_;
  LineClock clock_;
};

}  // namespace curbline::tools
