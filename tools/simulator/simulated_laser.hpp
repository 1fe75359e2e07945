// What a laser range-finder reads: a beam with a width, noise and losses.
//
// The footprint is sampled by five rays: the middle and four at sqrt(5/8) of the half angle, which have the second
// moment of an even disc. Surfaces within a pulse length (1 m) of the nearest give one echo, whose range is the mean of
// their rays: beside an edge it lies between the two surfaces, a mixed pixel. Surfaces further apart give echoes of
// their own; the range is that of the first with two rays or more, else of the first.
#pragma once

#include "robot/robot.hpp"
#include "simulator/random.hpp"
#include "simulator/ray_caster.hpp"

#include <Eigen/Geometry>

namespace curbline::tools {

class SimulatedLaser {
 public:
  SimulatedLaser(const LaserSettings& laser, const SimulatedErrors& errors, std::uint64_t seed);

  /// Range of a beam, metres; NaN if nothing comes back or it is out of the laser's range.
  float measure(const RayCaster& world, const Eigen::Isometry3d& T_map_laser, double bearing_rad);

 private:
  double echo(const RayCaster& world, const Eigen::Isometry3d& T_map_laser, double bearing_rad) const;

  LaserSettings laser_;
  SimulatedErrors errors_;
  Random random_;
};

}  // namespace curbline::tools
