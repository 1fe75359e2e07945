// Beams to points: against the chain of transforms in double precision, and their variance against simulated errors.
#include "curbline/intake/line_projection.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "curbline/intake/tilt_track.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

using test::Noise;

constexpr Limits limits{.beams = 361, .tilt_samples = 16};
constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t t0 = 1'290'682'980'000'000'000;

/// A projection with everything that it needs.
struct Bench {
  explicit Bench(const Settings& s) : settings(s) {
    projection.init(s);
    track.init(s.tilt);
  }
  std::vector<Point> project(const std::vector<float>& ranges, std::int64_t time_ns = t0) {
    std::vector<Point> points;
    track.snapshot(snapshot, 0.0f, INT64_MAX);
    ProjectedLine<limits> line;
    projection.project({time_ns, ranges}, snapshot, motion, bounds, counters, line);
    for (const Point& p : line.points()) points.push_back(p);
    outside = line.outside();
    return points;
  }

  Settings settings;
  LineProjection<limits> projection{};
  TiltTrack<limits> track{};
  TiltSnapshot<limits> snapshot{};
  LineMotion motion{};
  Bounds bounds{-1e3f, -1e3f, 1e3f, 1e3f, 1e3f};
  Counters counters{};
  std::uint32_t outside = 0;  ///< of the last line
};

Settings base_settings() {
  Settings s;
  s.laser.beams = 361;
  s.laser.first_bearing_rad = -1.5707963f;
  s.laser.bearing_step_rad = 3.1415927f / 360.0f;
  return s;
}

Eigen::Isometry3d transform(double x, double y, double z, double roll, double pitch, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(Eigen::Vector3d(x, y, z));
  T.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  T.rotate(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()));
  T.rotate(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()));
  return T;
}

Eigen::Isometry3d transform(const MountSettings& m) {
  return transform(m.x_m, m.y_m, m.z_m, m.roll_rad, m.pitch_rad, m.yaw_rad);
}

/// p_base = T_base_tilt R_y(tilt) T_tilt_laser p_laser, in double precision.
Eigen::Vector3d in_base(const Settings& s, double range, double bearing, double tilt) {
  const Eigen::Vector3d p_laser(range * std::cos(bearing), range * std::sin(bearing), 0.0);
  return transform(s.tilt.T_base_tilt) *
         (Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()) * (transform(s.tilt.T_tilt_laser) * p_laser));
}

double bearing_of(const Settings& s, std::size_t beam) {
  return static_cast<double>(s.laser.first_bearing_rad) +
         static_cast<double>(beam) * static_cast<double>(s.laser.bearing_step_rad);
}

MountSettings any_mount(Noise& noise) {
  const auto within = [&](double bound) { return static_cast<float>(bound * (2.0 * noise.uniform() - 1.0)); };
  return {within(1.0), within(1.0), within(1.0), within(3.0), within(1.5), within(3.0)};
}

double distance(const Point& p, const Eigen::Vector3d& truth) {
  return (Eigen::Vector3d(p.x_m, p.y_m, p.z_m) - truth).norm();
}

TEST_CASE("line projection: any mount, tilt and bearing give the point of the chain of transforms") {
  Noise noise;
  for (int trial = 0; trial < 50; ++trial) {
    Settings s = base_settings();
    s.tilt.T_base_tilt = any_mount(noise);
    s.tilt.T_tilt_laser = any_mount(noise);
    s.tilt.fixed = true;
    s.tilt.fixed_tilt_rad = static_cast<float>(3.0 * (2.0 * noise.uniform() - 1.0));
    s.laser.bearing_step_rad *= trial % 2 == 0 ? 1.0f : -1.0f;
    const auto bench = std::make_unique<Bench>(s);
    std::vector<float> ranges(361);
    for (float& r : ranges) r = static_cast<float>(0.2 + 9.0 * noise.uniform());
    bench->project(ranges);  // an isolated echo is left out once
    const auto points = bench->project(ranges);
    REQUIRE(points.size() == 361);
    for (std::size_t i = 0; i < points.size(); ++i) {
      CHECK(distance(points[i], in_base(s, ranges[i], bearing_of(s, i), s.tilt.fixed_tilt_rad)) < 1e-5);
    }
  }
}

