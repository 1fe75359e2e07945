// The readings of a laser range-finder: beams with a width, noise and losses.
//
// Five rays sample the footprint: the centre and four at sqrt(5/8) of the half angle, which together have the second
// moment of a uniform disc. Surfaces within a pulse length (1 m) of the nearest give one echo, whose range is the mean
// of their rays: at an edge it lies between the two surfaces, a mixed pixel. Surfaces further apart give separate
// echoes; the range is that of the first echo with two rays or more, or else of the first echo.
#pragma once

#include "robot/robot.hpp"
#include "simulator/random.hpp"
#include "simulator/ray_caster.hpp"

#include <Eigen/Geometry>

namespace curbline::tools {

class SimulatedLaser {
 public:
  SimulatedLaser(const LaserSettings& laser, const SimulatedErrors& errors, std::uint64_t seed);

  /// Range of a beam, metres; NaN if there is no return or it is out of the laser's range.
  float measure(const RayCaster& world, const Eigen::Isometry3d& T_map_laser, double bearing_rad);

 private:
  double echo(const RayCaster& world, const Eigen::Isometry3d& T_map_laser, double bearing_rad) const;

  LaserSettings laser_;
  SimulatedErrors errors_;
  Random random_;
};

}  // namespace curbline::tools
