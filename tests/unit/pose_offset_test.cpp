// Who has stepped, the robot or its localisation, and by how much the poses are corrected.
#include "curbline/intake/pose_offset.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/noisy_poses.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

PoseOffset made() {
  PoseOffset offset;
  offset.init(test::noisy_poses());
  return offset;
}

/// Begins a line with the robot at the origin, after a pose that steps and, if the step is confirmed, the next pose.
void step(PoseOffset& offset, const PoseShift& by, bool confirmed = true) {
  offset.begin_line(0.0f, 0.0f);
  offset.follow({PoseStepNews::Kind::begun, by});
  if (confirmed) offset.follow({PoseStepNews::Kind::confirmed});
}

/// A line across, ahead_m in front of the robot, which is at the origin. Its heights deviate from the ground by `off`,
/// less the correction of the poses. Returns the correction of the line itself.
PoseShift see_line(PoseOffset& offset, double ahead_m, const PoseShift& off, test::Noise& lot, int points = 200,
                   int without_ground = 0) {
  const PoseShift poses{off.height_m + offset.offset().height_m, off.slope_x + offset.offset().slope_x,
                        off.slope_y + offset.offset().slope_y};
  for (int k = 0; k < points; ++k) {
    const auto x = static_cast<float>(ahead_m), y = -2.0f + 4.0f * static_cast<float>(k) / static_cast<float>(points);
    offset.compare({x, y, poses.at(x, y) + static_cast<float>(0.01 * lot.normal()), 1e-4f, 0.0f});
  }
  for (int k = 0; k < without_ground; ++k) offset.pass();
  return offset.end_line();
}

constexpr PoseShift jump{0.02f, -0.007f, 0.007f};

TEST_CASE("pose offset: what a localisation has stepped by is taken off, of the line that tells as well") {
  test::Noise lot(1);
  PoseOffset offset = made();
  step(offset, jump);
  REQUIRE(offset.undecided());
  const PoseShift back = see_line(offset, 1.0, jump, lot);
  CHECK_FALSE(offset.undecided());
  CHECK(back.at(1.0f, 0.0f) == Approx(-0.013).margin(0.002));
  CHECK(offset.offset().height_m == Approx(-0.02).margin(0.003));
  CHECK(offset.offset().slope_x == Approx(0.007).margin(0.002));
  CHECK(offset.offset().slope_y == Approx(-0.007).margin(0.001));
  const Pose pose = offset.corrected({0, 5.0f, 3.0f, 0.02f, 0.0035f, 0.0035f, 0.0f, 1.0f});
  CHECK(pose.z_m == Approx(0.0).margin(0.003));
  CHECK(pose.qx == Approx(0.0).margin(0.001));
  CHECK(pose.qy == Approx(0.0).margin(0.001));
}

TEST_CASE("pose offset: what a robot has stepped by is left alone") {
  test::Noise lot(2);
  PoseOffset offset = made();
  step(offset, jump);
  CHECK_FALSE(see_line(offset, 1.0, {}, lot).any());
  CHECK_FALSE(offset.undecided());
  CHECK_FALSE(offset.offset().any());
}

TEST_CASE("pose offset: a step that is confirmed, of which no line has told, is left alone when the next one begins") {
  test::Noise lot(2);
  PoseOffset offset = made();
  step(offset, jump);
  see_line(offset, 1.0, jump, lot, 200, 201);
  REQUIRE(offset.undecided());
  offset.follow({PoseStepNews::Kind::begun, jump});
  offset.follow({PoseStepNews::Kind::withdrawn});
  CHECK_FALSE(offset.offset().any());
}

TEST_CASE("pose offset: a step is measured better by the lines after it than by the poses") {
  test::Noise lot(3);
  double by_poses_m2 = 0.0, by_lines_m2 = 0.0;
  for (int run = 0; run < 100; ++run) {
    PoseOffset offset = made();
    const PoseShift told{jump.height_m + static_cast<float>(0.005 * lot.normal()), jump.slope_x,
                         jump.slope_y + static_cast<float>(0.0016 * lot.normal())};
    step(offset, told);
    see_line(offset, 1.0, jump, lot);
    by_poses_m2 += std::pow(told.at(1.0f, 1.0f) - jump.at(1.0f, 1.0f), 2);
    by_lines_m2 += std::pow(offset.offset().at(1.0f, 1.0f) + jump.at(1.0f, 1.0f), 2);
  }
  CHECK(by_lines_m2 < 0.7 * by_poses_m2);
}

