// The robot's pose between and beyond the poses that were given.
#include "curbline/intake/pose_track.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>

#include "support/noisy_poses.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

using test::noisy_poses;

constexpr Limits limits{.poses = 8};
using Track = PoseTrack<limits>;
constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t t0 = 1'290'682'980'000'000'000;

/// A robot that drives at 1 m/s along x and turns left at 0.5 rad/s.
Pose driving(std::int64_t time_ns) {
  const double s = static_cast<double>(time_ns - t0) * 1e-9;
  return {time_ns,
          static_cast<float>(s),
          2.0f,
          0.1f,
          0.0f,
          0.0f,
          static_cast<float>(std::sin(0.25 * s)),
          static_cast<float>(std::cos(0.25 * s))};
}

Track track_of(int poses, PoseSettings settings = {}) {
  settings.still = false;
  Track track;
  track.init(settings);
  for (int k = 0; k < poses; ++k) REQUIRE(track.push(driving(t0 + 50 * ms * k)));
  return track;
}

double yaw_of(const Pose& pose) {
  const Eigen::Matrix3f R = make_transform(pose).rotation;
  return std::atan2(static_cast<double>(R(1, 0)), static_cast<double>(R(0, 0)));
}

TEST_CASE("pose track: between two poses position and attitude are interpolated") {
  const Track track = track_of(5);
  for (int k = 0; k <= 40; ++k) {
    Pose pose;
    REQUIRE(track.at(t0 + 5 * ms * k, pose));
    CHECK(pose.time_ns == t0 + 5 * ms * k);
    CHECK(pose.x_m == Approx(0.005 * k).margin(1e-6));
    CHECK(pose.y_m == 2.0f);
    CHECK(yaw_of(pose) == Approx(0.0025 * k).margin(1e-5));
  }
}

TEST_CASE("pose track: two quaternions of one attitude are interpolated the short way") {
  Track track = track_of(1);
  Pose pose = driving(t0 + 50 * ms);
  for (float Pose::*q : {&Pose::qx, &Pose::qy, &Pose::qz, &Pose::qw}) pose.*q = -(pose.*q);
  REQUIRE(track.push(pose));
  Pose between;
  REQUIRE(track.at(t0 + 25 * ms, between));
  CHECK(yaw_of(between) == Approx(0.0125).margin(1e-5));
}

TEST_CASE("pose track: beyond its ends the robot goes on as it went, up to the bound") {
  const Track track = track_of(5);
  const std::int64_t last = t0 + 200 * ms;
  Pose pose;
  REQUIRE(track.at(last + 100 * ms, pose));
  CHECK(pose.x_m == Approx(0.3).margin(1e-6));
  CHECK(yaw_of(pose) == Approx(0.15).margin(1e-4));
  CHECK_FALSE(track.at(last + 100 * ms + 1000, pose));
  REQUIRE(track.at(t0 - 100 * ms, pose));
  CHECK(pose.x_m == Approx(-0.1).margin(1e-6));
  CHECK_FALSE(track.at(t0 - 100 * ms - 1000, pose));
}

