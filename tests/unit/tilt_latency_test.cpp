// A servo's latency, from ground that is seen twice.
#include "curbline/intake/tilt_latency.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/terrain.hpp"

namespace curbline {
namespace {

using Turn = TiltLatency::Turn;

constexpr float rate_rad_s = 0.5f, range_m = 2.0f, point_sd_m = 0.01f;

/// A new number for each line, as if each lay between other readings.
std::uint32_t next_reading() {
  static std::uint32_t reading = 0;
  return ++reading;
}

TiltSettings tilt_settings() {
  TiltSettings tilt;
  tilt.latency_sd_s = 0.01f;
  tilt.time_sd_s = 0.001f;
  tilt.angle_sd_rad = 0.0005f;
  return tilt;
}

TiltLatency started(const PoseSettings& pose = {}) {
  TiltLatency latency;
  latency.init(tilt_settings(), pose);
  return latency;
}

/// A sweep of 40 lines from 0.2 to 1.2 rad or back, over ground that appears where a latency of lag_s puts it.
void sweep(TiltLatency& latency, bool downward, float lag_s, test::Noise& noise, float outliers_m = 0.0f) {
  const float rate = downward ? rate_rad_s : -rate_rad_s, growth = rate * range_m;
  for (int line = 0; line < 40; ++line) {
    const float advance = 0.025f * static_cast<float>(line);
    latency.begin_line(downward ? 0.2f + advance : 1.2f - advance, rate, next_reading());
    const float missing_s = lag_s - latency.offset_s();
    for (int point = 0; point < 20; ++point) {
      const float other = point % 5 == 0 ? outliers_m : 0.0f;
      latency.compare({-growth * missing_s + point_sd_m * static_cast<float>(noise.normal()) + other,
                       point_sd_m * point_sd_m,
                       0.0f,
                       {growth}});
    }
    latency.end_line(rate);
  }
}

TEST_CASE("tilt latency: the lag of a sweep is found, within its standard deviation") {
  const float lag_s = GENERATE(-0.015f, 0.004f, 0.02f);
  TiltLatency latency = started();
  test::Noise noise(1);
  latency.begin_line(0.2f, rate_rad_s, next_reading());
  sweep(latency, false, lag_s, noise);
  CHECK(latency.sd_s() < 0.001f);
  CHECK(std::abs(latency.offset_s() - lag_s) < 4.0f * latency.sd_s());
}

TEST_CASE("tilt latency: a line leaves open what the mean of its points does, and what they share") {
  const int points = GENERATE(1, 4, 100);
  TiltLatency latency = started();
  latency.begin_line(0.2f, rate_rad_s, next_reading());
  for (const float angle_rad : {1.2f, 1.175f}) latency.begin_line(angle_rad, -rate_rad_s, next_reading());
  const float growth = rate_rad_s * range_m;
  for (int k = 0; k < points; ++k) latency.compare({0.0f, point_sd_m * point_sd_m, 0.0f, {growth}});
  latency.end_line(-rate_rad_s);
  const double of_mean_s = point_sd_m / growth / std::sqrt(points);
  const double of_line_s2 = of_mean_s * of_mean_s + 0.001 * 0.001 + std::pow(0.0005 / 0.5, 2), prior_s2 = 0.01 * 0.01;
  CHECK(latency.sd_s() == Approx(std::sqrt(1.0 / (1.0 / prior_s2 + 1.0 / of_line_s2))).epsilon(1e-3));
}

TEST_CASE("tilt latency: upward and downward sweeps have their own, which may change from sweep to sweep") {
  TiltLatency latency = started();
  test::Noise noise(2);
  for (int k = 0; k < 4; ++k) {
    const float up_s = 0.010f + 0.005f * static_cast<float>(k), down_s = -0.004f * static_cast<float>(k);
    sweep(latency, true, down_s, noise);
    CHECK(latency.offset_s() == Approx(down_s).margin(0.0015));
    sweep(latency, false, up_s, noise);
    CHECK(latency.offset_s() == Approx(up_s).margin(0.0015));
  }
}

/// Sweeps over ground that the one before, in the other direction, saw from farther away: the longer ago, the farther.
/// A stationary robot saw it from the same place.
struct Sweeps {
  explicit Sweeps(bool moves) : drives(moves) {
    PoseSettings pose;
    pose.still = !drives;
    latency = started(pose);
  }