TEST_CASE("line projection: the mount of the data set's robot looks down for a positive tilt") {
  Settings s = base_settings();
  s.tilt.T_base_tilt.z_m = 0.22f;
  s.tilt.T_tilt_laser.z_m = 0.04f;
  s.tilt.fixed = true;
  s.tilt.fixed_tilt_rad = 0.5f;
  const auto bench = std::make_unique<Bench>(s);
  const auto points = bench->project(std::vector<float>(361, 2.0f));
  CHECK(points[180].x_m == Approx(2.0 * std::cos(0.5) + 0.04 * std::sin(0.5)));
  CHECK(points[180].y_m == Approx(0.0).margin(1e-6));
  CHECK(points[180].z_m == Approx(0.22 - 2.0 * std::sin(0.5) + 0.04 * std::cos(0.5)));
  CHECK(points[360].y_m == Approx(2.0));  // the last beam looks left
}

TEST_CASE("line projection: each beam has the tilt of its own time") {
  Settings s = base_settings();
  s.laser.beam_interval_s = 50e-6f;
  const auto bench = std::make_unique<Bench>(s);
  for (int k = 0; k < 4; ++k) bench->track.push({t0 + 10 * ms * k, 0.1f + 0.01f * static_cast<float>(k)});
  const std::vector<float> ranges(361, 3.0f);
  const auto points = bench->project(ranges, t0 + 5 * ms);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double tilt = 0.1 + 1.0 * (0.005 + 50e-6 * static_cast<double>(i));  // 1 rad/s
    CHECK(distance(points[i], in_base(s, 3.0, bearing_of(s, i), tilt)) < 1e-5);
  }
  CHECK(bench->counters.beams_extrapolated == 0);
}

TEST_CASE(
    "line projection: beams past the newest tilt are extrapolated and counted, further ones dropped and counted") {
  Settings s = base_settings();
  s.laser.beam_interval_s = 50e-6f;
  s.tilt.max_extrapolation_s = 0.010f;
  const auto bench = std::make_unique<Bench>(s);
  bench->track.push({t0 - 5 * ms, 0.1f});
  bench->track.push({t0 + 5 * ms, 0.1f});
  const auto points = bench->project(std::vector<float>(361, 3.0f));
  // Beam 100 is at 5 ms, beam 300 at 15 ms.
  CHECK(points.size() == 301);
  CHECK(bench->counters.beams_extrapolated == 200);
  CHECK(bench->counters.beams_without_tilt == 60);
}

TEST_CASE("line projection: a beam's point goes where the beams beside it have it, if they see the same surface") {
  Settings s = base_settings();
  s.tilt.fixed = true;
  s.tilt.fixed_tilt_rad = 0.5f;
  s.laser.range_sd_m = 0.01f;
  const auto bench = std::make_unique<Bench>(s);
  std::vector<float> ranges(361, 3.0f);
  ranges[180] = 3.03f;                                                          // by chance
  ranges[100] = 3.05f;                                                          // by more than chance: something else
  for (int i = 250; i < 361; ++i) ranges[static_cast<std::size_t>(i)] = 3.05f;  // another surface
  ranges[20] = std::numeric_limits<float>::quiet_NaN();
  bench->project(ranges);  // an isolated echo is left out once
  const auto points = bench->project(ranges);
  REQUIRE(points.size() == 360);
  const auto shift_m = [&](std::size_t beam) {
    const Point& p = points[beam > 20 ? beam - 1 : beam];
    const double along = std::hypot(p.shift_x_m, p.shift_y_m) / std::hypot(p.x_m, p.y_m) * 3.0;
    return p.shift_x_m * p.x_m + p.shift_y_m * p.y_m < 0.0f ? -along : along;
  };
  CHECK(shift_m(180) == Approx(-0.03).margin(5e-4));
  CHECK(shift_m(179) == Approx(0.015).margin(5e-4));
  for (const std::size_t alone : {100u, 99u, 101u, 249u, 250u, 0u, 360u, 19u, 21u}) CHECK(shift_m(alone) == 0.0);
}

/// Lines of a laser with noise of 10 mm that looks at a wall all around.
struct Alone {
  Alone() : bench(settings()) {}
  static Settings settings() {
    Settings s = base_settings();
    s.tilt.fixed = true;
    s.laser.max_range_m = 30.0f;
    s.laser.range_sd_m = 0.01f;
    return s;
  }
  /// Projects a line of level ranges except for the given beams. Is the beam's point kept?
  bool kept(std::size_t beam, std::initializer_list<std::pair<std::size_t, float>> others) {
    std::vector<float> ranges(361, 3.0f);
    for (const auto& [i, range_m] : others) ranges[i] = range_m;
    const double bearing = bearing_of(bench.settings, beam);
    for (const Point& p : bench.project(ranges)) {
      if (std::abs(std::atan2(p.y_m, p.x_m) - bearing) < 1e-3) return true;
    }
    return false;
  }