TEST_CASE("pose track: two poses a moment apart do not make the robot jump") {
  for (const std::int64_t moment_ns : {std::int64_t{1}, std::int64_t{10'000}, ms}) {
    Track track = track_of(5);
    Pose second = driving(t0 + 200 * ms + moment_ns);
    second.x_m += 0.001f;  // from another source, off by a millimetre
    REQUIRE(track.push(second));
    Pose pose;
    REQUIRE(track.at(t0 + 240 * ms, pose));
    CHECK(pose.x_m == Approx(driving(t0 + 240 * ms).x_m).margin(0.002));
  }
}

TEST_CASE("pose track: poses a moment apart alone tell no velocity: the nearest stands") {
  Track track = track_of(1);
  Pose second = driving(t0 + 1);
  second.x_m = 5.0f;
  REQUIRE(track.push(second));
  Pose pose;
  REQUIRE(track.at(t0 + 50 * ms, pose));
  CHECK(pose.x_m == 5.0f);
}

TEST_CASE("pose track: it goes on no further than the map does") {
  Track track = track_of(0);
  for (int k = 0; k < 2; ++k) {
    Pose pose = driving(t0 + 50 * ms * k);
    pose.x_m = k == 0 ? -9e5f : 9e5f;
    REQUIRE(track.push(pose));
  }
  Pose pose;
  CHECK(track.at(t0 + 50 * ms, pose));
  CHECK_FALSE(track.at(t0 + 60 * ms, pose));
}

TEST_CASE("pose track: between two poses that are far apart there is none, as its header says") {
  Track track = track_of(1);
  REQUIRE(track.push(driving(t0 + 10000 * ms)));
  Pose pose;
  CHECK_FALSE(track.at(t0 + 5000 * ms, pose));
}

TEST_CASE("pose track: soon after a pose, or before the next, there is one, however far apart these are") {
  Track track = track_of(1);
  REQUIRE(track.push(driving(t0 + 2000 * ms)));
  Pose pose;
  REQUIRE(track.at(t0 + 20 * ms, pose));
  CHECK(pose.x_m == Approx(0.02).margin(1e-4));
  REQUIRE(track.at(t0 + 1980 * ms, pose));
  CHECK(pose.x_m == Approx(1.98).margin(1e-4));
  CHECK_FALSE(track.at(t0 + 1000 * ms, pose));
}

TEST_CASE("pose track: without a pose there is none, with one the robot stands there") {
  Track track = track_of(0);
  Pose pose;
  CHECK_FALSE(track.at(t0, pose));
  track = track_of(1);
  REQUIRE(track.at(t0 + 99 * ms, pose));
  CHECK(pose.x_m == 0.0f);
  CHECK(pose.y_m == 2.0f);
}

TEST_CASE("pose track: poses that are not later, not finite or not unit quaternions are dropped") {
  Track track = track_of(2);
  CHECK_FALSE(track.push(driving(t0 + 50 * ms)));
  CHECK_FALSE(track.push(driving(t0)));
  for (float Pose::*value : {&Pose::x_m, &Pose::y_m, &Pose::z_m, &Pose::qx, &Pose::qy, &Pose::qz, &Pose::qw}) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      Pose pose = driving(t0 + 100 * ms);
      pose.*value = bad;
      CHECK_FALSE(track.push(pose));
    }
  }
  Pose zero = driving(t0 + 100 * ms);
  zero.qz = zero.qw = 0.0f;
  CHECK_FALSE(track.push(zero));
  Pose loose = driving(t0 + 100 * ms);
  loose.qw *= 1.02f;
  CHECK_FALSE(track.push(loose));
  CHECK(track.newest().time_ns == t0 + 50 * ms);
  CHECK(track.push(driving(t0 + 100 * ms)));
}

TEST_CASE("pose track: poses of a robot that lies on its back, as a quaternion with qw first makes them, are dropped") {
  Track track = track_of(2);
  const auto turned = [](float qx, float qy, float qz, float qw) {
    Pose pose = driving(t0 + 100 * ms);
    pose.qx = qx, pose.qy = qy, pose.qz = qz, pose.qw = qw;
    return pose;
  };
  CHECK_FALSE(track.push(turned(1.0f, 0.0f, 0.0f, 0.0f)));
  CHECK_FALSE(track.push(turned(0.9986f, 0.01f, -0.02f, 0.05f)));  // pitched by 1 degree, heading 6 degrees to the left
  CHECK_FALSE(track.push(turned(0.0f, 0.72f, 0.0f, 0.694f)));      // 92 degrees
  CHECK(track.newest().time_ns == t0 + 50 * ms);
  CHECK(track.push(turned(0.0f, 0.694f, 0.0f, 0.72f)));  // 88 degrees
}

TEST_CASE("pose track: after a pose of the future, or a clock that is set back, poses are taken again") {
  Track track = track_of(5);
  REQUIRE(track.push(driving(t0 + 3'600'000 * ms)));
  int refused = 0;
  std::int64_t at = t0 + 250 * ms;
  for (; refused < 100 && !track.push(driving(at)); at += 10 * ms) ++refused;
  CHECK(refused == RisingTimes::most_refused);
  REQUIRE(track.push(driving(at + 10 * ms)));
  Pose pose;
  REQUIRE(track.at(at + 5 * ms, pose));
  CHECK(pose.x_m == Approx(driving(at + 5 * ms).x_m).margin(1e-5));
  CHECK(track.at(t0 + 100 * ms, pose) == false);  // from before
}

TEST_CASE("pose track: the newest poses are kept, the oldest give way") {
  const Track track = track_of(30);
  Pose pose;
  CHECK(track.newest().time_ns == t0 + 29 * 50 * ms);
  REQUIRE(track.at(t0 + (2950 - 10) * ms / 2, pose));
  CHECK(pose.x_m == Approx(1.47).margin(1e-5));
  REQUIRE(track.at(t0 + 22 * 50 * ms, pose));
  CHECK(pose.x_m == Approx(1.1).margin(1e-5));
  CHECK_FALSE(track.at(t0 + 19 * 50 * ms, pose));
}

