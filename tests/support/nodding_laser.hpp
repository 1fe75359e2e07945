// A nodding laser on a mast in front of a step, as the pipeline sees it: tilt readings, poses and scan lines of a
// street that is flat except for one vertical step across x. Exact apart from the noise requested.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "curbline/pipeline.hpp"
#include "support/terrain.hpp"

namespace curbline::test {

/// Ground of height 0 before x = step_x_m and step_m from there on (negative: down). Aslant, x is turned to the left.
struct Street {
  double step_x_m = 2.0;
  double step_m = 0.12;
  double aslant_rad = 0.0;
};

/// Range along a ray from `origin` with direction (dx, dy, dz) of unit length, x across the step; infinite if it meets
/// nothing.
inline double range_to(const Street& street, double ox, double oz, double dx, double dz) {
  const double far = std::numeric_limits<double>::infinity();
  const double to_near = dz < 0.0 ? -oz / dz : far, to_far = dz < 0.0 ? (street.step_m - oz) / dz : far;
  const double to_face = (street.step_x_m - ox) / dx;
  const bool starts_near = ox < street.step_x_m;
  const double first = starts_near ? to_near : to_far, second = starts_near ? to_far : to_near;
  if (!(to_face > 0.0) || first <= to_face) return first;  // meets its own side
  const double z_face = oz + to_face * dz;
  if (z_face >= 0.0 && z_face < street.step_m && starts_near) return to_face;  // the face of a step up
  return second;
}

/// 40 lines a second over 180 degrees ahead in steps of half a degree, nodding from 15 to 75 degrees down and back in
/// 10 s.
class NoddingLaser {
 public:
  static constexpr int beams = 361;
  static constexpr double height_m = 1.0, line_s = 0.025, sweep_s = 5.0, noise_sd_m = 0.005;
  static constexpr std::int64_t epoch_ns = 1'290'682'980'000'000'000;

  static Settings settings() {
    Settings s;
    s.laser.beams = beams;
    s.laser.first_bearing_rad = -1.5707963f;
    s.laser.bearing_step_rad = 3.1415927f / 360.0f;
    s.laser.range_sd_m = static_cast<float>(noise_sd_m);
    s.laser.max_range_m = 30.0f;
    s.tilt.T_base_tilt.z_m = static_cast<float>(height_m);
    return s;
  }

  static std::int64_t ns(double time_s) { return epoch_ns + static_cast<std::int64_t>(std::llround(time_s * 1e9)); }
  static double line_time_s(int line) { return line_s * line; }

  /// A triangle wave; tilt > 0 looks down.
  static double tilt_rad(double time_s) {
    const double phase = std::fmod(time_s + 20.0 * sweep_s, 2.0 * sweep_s) / sweep_s;
    return 0.26 + 1.05 * (phase < 1.0 ? phase : 2.0 - phase);
  }

  /// Ranges of a line while the robot drives straight along x, at x_m(time) metres.
  template <typename Position>
  std::vector<float> ranges(const Street& street, int line, Position&& x_m) {
    const double interval = static_cast<double>(LaserSettings{}.beam_interval_s);
    std::vector<float> out(beams);
    for (int i = 0; i < beams; ++i) {
      const double time = line_time_s(line) + interval * i,
                   bearing = -1.5707963267948966 + 3.141592653589793 / 360.0 * i;
      const double tilt = tilt_rad(time), ahead = std::cos(bearing) * std::cos(tilt), left = std::sin(bearing),
                   down = std::cos(bearing) * std::sin(tilt);
      const double cosine = std::cos(street.aslant_rad), sine = std::sin(street.aslant_rad);
      const double range_m = range_to(street, cosine * x_m(time), height_m, cosine * ahead + sine * left, -down);
      out[static_cast<std::size_t>(i)] = static_cast<float>(range_m + noise_sd_m * noise_.normal());
    }
    return out;
  }

 private:
  Noise noise_{17};
};

}  // namespace curbline::test