  Bench bench;
};

TEST_CASE("line projection: a drop of rain, dust or a flash of the sun, in a single beam, is left out and counted") {
  const auto alone = std::make_unique<Alone>();
  const float range_m = GENERATE(0.3f, 2.9f, 3.1f, 20.0f);
  CHECK(alone->kept(100, {}));
  CHECK_FALSE(alone->kept(100, {{100, range_m}}));
  CHECK(alone->bench.counters.echoes_alone == 1);
  CHECK(alone->kept(100, {}));  // nothing of it remains
  CHECK_FALSE(alone->kept(100, {{100, range_m}}));
  CHECK(alone->bench.counters.echoes_alone == 2);
}

TEST_CASE("line projection: what stood alone in a longer line before the last is forgotten") {
  const auto alone = std::make_unique<Alone>();
  CHECK_FALSE(alone->kept(300, {{300, 1.5f}}));
  alone->bench.project(std::vector<float>(100, 3.0f));
  CHECK_FALSE(alone->kept(300, {{300, 1.5f}}));
}

TEST_CASE("line projection: a post that is as wide as a beam loses no more than its first line") {
  const auto alone = std::make_unique<Alone>();
  CHECK_FALSE(alone->kept(100, {{100, 1.5f}}));
  for (int line = 0; line < 5; ++line) CHECK(alone->kept(100, {{100, 1.5f}}));
  CHECK(alone->bench.counters.echoes_alone == 1);
}

TEST_CASE("line projection: what two beams see, chance, an edge, and what stands before the sky are not left out") {
  const auto alone = std::make_unique<Alone>();
  CHECK(alone->kept(100, {{100, 1.5f}, {101, 1.5f}}));
  CHECK(alone->kept(100, {{100, 3.04f}}));
  CHECK(alone->kept(100, {{98, 2.0f}, {99, 2.0f}, {100, 2.5f}}));
  CHECK(alone->kept(100, {{99, 30.0f}, {100, 1.5f}, {101, 30.0f}}));
  CHECK(alone->kept(100, {{99, std::numeric_limits<float>::quiet_NaN()}, {100, 1.5f}}));
  CHECK(alone->kept(0, {{0, 1.5f}}));
  CHECK(alone->kept(360, {{360, 1.5f}}));
  CHECK(alone->bench.counters.echoes_alone == 0);
}

TEST_CASE("line projection: where the ground ceases to be seen the points of a cell are not all too high") {
  // Straight ahead, 70 degrees down from 1.2 m: the ground is seen just beyond a cell's border, from where noise moves
  // one point in a hundred into the cell before.
  Settings s = base_settings();
  s.laser.range_sd_m = 0.012f;
  s.laser.bearing_step_rad = 1e-4f;
  s.laser.first_bearing_rad = -0.018f;
  s.tilt.T_base_tilt.z_m = 1.2f;
  s.tilt.fixed = true;
  s.tilt.fixed_tilt_rad = 1.22f;
  const auto bench = std::make_unique<Bench>(s);
  Noise noise(5);
  const double seen_m = 1.2 / std::sin(1.22), border_m = seen_m * std::cos(1.22) - 0.006;
  double own_m = 0.0, beside_m = 0.0;
  int own = 0, beside = 0;
  for (int line = 0; line < 200; ++line) {
    std::vector<float> ranges(361);
    for (float& r : ranges) r = static_cast<float>(seen_m + 0.012 * noise.normal());
    for (const Point& p : bench->project(ranges)) {
      if (p.x_m < border_m) own_m += p.z_m, ++own;
      if (p.x_m + p.shift_x_m < border_m) beside_m += p.z_m, ++beside;
    }
  }
  REQUIRE(own > 500);
  REQUIRE(beside > 500);
  CHECK(own_m / own > 0.015);
  CHECK(std::abs(beside_m / beside) < 0.004);
}

TEST_CASE("line projection: NaN, infinity and readings out of range are no returns") {
  Settings s = base_settings();
  s.tilt.fixed = true;
  s.laser.min_range_m = 0.1f;
  s.laser.max_range_m = 30.0f;
  const auto bench = std::make_unique<Bench>(s);
  const float inf = std::numeric_limits<float>::infinity();
  const auto points = bench->project(
      {std::numeric_limits<float>::quiet_NaN(), inf, -inf, 0.0f, -1.0f, 0.0999f, 30.0f, 65.0f, 0.1f, 29.99f});
  CHECK(points.size() == 2);
  CHECK(bench->counters.no_returns == 8);
}