TEST_CASE("pose track: a pose turns and moves points as its quaternion says") {
  const Eigen::Quaterniond q = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX());
  const Eigen::Quaternionf f = q.cast<float>();
  const Pose pose{
      t0, 1.0f, -2.0f, 0.3f, 1.005f * f.x(), 1.005f * f.y(), 1.005f * f.z(), 1.005f * f.w()};  // normalised here
  const Eigen::Vector3d truth = q * Eigen::Vector3d(0.5, 1.5, -0.8) + Eigen::Vector3d(1.0, -2.0, 0.3);
  const Eigen::Vector3f p = make_transform(pose) * Eigen::Vector3f(0.5f, 1.5f, -0.8f);
  CHECK((p.cast<double>() - truth).norm() < 1e-6);
}

/// The k-th pose, at 50 Hz, on a ramp of 8 %.
Pose on_ramp(int k) {
  Pose pose{t0 + 20 * ms * k, 0.02f * static_cast<float>(k), 0.0f, 0.0016f * static_cast<float>(k)};
  pose.qy = -0.04f;
  return pose;
}

/// Such poses, each changed by `changed(pose, k)`.
template <typename Changed>
Track on_ramp(int poses, const PoseSettings& settings, Changed&& changed) {
  Track track;
  track.init(settings);
  for (int k = 0; k < poses; ++k) {
    Pose pose = on_ramp(k);
    changed(pose, k);
    REQUIRE(track.push(pose));
  }
  return track;
}

TEST_CASE("pose track: of poses that err each on its own one in 400 jumps, after another that has jumped, too") {
  PoseSettings settings;
  settings.height_sd_m = 0.003f;
  const int apart = GENERATE(0, 1);  // between the poses that tell the speed and the one it is gone on from
  test::Noise noise(1);
  int jumps = 0;
  for (int k = 0; k < 100000; ++k) {
    const auto pose = [&](int n) {
      return Pose{t0 + 20 * ms * n, 0.0f, 0.0f, static_cast<float>(0.003 * noise.normal())};
    };
    const Pose first = pose(0), last = pose(4), before = apart == 0 ? last : pose(5), now = pose(5 + apart);
    jumps += detail::residual_of(first, last, before, now, settings).height_jumps ? 1 : 0;
  }
  CHECK(jumps == Approx(100000 / 400).epsilon(0.2));
}

TEST_CASE("pose track: poses that jump say by how much, those around them do not") {
  const Track track = on_ramp(8, noisy_poses(), [](Pose& pose, int k) {
    if (k < 5) return;
    pose.z_m += 0.03f;
    pose.qx += 0.0075f;  // by 15 mrad
  });
  const PoseJumps there = track.jumps(t0 + 95 * ms, t0 + 97 * ms);  // a line between the fourth pose and the fifth
  CHECK(there.height_m2 == Approx(0.03 * 0.03).epsilon(0.01));
  CHECK(there.attitude_rad2 == Approx(0.015 * 0.015).epsilon(0.01));
  const PoseJumps before = track.jumps(t0, t0 + 80 * ms), after = track.jumps(t0 + 100 * ms, t0 + 140 * ms);
  CHECK(before.height_m2 + before.attitude_rad2 + after.height_m2 + after.attitude_rad2 == 0.0f);
}

TEST_CASE("pose track: a drive, its turns and the noise that is told of are no jumps") {
  test::Noise lot(3);
  int jumps = 0;
  for (int run = 0; run < 1000; ++run) {
    const Track track = on_ramp(8, noisy_poses(), [&](Pose& pose, int k) {
      pose.z_m += static_cast<float>(0.003 * lot.normal());
      pose.qx += static_cast<float>(0.0005 * lot.normal());
      pose.qy += static_cast<float>(0.0005 * lot.normal());
      pose.qz = 0.006f * static_cast<float>(k);
    });
    const PoseJumps last = track.jumps(t0 + 120 * ms, t0 + 140 * ms);
    jumps += last.height_m2 + last.attitude_rad2 > 0.0f;
  }
  CHECK(jumps < 25);  // by chance, 3 in 1000 for the height and 11 for the two angles
}