TEST_CASE("pose offset: a step that cannot be seen yet stays open, and heights where they are") {
  test::Noise lot(4);
  PoseOffset offset = made();
  const PoseShift level{0.02f, -0.02f, 0.0f};  // 1 m ahead nothing of it is seen
  step(offset, level);
  CHECK(std::abs(see_line(offset, 1.0, level, lot).at(1.0f, 0.0f)) < 0.003f);
  CHECK(offset.undecided());
  CHECK(offset.doubt_m2(1.0f, 0.0f) < 1e-5f);
  CHECK(offset.doubt_m2(3.0f, 0.0f) == Approx(0.04 * 0.04).epsilon(0.3));
  offset.begin_line(0.0f, 0.0f);
  see_line(offset, 2.0, level, lot);
  offset.begin_line(0.0f, 0.0f);
  see_line(offset, 3.0, level, lot);
  CHECK_FALSE(offset.undecided());
  CHECK(offset.offset().at(3.0f, 0.0f) == Approx(0.04).margin(0.005));
}

TEST_CASE("pose offset: a line of which less than half lies on known ground decides nothing") {
  test::Noise lot(5);
  PoseOffset offset = made();
  step(offset, jump);
  CHECK_FALSE(see_line(offset, 1.0, jump, lot, 200, 201).any());
  CHECK(offset.undecided());
}

TEST_CASE("pose offset: a step that was none is forgotten, even after a line has fallen for it") {
  test::Noise lot(6);
  PoseOffset offset = made();
  step(offset, jump, false);
  see_line(offset, 1.0, jump, lot);
  CHECK(offset.undecided());
  REQUIRE(offset.offset().any());
  offset.follow({PoseStepNews::Kind::withdrawn});
  CHECK_FALSE(offset.undecided());
  CHECK_FALSE(offset.offset().any());
}

TEST_CASE("pose offset: steps follow each other, and the offset is their sum") {
  test::Noise lot(7);
  PoseOffset offset = made();
  PoseShift sum;
  for (int k = 0; k < 5; ++k) {
    sum = sum + jump;
    step(offset, jump);
    see_line(offset, 1.0, sum, lot);
  }
  CHECK(offset.offset().at(1.0f, 0.0f) == Approx(-5 * 0.013).margin(0.005));
}

TEST_CASE("pose offset: it fades, and no faster in four hundred lines than poses tremble") {
  test::Noise lot(8);
  PoseOffset offset = made();
  step(offset, jump);
  see_line(offset, 1.0, jump, lot);
  const PoseShift first = offset.offset();
  for (int line = 0; line < 400; ++line) offset.begin_line(0.0f, 0.0f);
  CHECK(offset.offset().height_m == Approx(first.height_m + 0.003f).margin(1e-5));
  CHECK(offset.offset().slope_x == Approx(first.slope_x - 0.001f).margin(1e-5));
  for (int line = 0; line < 4000; ++line) offset.begin_line(0.0f, 0.0f);
  CHECK_FALSE(offset.offset().any());
}

TEST_CASE("pose offset: though lines and the ground before lie off by poses' own errors, few steps are misjudged") {
  test::Noise lot(15);
  const bool localisations = GENERATE(false, true);
  constexpr int runs = 300;
  int misjudged = 0;
  for (int run = 0; run < runs; ++run) {
    PoseOffset offset = made();
    step(offset, jump);
    const auto error = [&](double sd) {
      return static_cast<float>(std::sqrt(2.0) * sd * lot.normal());
    };  // of two poses
    for (int line = 0; line < 10 && offset.undecided(); ++line) {
      const PoseShift off{error(0.003), error(0.001), error(0.001)};
      see_line(offset, 1.0, localisations ? off + jump : off, lot);
    }
    misjudged += offset.offset().any() != localisations;
  }
  CHECK(misjudged < 0.05 * runs);
}

/// After a localisation has been found to step, by `jump`, and the robot has then climbed.
PoseOffset climbed_after_a_step(test::Noise& lot) {
  PoseOffset offset = made();
  step(offset, jump);
  see_line(offset, 1.0, jump, lot);
  REQUIRE(offset.localisation_steps());
  offset.follow({PoseStepNews::Kind::climbed});
  REQUIRE(offset.undecided());
  return offset;
}

