// The pipeline of a robot that drives with a laser that looks farther down, or less far, than its mount says.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "curbline/pipeline.hpp"
#include "support/nodding_pipeline.hpp"

namespace curbline {
namespace {

using test::add_angles;
using test::FullPipeline;
using test::NoddingLaser;
using test::started;

struct Place {
  double x_m, y_m, heading_rad;
};

Pose pose_at(const Place& place, double time_s) {
  Pose pose{NoddingLaser::ns(time_s), static_cast<float>(place.x_m), static_cast<float>(place.y_m)};
  pose.qz = static_cast<float>(std::sin(0.5 * place.heading_rad));
  pose.qw = static_cast<float>(std::cos(0.5 * place.heading_rad));
  return pose;
}

/// A mount half a metre ahead of the base that is pitched down by lean_rad more than it says.
Settings leaning_settings(float lean_rad) {
  Settings settings = NoddingLaser::settings();
  settings.pose.still = false;
  settings.tilt.T_base_tilt.x_m = 0.5f;
  settings.tilt.T_base_tilt.pitch_rad = -lean_rad;
  return settings;
}

std::unique_ptr<FullPipeline> leaning(float lean_rad, bool fixed_window = false) {
  Settings settings = leaning_settings(lean_rad);
  settings.window.fixed = fixed_window;
  return started(settings);
}

/// Fifty seconds over level ground. way(time) is the robot's place, angle_rad(time) the servo's reading. Returns the
/// number of lines with a step in view in the second half.
template <typename Way, typename Angle>
int drive(FullPipeline& pipeline, Way&& way, Angle&& angle_rad) {
  NoddingLaser laser;
  int with_steps = 0;
  for (int line = 0; line < 2000; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    add_angles(pipeline, line, angle_rad);
    for (const double pose_s : {t, t + 0.02}) pipeline.add_pose(pose_at(way(pose_s), pose_s));
    pipeline.take({NoddingLaser::ns(t), laser.ranges({1e4, 0.12}, line, [](double) { return 0.0; })});
    const auto is_step = [](const Curb& c) { return c.kind != CurbKind::crease && c.kind != CurbKind::ramp_edge; };
    with_steps += line >= 1000 && std::any_of(pipeline.curbs().begin(), pipeline.curbs().end(), is_step);
  }
  return with_steps;
}

template <typename Way>
int drive(FullPipeline& pipeline, Way&& way) {
  return drive(pipeline, way, NoddingLaser::tilt_rad);
}

/// Root mean square height of the map's cells.
double off_level_m(const FullPipeline& pipeline) {
  double sum = 0.0, cells = 0.0;
  pipeline.dem().for_each_valid([&](int, int, int slot) {
    const double height_m = static_cast<double>(pipeline.dem().cell(slot).height_m);
    sum += height_m * height_m;
    cells += 1.0;
  });
  return std::sqrt(sum / cells);
}

Place along(double way_m, double heading_rad) {
  return {way_m * std::cos(heading_rad), way_m * std::sin(heading_rad), heading_rad};
}

TEST_CASE("pipeline: a laser that leans by half a degree bends no map of level ground once it is known") {
  const float lean_rad = GENERATE(-0.009f, 0.009f);
  const auto way = GENERATE(0, 1, 2, 3, 4);
  const auto pipeline = leaning(lean_rad);
  const int with_steps = drive(*pipeline, [way](double t) -> Place {
    if (way == 0) return along(0.2 * t, 2.0);
    if (way == 1) return along(0.4 * t, 0.0);
    if (way == 2) return along(t, -1.0);
    if (way == 3) return {std::sin(0.3 * t), 1.0 - std::cos(0.3 * t), 0.3 * t};  // a circle of 1 m
    return {0.0, 0.0, 0.6 * t};                                                  // on the spot
  });
  INFO("way " << way);
  CHECK(with_steps == 0);
  CHECK(pipeline->tilt_latency().lean_rad() == Approx(lean_rad).margin(0.0015));
  CHECK(off_level_m(*pipeline) < 0.004);
}

TEST_CASE("pipeline: to and fro in a window that stays, a laser that leans by half a degree is found too") {
  const auto pipeline = leaning(0.009f, true);
  drive(*pipeline, [](double t) { return along(std::abs(3.0 - std::fmod(0.3 * t + 3.0, 6.0)), 0.0); });
  CHECK(pipeline->tilt_latency().lean_rad() == Approx(0.009).margin(0.0015));
  CHECK(off_level_m(*pipeline) < 0.004);
}

TEST_CASE("pipeline: a laser that hangs upside down, so that a greater tilt looks up, is found to lean, too") {
  const float lean_rad = GENERATE(-0.009f, 0.009f);
  Settings settings = leaning_settings(lean_rad);
  settings.tilt.T_base_tilt.roll_rad = pi;
  const auto pipeline = started(settings);
  CHECK(drive(
            *pipeline, [](double t) { return along(0.3 * t, 1.0); },
            [](double t) { return -NoddingLaser::tilt_rad(t); }) == 0);
  CHECK(pipeline->tilt_latency().lean_rad() == Approx(-lean_rad).margin(0.0015));
  CHECK(off_level_m(*pipeline) < 0.004);
}

TEST_CASE("pipeline: a laser that looks where its mount says stays so, however slow the robot") {
  const double speed_m_s = GENERATE(0.0, 0.05, 0.3);
  const auto pipeline = leaning(0.0f);
  CHECK(drive(*pipeline, [&](double t) { return along(speed_m_s * t, 2.0); }) == 0);
  CHECK(std::abs(pipeline->tilt_latency().lean_rad()) < 0.001f);
}

TEST_CASE("pipeline: errors of a servo's angles, by which its latency is never quite known, pitch no level ground") {
  const double speed_m_s = GENERATE(0.2, 0.4);
  const std::uint32_t seed = GENERATE(2u, 3u, 4u, 5u);
  const auto pipeline = leaning(0.0f);
  test::Noise noise(seed);
  const double angle_sd_rad = static_cast<double>(TiltSettings{}.angle_sd_rad);
  CHECK(drive(
            *pipeline, [&](double t) { return along(speed_m_s * t, 0.1 * seed); },
            [&](double t) { return NoddingLaser::tilt_rad(t - 0.01) + angle_sd_rad * noise.normal(); }) == 0);
  INFO("speed " << speed_m_s << " m/s, seed " << seed);
  CHECK(std::abs(pipeline->tilt_latency().lean_rad()) < 0.001f);
  CHECK(off_level_m(*pipeline) < 0.0025);
}

}  // namespace
}  // namespace curbline