TEST_CASE("line projection: a line without beams is no trouble") {
  const auto bench = std::make_unique<Bench>(base_settings());
  CHECK(bench->project({}).empty());
}

TEST_CASE("line projection: while the robot moves each beam starts from the pose of its own time") {
  Settings s = base_settings();
  s.tilt.fixed = true;
  s.tilt.fixed_tilt_rad = 0.4f;
  s.tilt.T_base_tilt = {0.3f, 0.1f, 0.9f, 0.02f, -0.03f, 0.1f};
  const auto bench = std::make_unique<Bench>(s);
  // From (4, -2) with heading 30 deg to 5 cm farther on with heading 31 deg.
  const Eigen::Quaterniond q0(Eigen::AngleAxisd(0.5236, Eigen::Vector3d::UnitZ())),
      q1(Eigen::AngleAxisd(0.5411, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d c0(4.0, -2.0, 0.1), c1(4.043, -1.975, 0.11);
  const auto pose = [](const Eigen::Vector3d& c, const Eigen::Quaterniond& q) {
    const Eigen::Vector3f p = c.cast<float>();
    const Eigen::Quaternionf f = q.cast<float>();
    return Pose{t0, p.x(), p.y(), p.z(), f.x(), f.y(), f.z(), f.w()};
  };
  bench->motion = {make_transform(pose(c0, q0)), make_transform(pose(c1, q1)), false};
  const auto points = bench->project(std::vector<float>(361, 5.0f));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double share = static_cast<double>(i) / 360.0;
    const Eigen::Vector3d truth = q0.slerp(share, q1) * in_base(s, 5.0, bearing_of(s, i), 0.4) + c0 + share * (c1 - c0);
    CHECK(distance(points[i], truth) < 5.5 * 0.0175 * 0.0175 / 8.0 + 1e-5);  // (turn)^2 / 8 of the range
  }
}

/// Variance of a beam's height over 20000 draws of all errors that the settings name.
double simulated_variance(const Settings& s, std::size_t beam, double range, double tilt, double rate) {
  Noise noise(3);
  const int trials = 20000;
  double sum = 0.0, sum2 = 0.0;
  for (int k = 0; k < trials; ++k) {
    const double r = range + static_cast<double>(s.laser.range_sd_m) * noise.normal();
    const double b = bearing_of(s, beam) + static_cast<double>(s.laser.bearing_sd_rad) * noise.normal();
    const double t = tilt + static_cast<double>(s.tilt.angle_sd_rad) * noise.normal() +
                     rate * static_cast<double>(s.tilt.time_sd_s) * noise.normal();
    const double roll = static_cast<double>(s.tilt.roll_sd_rad) * noise.normal();
    const double pitch = static_cast<double>(s.tilt.pitch_sd_rad) * noise.normal();
    const double pose_roll = static_cast<double>(s.pose.attitude_sd_rad) * noise.normal();
    const double pose_pitch = static_cast<double>(s.pose.attitude_sd_rad) * noise.normal();
    const Eigen::Vector3d mount(s.tilt.T_base_tilt.x_m, s.tilt.T_base_tilt.y_m, s.tilt.T_base_tilt.z_m);
    const Eigen::Vector3d about_mount = transform(0, 0, 0, roll, pitch, 0) * (in_base(s, r, b, t) - mount) + mount;
    const Eigen::Vector3d p = transform(0, 0, 0, pose_roll, pose_pitch, 0) * about_mount;
    const double z = p.z() + static_cast<double>(s.pose.height_sd_m) * noise.normal();
    sum += z;
    sum2 += z * z;
  }
  return sum2 / trials - sum / trials * sum / trials;
}

/// Errors of one kind at a time, finally all together.
Settings with_errors(int kind) {
  Settings s = base_settings();
  s.tilt.T_base_tilt = {0.3f, -0.2f, 0.9f, 0.05f, 0.1f, 0.2f};
  s.tilt.T_tilt_laser = {0.05f, 0.0f, 0.04f, 0.1f, 0.05f, 0.0f};
  const auto when = [&](int k, float sd) { return kind == k || kind == 8 ? sd : 0.0f; };
  s.laser.range_sd_m = when(0, 0.02f);
  s.laser.bearing_sd_rad = when(1, 0.003f);
  s.tilt.angle_sd_rad = when(2, 0.003f);
  s.tilt.time_sd_s = when(3, 0.004f);
  s.tilt.roll_sd_rad = when(4, 0.004f);
  s.tilt.pitch_sd_rad = when(5, 0.004f);
  s.pose.attitude_sd_rad = when(6, 0.004f);
  s.pose.height_sd_m = when(7, 0.01f);
  return s;
}

TEST_CASE("line projection: the variance of a height is that of simulated errors, to a tenth") {
  const int kind = GENERATE(range(0, 9));
  const std::size_t beam = GENERATE(40u, 150u, 300u);
  const Settings s = with_errors(kind);
  const auto bench = std::make_unique<Bench>(s);
  bench->track.push({t0 - 50 * ms, 0.45f - 0.04f});
  bench->track.push({t0 + 50 * ms, 0.45f + 0.04f});
  std::vector<float> ranges(361, 0.0f);
  ranges[beam] = 2.5f;
  const auto points = bench->project(ranges);
  REQUIRE(points.size() == 1);
  const double beam_s = 1e-9 * static_cast<double>(s.laser.duration_ns(beam + 1));
  INFO("kind of error " << kind << ", beam " << beam);
  CHECK(points[0].variance_m2 ==
        Approx(simulated_variance(s, beam, 2.5, 0.45 + 0.8 * beam_s, 0.8)).epsilon(0.1).margin(1e-9));
}

TEST_CASE("line projection: where the robot is and which way it heads changes no height's variance") {
  Settings s = with_errors(6);
  s.tilt.fixed = true;
  s.tilt.fixed_tilt_rad = 0.5f;
  const auto bench = std::make_unique<Bench>(s);
  const Pose pose{t0, 12.0f, -5.0f, 0.3f, 0.0f, 0.0f, 0.6f, 0.8f};
  const auto still = bench->project(std::vector<float>(361, 3.0f));
  bench->motion = {make_transform(pose), make_transform(pose), false};
  const auto moved = bench->project(std::vector<float>(361, 3.0f));
  for (std::size_t i = 0; i < still.size(); ++i) {
    CHECK(moved[i].z_m == Approx(still[i].z_m + 0.3f).margin(1e-5));
    CHECK(moved[i].variance_m2 == Approx(still[i].variance_m2).epsilon(1e-3));
  }
}

TEST_CASE("line projection: within a jump of the poses heights are off by a part of it, the more the further away") {
  Settings settings = base_settings();
  settings.tilt.fixed = true;
  settings.tilt.fixed_tilt_rad = 0.5f;
  Bench bench(settings);
  bench.motion.still = false;
  const std::vector<float> ranges(361, 2.0f);
  const std::vector<Point> calm = bench.project(ranges);
  bench.motion.jumps = {0.04f * 0.04f, 0.03f * 0.03f};
  const std::vector<Point> blurred = bench.project(ranges);
  REQUIRE(blurred.size() == calm.size());
  for (std::size_t i = 0; i < calm.size(); ++i) {
    const Point& p = blurred[i];
    const double away_m2 = std::pow(p.x_m, 2) + std::pow(p.y_m, 2);
    CHECK(p.z_m == calm[i].z_m);
    CHECK(p.variance_m2 - calm[i].variance_m2 == Approx((0.04 * 0.04 + 0.03 * 0.03 * away_m2) / 6).epsilon(1e-3));
  }
}

TEST_CASE("line projection: of the points those within the bounds are kept as they were, the others counted") {
  Settings settings = with_errors(6);
  settings.tilt.fixed = true;
  settings.tilt.fixed_tilt_rad = -0.2f;
  Bench bench(settings);
  Noise noise;
  std::vector<float> ranges(361);
  for (float& r : ranges) r = static_cast<float>(0.2 + 9.0 * noise.uniform());
  bench.project(ranges);  // an isolated echo is left out once
  const std::vector<Point> all = bench.project(ranges);
  REQUIRE(all.size() == ranges.size());
  CHECK(bench.outside == 0);
  bench.bounds = {-1.0f, -4.0f, 5.0f, 3.0f, 1.0f};
  const std::vector<Point> kept = bench.project(ranges);
  std::vector<Point> expected;
  for (const Point& p : all) {
    if (bench.bounds.hold(p.place_x_m(), p.place_y_m(), p.z_m)) expected.push_back(p);
  }
  REQUIRE(kept.size() == expected.size());
  CHECK(kept.size() > 20);
  CHECK(bench.outside == all.size() - kept.size());
  CHECK(std::memcmp(kept.data(), expected.data(), kept.size() * sizeof(Point)) == 0);
}

}  // namespace
}  // namespace curbline