TEST_CASE("pose offset: what a localisation has stepped by while the robot climbed is found by the lines after it") {
  test::Noise lot(9);
  PoseOffset offset = climbed_after_a_step(lot);
  for (int line = 0; line < 5; ++line) see_line(offset, 1.0 + 0.1 * line, {0.04f, -0.014f, 0.014f}, lot);
  CHECK_FALSE(offset.undecided());
  CHECK(offset.offset().at(1.0f, 0.0f) == Approx(-2 * 0.013).margin(0.003));
  CHECK(offset.offset().slope_y == Approx(-2 * 0.007).margin(0.001));
}

TEST_CASE("pose offset: a robot that has climbed is asked nothing if its localisation was never found to step") {
  test::Noise lot(9);
  PoseOffset offset = made();
  step(offset, jump);
  see_line(offset, 1.0, {}, lot);
  offset.follow({PoseStepNews::Kind::climbed});
  CHECK_FALSE(offset.undecided());
}

TEST_CASE("pose offset: a robot that has climbed is asked nothing if its poses are exact") {
  test::Noise lot(9);
  PoseOffset offset;
  offset.init(PoseSettings{});
  step(offset, jump);
  see_line(offset, 1.0, jump, lot);
  REQUIRE(offset.localisation_steps());
  offset.follow({PoseStepNews::Kind::climbed});
  CHECK_FALSE(offset.undecided());
}

TEST_CASE("pose offset: after a climb what lines lie off by poses' own errors is no step of a localisation") {
  test::Noise lot(10);
  PoseOffset offset = climbed_after_a_step(lot);
  const float before_m = offset.offset().height_m;
  for (int line = 0; line < 100; ++line) see_line(offset, 1.0, {0.025f, -0.007f, 0.009f}, lot);
  CHECK(offset.offset().height_m == before_m);
}

/// A robot away from the origin, and lines at an angle, ahead of it or oblique.
struct Elsewhere {
  double angle;
  float x_m = 7.0f, y_m = -3.0f;

  /// From slopes ahead and along the lines.
  PoseShift shift(double height_m, double ahead, double along) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return {static_cast<float>(height_m), static_cast<float>(ahead * c - along * s),
            static_cast<float>(ahead * s + along * c)};
  }
  PoseOffset stepped(const PoseShift& by) const {
    PoseOffset offset = made();
    offset.begin_line(x_m, y_m);
    offset.follow({PoseStepNews::Kind::begun, by});
    offset.follow({PoseStepNews::Kind::confirmed});
    return offset;
  }
  /// Like see_line(), but two in five of its points may lie on another surface, higher by kerb_m.
  PoseShift see_line(PoseOffset& offset, double ahead_m, const PoseShift& off, test::Noise& lot,
                     double kerb_m = 0.0) const {
    const PoseShift poses = off + offset.offset();
    const double c = std::cos(angle), s = std::sin(angle);
    for (int k = 0; k < 200; ++k) {
      const double along_m = -2.0 + 4.0 * k / 200.0;
      const auto dx = static_cast<float>(ahead_m * c - along_m * s), dy = static_cast<float>(ahead_m * s + along_m * c);
      const double above_m = (k % 5 < 2 ? kerb_m : 0.0) + 0.01 * lot.normal();
      offset.compare({x_m + dx, y_m + dy, poses.at(dx, dy) + static_cast<float>(above_m), 1e-4f, 0.0f});
    }
    return offset.end_line();
  }
};

TEST_CASE("pose offset: what a localisation has stepped by is taken off wherever the robot is, of lines of any way") {
  const Elsewhere robot{GENERATE(0.0, 0.7, 1.5708, 2.5, 3.9)};
  const double kerb_m = GENERATE(0.0, 0.3);
  test::Noise lot(11);
  const PoseShift by = robot.shift(0.02, -0.007, 0.007);
  PoseOffset offset = robot.stepped(by);
  robot.see_line(offset, 1.0, by, lot, kerb_m);
  CHECK_FALSE(offset.undecided());
  CHECK(offset.offset().height_m == Approx(-by.height_m).margin(0.004));
  CHECK(offset.offset().slope_x == Approx(-by.slope_x).margin(0.003));
  CHECK(offset.offset().slope_y == Approx(-by.slope_y).margin(0.003));
  PoseOffset robots = robot.stepped(by);
  CHECK_FALSE(robot.see_line(robots, 1.0, {}, lot, kerb_m).any());
  CHECK_FALSE(robots.undecided());
  CHECK_FALSE(robots.offset().any());
}

