// The scan lines of a CARMEN log as a robot's laser measured them: their beams are its own, and where they bear the
// times of their arrival on a host, they get those of the mirror's turns (curbline/intake/line_clock.hpp). Stamps that
// lie on turns are kept to the nanosecond.
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

  /// What a user should know of the stamps at the end; empty if all were kept.
  std::string remarks() const;

 private:
  CarmenReader reader_;
  LaserSettings laser_;
  LineClock clock_;
};

}  // namespace curbline::tools