/// The news of steps that has not been fetched yet: 'S' one begins, 'C' it is confirmed, 'W' it was none, 'E' a climb
/// ends.
std::string told_until(Track& track, std::int64_t time_ns) {
  std::string told;
  while (const auto step = track.next_step(time_ns)) {
    using Kind = PoseStepNews::Kind;
    told += step->kind == Kind::begun       ? 'S'
            : step->kind == Kind::confirmed ? 'C'
            : step->kind == Kind::withdrawn ? 'W'
                                            : 'E';
  }
  return told;
}

/// The same after each of so many poses, '.' for no news.
template <typename Changed>
std::string told_by_each(Changed&& changed, int poses = 8) {
  std::string told;
  Track track;
  track.init(noisy_poses());
  for (int k = 0; k < poses; ++k) {
    Pose pose = on_ramp(k);
    changed(pose, k);
    REQUIRE(track.push(pose));
    const std::string news = told_until(track, pose.time_ns);
    told += news.empty() ? "." : news;
  }
  return told;
}

TEST_CASE("pose track: poses that go on elsewhere as fast as before have stepped, however far") {
  const float step = GENERATE(0.02f, 0.2f);
  const auto higher = [step](Pose& pose, int k) { pose.z_m += k >= 5 ? step : 0.0f; };
  const auto turned = [step](Pose& pose, int k) { pose.qx += k >= 5 ? 0.3f * step : 0.0f; };
  CHECK(told_by_each(higher) == ".....SC.");
  CHECK(told_by_each(turned) == ".....SC.");
}

TEST_CASE("pose track: poses of a robot that rises or turns have not stepped, nor has one that is wrong") {
  const auto rises = [](Pose& pose, int k) { pose.z_m += k >= 4 ? 0.02f * static_cast<float>(k - 3) : 0.0f; };
  const auto pitches = [](Pose& pose, int k) { pose.qy += k >= 4 ? 0.01f * static_cast<float>(k - 3) : 0.0f; };
  const auto wrong = [](Pose& pose, int k) { pose.z_m += k == 4 ? 0.1f : 0.0f; };
  for (const std::string& told : {told_by_each(rises), told_by_each(pitches), told_by_each(wrong)}) {
    CHECK(told.substr(0, 6) == "....SW");
    CHECK(told.find('C') == std::string::npos);
  }
}

/// A robot that drives on, and up by 4 cm with each pose from the fifth to the seventh.
void climb(Pose& pose, int k) {
  pose.z_m += k < 4 ? 0.0f : 0.04f * static_cast<float>(std::min(k, 6) - 3);
}

TEST_CASE(
    "pose track: a robot has climbed once poses that jumped in a row have continued for a while, reported once, others "
    "have not") {
  const auto stepped = [](Pose& pose, int k) { pose.z_m += k >= 4 ? 0.04f : 0.0f; };
  const float off_m = GENERATE(0.02f, 0.1f, 1.0f);
  const auto wrong = [off_m](Pose& pose, int k) { pose.z_m += k == 4 ? off_m : 0.0f; };
  const std::string told = told_by_each(climb, 30);
  CHECK(told.substr(0, 6) == "....SW");
  REQUIRE(told.find('E') != std::string::npos);
  CHECK(told.find('E') == told.rfind('E'));
  CHECK(told.find('E') > 8 + 4);  // after the last of the jumps with which the climb stops
  CHECK(told.find('E') < 8 + 8);
  CHECK(told_by_each(stepped, 30).find('E') == std::string::npos);
  CHECK(told_by_each(wrong, 30).find('E') == std::string::npos);
}

template <typename AnyTrack>
void push_climb(AnyTrack& track, int poses) {
  for (int k = 0; k < poses; ++k) {
    Pose pose = on_ramp(k);
    climb(pose, k);
    REQUIRE(track.push(pose));
    while (track.next_step(pose.time_ns)) continue;
  }
}

TEST_CASE("pose track: a climb is over where poses begin anew") {
  Track track;
  track.init(noisy_poses());
  push_climb(track, 6);
  REQUIRE(track.climbs());
  for (int k = 0; k <= RisingTimes::most_refused; ++k) track.push(driving(t0 - 1000 * ms + k * ms));
  REQUIRE(track.newest().time_ns < t0);
  CHECK_FALSE(track.climbs());
}