  void sweep(float lag_s) {
    const bool downward = sweeps++ % 2 == 1;
    const float rate = downward ? rate_rad_s : -rate_rad_s, growth = rate * range_m;
    bool turned = drives && sweeps > 1;  // stationary, comparisons begin when the turn is reported
    for (int line = 0; line < 40; ++line) {
      const float advance = 0.025f * static_cast<float>(line);
      const Turn turn = latency.begin_line(downward ? 0.2f + advance : 1.2f - advance, rate, next_reading());
      turned = turned || turn == Turn::new_sweep;
      const float map_growth = -growth * (drives ? 1.0f + advance : 1.0f);
      const float farther_m = drives ? -range_m * advance : 0.0f;
      const float above_m = -growth * (lag_s - latency.offset_s()) + map_growth * (map_lag_s - map_offset_s) +
                            (lean_rad - latency.lean_rad()) * farther_m;
      for (int point = 0; point < 20 && turned; ++point) {
        const float by_chance_m = point_sd_m * static_cast<float>(noise.normal());
        latency.compare({above_m + by_chance_m, point_sd_m * point_sd_m, 0.0f, {growth, -map_growth}, farther_m});
      }
      map_offset_s += latency.end_line(rate).later_s.last;
    }
    ground_before_s = map_offset_s;
    map_lag_s = lag_s;
    map_offset_s = latency.offset_s();
  }

