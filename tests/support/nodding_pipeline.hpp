// The pipeline of a robot with a nodding laser, for tests of the whole chain.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <span>

#include "support/nodding_laser.hpp"

namespace curbline::test {

using FullPipeline = Pipeline<Limits{}>;

inline std::unique_ptr<FullPipeline> started(const Settings& settings = NoddingLaser::settings()) {
  auto pipeline = std::make_unique<FullPipeline>();
  REQUIRE(pipeline->init(settings) == Status::ok);
  return pipeline;
}

/// Tilt readings at 100 Hz up to `line` and one beyond its end, of angle_rad(their time).
template <typename Angle>
void add_angles(FullPipeline& pipeline, int line, Angle&& angle_rad) {
  const double end = NoddingLaser::line_time_s(line) + 0.03;
  for (double t = end - NoddingLaser::line_s + 0.005; t <= end + 1e-9; t += 0.01)
    pipeline.add_tilt({NoddingLaser::ns(t), static_cast<float>(angle_rad(t))});
}

/// Each delayed by lag_s(its time).
template <typename Lag>
void add_tilts(FullPipeline& pipeline, int line, Lag&& lag_s) {
  add_angles(pipeline, line, [&](double t) { return NoddingLaser::tilt_rad(t - lag_s(t)); });
}
inline void add_tilts(FullPipeline& pipeline, int line) {
  add_tilts(pipeline, line, [](double) { return 0.0; });
}

/// The longest piece of curb.
inline const Curb& longest(std::span<const Curb> curbs) {
  REQUIRE_FALSE(curbs.empty());
  const auto length2 = [](const Curb& c) {
    return (c.x1_m - c.x0_m) * (c.x1_m - c.x0_m) + (c.y1_m - c.y0_m) * (c.y1_m - c.y0_m);
  };
  return *std::max_element(curbs.begin(), curbs.end(),
                           [&](const Curb& a, const Curb& b) { return length2(a) < length2(b); });
}

}  // namespace curbline::test