TEST_CASE("pose track: a step that has begun is withdrawn where poses begin anew, once") {
  Track track;
  track.init(noisy_poses());
  const auto news = [&] { return track.next_step(track.newest().time_ns); };
  const auto step = [&] {
    track.init(noisy_poses());
    for (int k = 0; k < 8; ++k) {
      Pose pose = driving(t0 + k * 20 * ms);
      pose.z_m += k == 7 ? 0.1f : 0.0f;
      REQUIRE(track.push(pose));
      if (k < 7) REQUIRE_FALSE(news());
    }
    REQUIRE(news()->kind == PoseStepNews::Kind::begun);
  };
  step();
  for (int k = 0; k <= RisingTimes::most_refused; ++k) track.push(driving(t0 - 1000 * ms + k * ms));
  REQUIRE(track.newest().time_ns < t0);
  const auto first = news();
  REQUIRE(first);
  CHECK(first->kind == PoseStepNews::Kind::withdrawn);
  CHECK_FALSE(news());
  step();
  track.init(noisy_poses());
  track.push(driving(t0));
  CHECK_FALSE(news());
}

TEST_CASE("pose track: of a track of four poses a climb is over, too") {
  constexpr Limits four{.poses = 4};
  PoseTrack<four> track;
  track.init(noisy_poses());
  push_climb(track, 6);
  REQUIRE(track.climbs());
  PoseTrack<four> later;
  later.init(noisy_poses());
  push_climb(later, 30);
  CHECK_FALSE(later.climbs());
}

TEST_CASE("pose track: a pose that lies off by its own error is no step, though the next one's is no jump back") {
  // The first deviates from its prediction by 15.4 mm, where three standard deviations are 14.6 mm; the next deviates
  // from that one's by 3 mm.
  const auto off = [](Pose& pose, int k) { pose.z_m += k == 3 ? -0.004f : k == 4 ? 0.0104f : k == 5 ? 0.004f : 0.0f; };
  CHECK(told_by_each(off).substr(0, 6) == "....SW");
}

TEST_CASE("pose track: of poses that come fast those 12 ms apart are kept, and the newest") {
  Track track;
  track.init(noisy_poses());
  std::string told;
  for (int k = 0; k < 100; ++k) {  // 500 a second, a step after 150 ms
    Pose pose = driving(t0 + 2 * ms * k);
    pose.z_m += k >= 75 ? 0.1f : 0.0f;
    REQUIRE(track.push(pose));
    CHECK(track.newest().time_ns == pose.time_ns);
    told += told_until(track, pose.time_ns);
  }
  CHECK(told == "SC");
  Pose pose;
  const std::int64_t oldest = t0 + 198 * ms - 6 * 12 * ms;  // of eight, two of which may be close
  for (std::int64_t time = oldest; time <= t0 + 198 * ms; time += ms) {
    REQUIRE(track.at(time, pose));
    CHECK(pose.x_m == Approx(driving(time).x_m).margin(1e-5));
  }
  const PoseJumps there = track.jumps(t0 + 145 * ms, t0 + 150 * ms);
  CHECK(there.height_m2 == Approx(0.1 * 0.1).epsilon(0.01));
}

TEST_CASE("pose track: poses that come many at a time say of steps what they say one by one") {
  Track track;
  track.init(noisy_poses());
  for (int k = 0; k < 10; ++k) {
    Pose pose = on_ramp(k);
    pose.z_m += k < 5 ? 0.0f : k < 8 ? 0.3f : 0.3f + 0.1f * static_cast<float>(k - 7);  // steps, then climbs
    REQUIRE(track.push(pose));
  }
  CHECK(told_until(track, t0 + 20 * ms * 9) == "SCSW");
  CHECK(told_until(track, t0 + 20 * ms * 9).empty());
}

TEST_CASE("pose track: a step is told in the map's frame, whatever way the robot heads") {
  Track track;
  track.init(noisy_poses());
  PoseShift by;
  for (int k = 0; k < 8; ++k) {
    // Heads along the map's y axis and rolls to the right, so what is on its left, at lower x, seems to be higher.
    const Eigen::Quaternionf q = Eigen::AngleAxisf(0.5f * pi, Eigen::Vector3f::UnitZ()) *
                                 Eigen::AngleAxisf(k >= 5 ? 0.01f : 0.0f, Eigen::Vector3f::UnitX());
    REQUIRE(track.push({t0 + 20 * ms * k, 0.0f, 0.02f * static_cast<float>(k), 0.0f, q.x(), q.y(), q.z(), q.w()}));
    while (const auto step = track.next_step(t0 + 20 * ms * k)) {
      if (step->kind == PoseStepNews::Kind::begun) by = step->by;
    }
  }
  CHECK(by.slope_x == Approx(-0.01).margin(1e-5));
  CHECK(by.slope_y == Approx(0.0).margin(1e-5));
  CHECK(by.height_m == Approx(0.0).margin(1e-5));
}

}  // namespace
}  // namespace curbline