  bool drives;
  float lean_rad = 0.0f;  ///< unknown lean of the mount: ground farther away seems higher, or lower
  TiltLatency latency;
  test::Noise noise{3};
  int sweeps = 0;
  float map_lag_s = 0.0f, map_offset_s = 0.0f;  ///< of the mapped ground: the servo's latency, and the offset used
  float ground_before_s = 0.0f;                 ///< the final offset of the ground before the last sweep
};

TEST_CASE("tilt latency: the first turn tells it, and what was mapped before is mended") {
  const bool drives = GENERATE(false, true);
  const float lag_s = GENERATE(-0.015f, 0.006f, 0.02f);
  Sweeps robot(drives);
  robot.sweep(lag_s);
  CHECK(robot.latency.offset_s() == 0.0f);
  robot.sweep(lag_s);
  CHECK(robot.latency.offset_s() == Approx(lag_s).margin(drives ? 0.003 : 0.001));
  CHECK(std::abs(robot.latency.offset_s() - lag_s) < 3.0f * robot.latency.sd_s());
  CHECK(robot.ground_before_s == Approx(lag_s).margin(drives ? 0.003 : 0.001));
  CHECK(robot.latency.mended_s() == Approx(robot.ground_before_s));
}

TEST_CASE("tilt latency: on a drive many sweeps know it better than one, and what is known does not wander") {
  Sweeps drive(true);
  for (int k = 0; k < 2; ++k) drive.sweep(0.006f);
  const float of_two_s = drive.latency.sd_s();
  for (int k = 0; k < 100; ++k) {
    drive.sweep(0.006f);
    CHECK(drive.latency.offset_s() == Approx(0.006f).margin(0.0025));
  }
  CHECK(drive.latency.sd_s() < of_two_s);
}

TEST_CASE("tilt latency: on a drive ground that both directions have seen is about as uncertain as that of the last") {
  Sweeps drive(true);
  for (int k = 0; k < 6; ++k) drive.sweep(0.006f);
  const float of_last_m2 = drive.latency.height_variance_m2({0.0f, 1.0f, 0.0f});
  CHECK(drive.latency.height_variance_m2({0.0f, 0.5f, -0.5f}) > 0.4f * of_last_m2);
  CHECK(drive.latency.height_variance_m2({0.0f, 0.5f, 0.5f}) < 0.4f * of_last_m2);  // as if both were equally late
}

TEST_CASE("tilt latency: how fast the last two sweeps were, upward and downward ones each") {
  TiltLatency latency = started();
  const auto sweep_at = [&](float rate) {  // over 0.75 rad; the turn takes a line more to tell
    const float first_rad = rate > 0.0f ? 0.2f : 0.95f, step_rad = 0.025f * rate;
    for (int line = 0; static_cast<float>(line) * std::abs(step_rad) < 0.74f; ++line)
      latency.begin_line(first_rad + step_rad * static_cast<float>(line), rate, next_reading());
  };
  sweep_at(1.0f);
  CHECK(latency.sweep_rates().last_rad_s == -1.0f);  // as if there had been one
  CHECK(latency.sweep_rates().this_share == 0.5f);
  sweep_at(-3.0f);
  CHECK(latency.sweep_rates().last_rad_s == Approx(1.0).margin(0.2));
  CHECK(latency.sweep_rates().this_share == 0.5f);
  sweep_at(1.0f);
  CHECK(latency.sweep_rates().last_rad_s == Approx(-3.0).margin(0.5));
  CHECK(latency.sweep_rates().this_share == Approx(0.25).margin(0.02));
  sweep_at(-3.0f);
  CHECK(latency.sweep_rates().this_share == Approx(0.75).margin(0.02));
}

TEST_CASE("tilt latency: on a drive it follows from sweep to sweep") {
  Sweeps drive(true);
  test::Noise lot(7);
  float missing_s2 = 0.0f, apart_s2 = 0.0f;
  for (int k = 0; k < 100; ++k) {
    const float lag_s = 0.006f + 0.003f * static_cast<float>(lot.normal()), before_s = drive.map_lag_s;
    drive.sweep(lag_s);
    if (k < 2) continue;
    const float missing_s = lag_s - drive.latency.offset_s(), ground_missing_s = before_s - drive.ground_before_s;
    missing_s2 += missing_s * missing_s / 98.0f;
    apart_s2 += (missing_s + ground_missing_s) * (missing_s + ground_missing_s) / 98.0f;
  }
  CHECK(std::sqrt(missing_s2) < 0.002f);
  CHECK(std::sqrt(apart_s2) < 0.001f);  // the tear in the ground that both have seen
}

TEST_CASE("tilt latency: a mount that leans by a milliradian is none of the servo's latency") {
  Sweeps drive(true);
  drive.lean_rad = GENERATE(-0.001f, 0.001f);
  for (int k = 0; k < 20; ++k) {
    drive.sweep(0.006f);
    if (k > 4) CHECK(drive.latency.usual().offset_s == Approx(0.006f).margin(0.001));
  }
}

TEST_CASE(
    "tilt latency: on a drive a laser that leans by half a degree is found, and none of it is the servo's latency") {
  Sweeps drive(true);
  drive.lean_rad = GENERATE(-0.009f, 0.009f);
  for (int k = 0; k < 20; ++k) {
    drive.sweep(0.006f);
    if (k < 3) continue;
    CHECK(drive.latency.lean_rad() == Approx(drive.lean_rad).margin(0.002));
    CHECK(drive.latency.usual().offset_s == Approx(0.006f).margin(0.001));
  }
  CHECK(drive.latency.steps() == 0);
}

TEST_CASE("tilt latency: a lean that may be chance is not taken off") {
  const bool drives = GENERATE(false, true);
  Sweeps robot(drives);
  for (int k = 0; k < 100; ++k) robot.sweep(0.006f);
  CHECK(robot.latency.lean_rad() == 0.0f);
}

TEST_CASE("tilt latency: a lean that is taken off leaves offsets within five standard deviations") {
  Sweeps drive(true);
  for (int k = 0; k < 100; ++k) {
    drive.lean_rad += 0.002f;
    drive.sweep(0.0f);
    CHECK(std::abs(drive.latency.offset_s()) <= 0.05f);
  }
  CHECK(drive.latency.lean_rad() > 0.01f);
  CHECK(drive.latency.lean_rad() <= 0.025f);
}

TEST_CASE("tilt latency: how late a servo is in all is told as well as its deviation says") {
  const bool drives = GENERATE(false, true);
  const int sweeps = GENERATE(2, 3, 4, 9);
  test::Noise lot(11);
  float missing_sd2 = 0.0f;
  constexpr int robots = 60;
  for (int robot = 0; robot < robots; ++robot) {
    Sweeps run(drives);
    const float lag_s = 0.005f * static_cast<float>(lot.normal());
    for (int k = 0; k < sweeps; ++k) run.sweep(lag_s + 0.002f * static_cast<float>(lot.normal()));
    const TiltLatency::Usual told = run.latency.usual();
    missing_sd2 += (told.offset_s - lag_s) * (told.offset_s - lag_s) / (told.sd_s * told.sd_s) / robots;
  }
  INFO((drives ? "drives, " : "stands, ") << sweeps << " sweeps: (error / sd)^2 " << missing_sd2);
  CHECK(missing_sd2 > 0.4f);
  CHECK(missing_sd2 < 2.5f);
}

TEST_CASE(
    "tilt latency: how late a servo is in all is not known before the first turn, and exactly if it was said so") {
  Sweeps robot(GENERATE(false, true));
  robot.sweep(0.006f);
  CHECK(robot.latency.usual().offset_s == 0.0f);
  CHECK(robot.latency.usual().sd_s >= 0.01f);
  TiltSettings exact = tilt_settings();
  exact.latency_sd_s = 0.0f;
  robot.latency.init(exact, {});
  for (int k = 0; k < 3; ++k) robot.sweep(0.0f);
  CHECK(robot.latency.usual().offset_s == 0.0f);
  CHECK(robot.latency.usual().sd_s == 0.0f);
}

TEST_CASE("tilt latency: while a drive learns how late a servo has become its deviation says so") {
  Sweeps robot(true);
  for (int k = 0; k < 8; ++k) robot.sweep(0.004f);
  CHECK(robot.latency.usual().sd_s < 0.002f);
  robot.sweep(0.016f);
  for (int k = 0; k < 12; ++k) {
    robot.sweep(0.016f);
    const TiltLatency::Usual told = robot.latency.usual();
    CHECK(std::abs(told.offset_s - 0.016f) < 3.0f * told.sd_s);
  }
}

TEST_CASE("tilt latency: a step, however well the latency before was known, is followed") {
  const bool drives = GENERATE(false, true);
  const float step_s = GENERATE(-0.020f, 0.015f, 0.030f, 0.045f);
  Sweeps robot(drives);
  for (int k = 0; k < 40; ++k) robot.sweep(0.002f);
  REQUIRE(robot.latency.steps() == 0);
  for (int k = 0; k < 6; ++k) robot.sweep(0.002f + step_s);
  CHECK(robot.latency.offset_s() == Approx(0.002f + step_s).margin(0.003));
  for (int k = 0; k < 6; ++k) robot.sweep(0.002f);
  CHECK(robot.latency.offset_s() == Approx(0.002f).margin(0.003));
}

TEST_CASE("tilt latency: what lies off the ground, each line by another height, is no step") {
  Sweeps robot(true);
  for (int k = 0; k < 20; ++k) robot.sweep(0.002f);
  const float before_s = robot.latency.offset_s(), sd_s = robot.latency.sd_s();
  for (int line = 0; line < 200; ++line) {
    const float above_m = line % 2 == 0 ? 0.04f : -0.04f;
    for (int point = 0; point < 20; ++point) robot.latency.compare({above_m, 1e-4f, 0.0f, {1.0f, 1.0f}});
    robot.latency.end_line(rate_rad_s);
  }
  CHECK(robot.latency.steps() == 0);
  CHECK(robot.latency.offset_s() == before_s);
  CHECK(robot.latency.sd_s() == sd_s);
}

TEST_CASE("tilt latency: ground of which the slope is not known says little") {
  const float slope_sd = GENERATE(0.0f, 0.02f);
  TiltLatency latency = started();
  latency.begin_line(0.2f, rate_rad_s, next_reading());
  latency.begin_line(1.2f, -rate_rad_s, next_reading());
  const float rise_m = 0.05f * slope_sd;  // all points lie five centimetres beyond the ground's middle
  for (int point = 0; point < 100; ++point) latency.compare({rise_m, 1e-4f, rise_m * rise_m, {-0.05f}});
  latency.end_line(-rate_rad_s);
  CHECK(latency.offset_s() == Approx(0.0f).margin(0.006));
  if (slope_sd > 0.0f) CHECK(latency.sd_s() > 0.009f);
}

TEST_CASE("tilt latency: another surface in a fifth of the points does not move it") {
  TiltLatency latency = started();
  test::Noise noise(4);
  sweep(latency, false, 0.005f, noise, 0.15f);
  CHECK(latency.offset_s() == Approx(0.005f).margin(0.001));
}

TEST_CASE("tilt latency: a line that disagrees by more than latency can explain is left out") {
  TiltLatency latency = started();
  for (int point = 0; point < 100; ++point) latency.compare({0.03f, 1e-4f, 0.0f, {0.05f}});  // 0.6 s
  latency.end_line(rate_rad_s);
  CHECK(latency.offset_s() == 0.0f);
  CHECK(latency.sd_s() == Approx(0.01f));
}

TEST_CASE("tilt latency: it stays within five standard deviations, whatever is seen") {
  TiltLatency latency = started();
  test::Noise noise(6);
  for (int k = 0; k < 10; ++k) sweep(latency, k % 2 == 0, latency.offset_s() + 0.02f, noise);
  CHECK(latency.offset_s() == Approx(0.05f));
  CHECK(latency.latest_offset_s() == Approx(0.05f));
}

TEST_CASE("tilt latency: a line whose growths cancel each other tells nothing") {
  TiltLatency latency = started();
  for (const float growth : {1.0f, -1.0f}) latency.compare({0.01f * growth, 1e-4f, 0.0f, {growth}});
  latency.end_line(rate_rad_s);
  CHECK(latency.offset_s() == 0.0f);
  CHECK(latency.sd_s() == Approx(0.01f));
}

TEST_CASE("tilt latency: after a line whose growths cancel each other the next ones tell as before") {
  const bool drives = GENERATE(false, true);
  Sweeps undisturbed(drives), robot(drives);
  for (Sweeps* run : {&undisturbed, &robot}) run->sweep(0.006f);
  for (const float growth : {1.0f, -1.0f})
    robot.latency.compare({0.0f, 1e-4f, 1e-4f, {growth}});  // the slope is unsure
  robot.latency.end_line(rate_rad_s);
  for (Sweeps* run : {&undisturbed, &robot}) run->sweep(0.006f);
  CHECK(robot.latency.offset_s() == undisturbed.latency.offset_s());
  CHECK(robot.latency.sd_s() == undisturbed.latency.sd_s());
}

TEST_CASE("tilt latency: a growth that no servo makes does not move it") {
  TiltLatency latency = started();
  test::Noise noise(8);
  sweep(latency, true, 0.005f, noise);
  const float before_s = latency.offset_s();
  for (const float growth : {190.0f, -190.0f, std::numeric_limits<float>::quiet_NaN()}) {
    latency.compare({0.01f, point_sd_m * point_sd_m, 0.0f, {growth}});
    latency.end_line(rate_rad_s);
    CHECK(latency.offset_s() == before_s);
  }
}

TEST_CASE("tilt latency: the first sweep is not a new one, a turn begins one when two lines in a row show it") {
  TiltLatency latency = started();
  CHECK(latency.begin_line(0.20f, rate_rad_s, next_reading()) == Turn::none);
  CHECK(latency.begin_line(0.60f, rate_rad_s, next_reading()) == Turn::none);
  CHECK(latency.begin_line(0.61f, -rate_rad_s, next_reading()) == Turn::none);
  CHECK(latency.begin_line(0.60f, -rate_rad_s, next_reading()) == Turn::new_sweep);
  CHECK(latency.begin_line(0.30f, -rate_rad_s, next_reading()) == Turn::none);
  CHECK(latency.begin_line(0.30f, rate_rad_s, next_reading()) == Turn::none);
  CHECK(latency.begin_line(0.31f, rate_rad_s, next_reading()) == Turn::new_sweep);
}

TEST_CASE("tilt latency: a damaged reading, by which one line goes the other way, turns nothing round") {
  TiltLatency latency = started();
  for (int line = 0; line < 40; ++line) {
    const float angle_rad = 0.2f + 0.02f * static_cast<float>(line);
    const bool damaged = line % 4 == 2;
    CHECK(latency.begin_line(damaged ? angle_rad + 0.5f : angle_rad, damaged ? -50.0f : rate_rad_s, next_reading()) ==
          Turn::none);
  }
}

TEST_CASE("tilt latency: where readings come more slowly than lines a damaged one turns nothing round either") {
  TiltLatency latency = started();
  latency.begin_line(0.20f, rate_rad_s, 1);
  for (int line = 0; line < 3; ++line) CHECK(latency.begin_line(0.60f, -50.0f, 2) == Turn::none);
  CHECK(latency.begin_line(0.62f, rate_rad_s, 3) == Turn::none);
  for (int line = 0; line < 3; ++line) CHECK(latency.begin_line(0.61f, -rate_rad_s, 4) == Turn::none);
  CHECK(latency.begin_line(0.60f, -rate_rad_s, 5) == Turn::new_sweep);
}

TEST_CASE("tilt latency: a servo that is too slow, or too coarse, for its rate to tell turns where its angle does") {
  TiltLatency latency = started();
  const float slow_rad_s = GENERATE(0.01f, -0.01f);  // of the wrong sign, too: the angle's noise decides
  const auto angle_rad = [](int line) {              // a triangle from 0.2 to 1.0 rad
    const int at = line % 160;
    return 0.2f + 0.01f * static_cast<float>(at < 80 ? at : 160 - at) + (line % 2 == 0 ? 0.01f : 0.0f);
  };
  int sweeps = 0;
  for (int line = 0; line < 480; ++line) {
    sweeps += latency.begin_line(angle_rad(line), slow_rad_s, next_reading()) == Turn::new_sweep;
  }
  CHECK(sweeps == (slow_rad_s > 0.0f ? 5 : 6));  // the first begins in the wrong direction
}

TEST_CASE("tilt latency: play of a servo where a sweep begins is no sweep") {
  TiltLatency latency = started();
  latency.begin_line(0.20f, rate_rad_s, next_reading());
  latency.begin_line(0.60f, -rate_rad_s, next_reading());
  REQUIRE(latency.begin_line(0.60f, -rate_rad_s, next_reading()) == Turn::new_sweep);
  CHECK(latency.begin_line(0.60f, rate_rad_s, next_reading()) == Turn::none);
  CHECK(latency.begin_line(0.61f, rate_rad_s, next_reading()) == Turn::back);
  CHECK(latency.begin_line(0.61f, -rate_rad_s, next_reading()) == Turn::none);
  CHECK(latency.begin_line(0.60f, -rate_rad_s, next_reading()) == Turn::back);
}

TEST_CASE("tilt latency: a servo that stands still turns nowhere") {
  TiltLatency latency = started();
  latency.begin_line(0.5f, rate_rad_s, next_reading());
  for (const float rate : {1e-3f, -1e-3f, 0.0f, -0.02f})
    CHECK(latency.begin_line(1.0f, rate, next_reading()) == Turn::none);
}

TEST_CASE("tilt latency: small errors of the map do not add up while a robot stands for hours") {
  constexpr float by_sweep_s = 2e-6f;  // measured: 1.8 ms in an hour
  TiltLatency latency = started();
  test::Noise noise(15);
  float lean_s = 0.0f;  // of the ground: it grows by so much with the growth of a downward sweep's points
  for (int k = 0; k < 3000; ++k) {
    const bool downward = k % 2 == 1;
    const float rate = downward ? rate_rad_s : -rate_rad_s, growth = rate * range_m;
    for (int line = 0; line < 40; ++line) {
      const float advance = 0.025f * static_cast<float>(line);
      latency.begin_line(downward ? 0.2f + advance : 1.2f - advance, rate, next_reading());
      const float above_m = growth * latency.offset_s() - std::abs(growth) * lean_s;
      for (int point = 0; point < 20 && k > 0; ++point) {
        const float by_chance_m = point_sd_m * static_cast<float>(noise.normal());
        latency.compare({above_m + by_chance_m, square(point_sd_m), 0.0f, {growth, 0.5f * growth, -0.5f * growth}});
      }
      const BySweep later_s = latency.end_line(rate).later_s;
      lean_s += (downward ? 0.5f : -0.5f) * (later_s.before - later_s.last);
    }
    lean_s += by_sweep_s;
  }
  CHECK(std::abs(lean_s) < 0.0005f);
  CHECK(std::abs(latency.offset_s()) < 0.0005f);
}

TEST_CASE("tilt latency: while a laser that stands sees nothing its servo is as uncertain as at first, and no more") {
  TiltLatency latency = started();
  test::Noise noise(14);
  for (int k = 0; k < 4; ++k) sweep(latency, k % 2 == 0, 0.004f, noise);
  for (int k = 0; k < 1000; ++k) {
    const bool downward = k % 2 == 0;
    for (int line = 0; line < 40; ++line) {
      const float advance = 0.025f * static_cast<float>(line), rate = downward ? rate_rad_s : -rate_rad_s;
      latency.begin_line(downward ? 0.2f + advance : 1.2f - advance, rate, next_reading());
      latency.end_line(rate);
    }
  }
  CHECK(latency.sd_s() <= Approx(std::sqrt(2.0f) * tilt_settings().latency_sd_s));
  CHECK(latency.sd_s() >= Approx(tilt_settings().latency_sd_s));
}

TEST_CASE("tilt latency: a standard deviation of 0 turns it off") {
  TiltSettings tilt = tilt_settings();
  tilt.latency_sd_s = 0.0f;
  TiltLatency latency;
  latency.init(tilt, {});
  test::Noise noise(5);
  sweep(latency, false, 0.002f, noise);
  CHECK(latency.offset_s() == 0.0f);
}

TEST_CASE("tilt latency: a line waits for its tilt as long as the later of this sweep and the next may be") {
  TiltLatency latency = started();
  test::Noise noise(5);
  CHECK(latency.latest_offset_s() == 0.0f);
  for (int k = 0; k < 3; ++k) {
    sweep(latency, true, -0.004f, noise);
    if (k > 0) CHECK(latency.latest_offset_s() == Approx(0.02).margin(0.0015));
    sweep(latency, false, 0.02f, noise);
    CHECK(latency.latest_offset_s() == Approx(0.02).margin(0.0015));
  }
  Sweeps drive{true};  // here the next sweep's latency is nearly that of all
  for (int k = 0; k < 12; ++k) {
    drive.sweep(0.012f);
    CHECK(drive.latency.latest_offset_s() >= drive.latency.offset_s());
  }
  drive.sweep(0.009f);
  CHECK(drive.latency.offset_s() < 0.0105f);
  CHECK(drive.latency.latest_offset_s() > drive.latency.offset_s() + 0.0005f);
}

}  // namespace
}  // namespace curbline
