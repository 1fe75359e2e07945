#include "simulator/simulated_laser.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace curbline::tools {
namespace {

constexpr double pulse_m = 1.0;
constexpr int rays = 5;

/// Range of the first echo that is strong enough; `hits` is ascending with `nothing` last.
double first_echo(const std::array<double, rays>& hits) {
  for (int from = 0; from < rays && hits[static_cast<std::size_t>(from)] < RayCaster::nothing;) {
    const double nearest = hits[static_cast<std::size_t>(from)];
    double sum = 0;
    int to = from;
    for (; to < rays && hits[static_cast<std::size_t>(to)] < nearest + pulse_m; ++to) {
      sum += hits[static_cast<std::size_t>(to)];
    }
    if (to - from >= 2) {
      return sum / (to - from);
    }
    from = to;
  }
  return hits.front();
}

}  // namespace

SimulatedLaser::SimulatedLaser(const LaserSettings& laser, const SimulatedErrors& errors, std::uint64_t seed)
    : laser_(laser), errors_(errors), random_(seed) {}

double SimulatedLaser::echo(const RayCaster& world, const Eigen::Isometry3d& T_map_laser, double bearing_rad) const {
  const Eigen::Vector3d origin = T_map_laser.translation();
  const Eigen::Vector3d ahead = T_map_laser.linear() * Eigen::Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), 0);
  if (errors_.beam_divergence_rad <= 0) {
    return world.cast(origin, ahead);
  }
  // Not normalised: angles of a few milliradians lengthen the rays by 1e-6.
  const double radius = std::sqrt(5.0 / 8.0) * errors_.beam_divergence_rad / 2;
  const Eigen::Vector3d up = radius * T_map_laser.linear().col(2);
  const Eigen::Vector3d left = up.cross(ahead);
  std::array<double, rays> hits{world.cast(origin, ahead), world.cast(origin, ahead + up),
                                world.cast(origin, ahead - up), world.cast(origin, ahead + left),
                                world.cast(origin, ahead - left)};
  std::sort(hits.begin(), hits.end());
  return first_echo(hits);
}

float SimulatedLaser::measure(const RayCaster& world, const Eigen::Isometry3d& T_map_laser, double bearing_rad) {
  // Drawn for every beam, so that what one beam hits does not affect the noise of the next.
  const double bearing_noise = random_.normal(), range_noise = random_.normal(), luck = random_.uniform();
  const double true_m = echo(world, T_map_laser, bearing_rad + laser_.bearing_sd_rad * bearing_noise);
  const auto range_m = static_cast<float>(true_m + laser_.range_sd_m * range_noise);
  const bool seen = luck >= errors_.dropout && range_m >= laser_.min_range_m && range_m < laser_.max_range_m;
  return seen ? range_m : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace curbline::tools