TEST_CASE("pose offset: what one line does not show of a step stays in doubt, in any direction, until others do") {
  const Elsewhere robot{GENERATE(0.0, 0.7, 1.5708, 2.5, 3.9)};
  test::Noise lot(12);
  const PoseShift level = robot.shift(0.02, -0.02, 0.0);  // 1 m ahead nothing of it is seen
  PoseOffset offset = robot.stepped(level);
  robot.see_line(offset, 1.0, level, lot);
  CHECK(offset.undecided());
  const auto doubt_m2 = [&](double ahead_m) {
    return offset.doubt_m2(robot.x_m + static_cast<float>(ahead_m * std::cos(robot.angle)),
                           robot.y_m + static_cast<float>(ahead_m * std::sin(robot.angle)));
  };
  CHECK(doubt_m2(1.0) < 1e-5f);
  CHECK(doubt_m2(3.0) == Approx(0.04 * 0.04).epsilon(0.3));
  for (const double ahead_m : {2.0, 3.0}) robot.see_line(offset, ahead_m, level, lot);
  CHECK_FALSE(offset.undecided());
  CHECK(doubt_m2(3.0) == 0.0f);
}

TEST_CASE("pose offset: a pose is set back about the level axes of the map, whatever way the robot heads") {
  test::Noise lot(13);
  PoseOffset offset = made();
  step(offset, jump);
  see_line(offset, 1.0, jump, lot);
  const PoseShift by = offset.offset();
  for (const double yaw : {0.0, 1.0, 2.5, -1.5708}) {
    const Pose pose{0,
                    0.0f,
                    0.0f,
                    0.0f,
                    0.0f,
                    0.0f,
                    static_cast<float>(std::sin(0.5 * yaw)),
                    static_cast<float>(std::cos(0.5 * yaw))};
    const Pose set_back = offset.corrected(pose);
    const double w = set_back.qw, x = set_back.qx, y = set_back.qy, z = set_back.qz;
    CHECK(2 * (x * z + w * y) == Approx(-by.slope_x).margin(1e-4));  // the vertical axis of the pose
    CHECK(2 * (y * z - w * x) == Approx(-by.slope_y).margin(1e-4));
    CHECK(2 * std::atan2(z, w) == Approx(yaw).margin(1e-4));
    CHECK(set_back.z_m == by.height_m);
    // On a slope too: the correction is a turn before all others.
    const Eigen::Quaterniond leaning(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                     Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()) *
                                     Eigen::AngleAxisd(-0.1, Eigen::Vector3d::UnitY()));
    const Eigen::Quaterniond turn(1.0, 0.5 * static_cast<double>(by.slope_y), -0.5 * static_cast<double>(by.slope_x),
                                  0.0);
    const Eigen::Quaterniond expected = turn * leaning;
    const Pose on_slope =
        offset.corrected({0, 0.0f, 0.0f, 0.0f, static_cast<float>(leaning.x()), static_cast<float>(leaning.y()),
                          static_cast<float>(leaning.z()), static_cast<float>(leaning.w())});
    CHECK(on_slope.qw == Approx(expected.w()).margin(1e-6));
    CHECK(on_slope.qx == Approx(expected.x()).margin(1e-6));
    CHECK(on_slope.qy == Approx(expected.y()).margin(1e-6));
    CHECK(on_slope.qz == Approx(expected.z()).margin(1e-6));
  }
}

TEST_CASE(
    "pose offset: a localisation that leaps by as much as a curb is found out, and a robot that climbs one after") {
  const Elsewhere robot{GENERATE(0.0, 0.7)};
  test::Noise lot(14);
  const PoseShift leap = robot.shift(0.12, 0.0, 0.0);
  PoseOffset offset = robot.stepped(leap);
  robot.see_line(offset, 1.0, leap, lot);
  CHECK_FALSE(offset.undecided());
  CHECK(offset.offset().height_m == Approx(-0.12).margin(0.005));
  offset.follow({PoseStepNews::Kind::begun, leap});
  offset.follow({PoseStepNews::Kind::confirmed});
  robot.see_line(offset, 1.0, leap, lot);  // the line lies where it did before
  CHECK_FALSE(offset.undecided());
  CHECK(offset.offset().height_m == Approx(-0.12).margin(0.005));
}

}  // namespace
}  // namespace curbline
