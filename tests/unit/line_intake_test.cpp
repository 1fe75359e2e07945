// How a line is taken in: what is refused before it changes anything, and what the map is told.
#include "curbline/intake/line_intake.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "support/noisy_poses.hpp"
#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::small_limits;
using test::Stages;

constexpr std::int64_t ms = 1'000'000;

/// A laser with 11 beams, 1 m above flat ground, that looks down by half a radian unless its servo nods.
Settings settings_of(bool nods, bool drives) {
  Settings s = test::small_settings();
  s.laser.beams = 11;
  s.laser.first_bearing_rad = -0.1f;
  s.laser.bearing_step_rad = 0.02f;
  s.tilt.T_base_tilt.z_m = 1.0f;
  s.tilt.fixed = !nods;
  s.tilt.fixed_tilt_rad = 0.5f;
  s.pose.still = !drives;
  return s;
}

struct Intake {
  explicit Intake(const Settings& s) : stages(std::make_unique<Stages<>>(s)) { intake->init(s); }
  Status place(std::int64_t time_ns, std::size_t beams = 11) {
    ranges_m.assign(beams, range_m);
    work = std::make_unique<LineIntake<small_limits>::Work>();
    return intake->place({time_ns, ranges_m}, stages->dem, *work);
  }
  bool project(std::int64_t time_ns) {
    const MapComparison<small_limits> map(stages->dem, stages->mixture, stages->field, 10);
    return intake->project({time_ns, ranges_m}, map, stages->dem, *work, stages->counters);
  }

  float range_m = 2.0f;
  std::vector<float> ranges_m;
  std::unique_ptr<Stages<>> stages;
  std::unique_ptr<LineIntake<small_limits>> intake = std::make_unique<LineIntake<small_limits>>();
  std::unique_ptr<LineIntake<small_limits>::Work> work;
};

TEST_CASE("line intake: a line that is refused does not count as the newest") {
  Intake in(settings_of(false, false));
  CHECK(in.place(5 * ms, 12) == Status::line_too_long);
  REQUIRE(in.place(2 * ms) == Status::ok);
  CHECK(in.place(2 * ms) == Status::line_out_of_order);
  CHECK(in.place(3 * ms) == Status::ok);
  Intake waiting(settings_of(true, true));
  CHECK(waiting.place(5 * ms) == Status::no_pose);
  REQUIRE(waiting.intake->add_pose({4 * ms}));
  CHECK(waiting.place(5 * ms) == Status::no_tilt);
  REQUIRE(waiting.intake->add_tilt({4 * ms, 0.5f}));
  CHECK(waiting.place(4 * ms) == Status::ok);
}

TEST_CASE("line intake: points lie where the pose that was placed has them") {
  Intake in(settings_of(false, true));
  REQUIRE(in.intake->add_pose({0, 0.5f, 1.0f}));
  REQUIRE(in.place(1 * ms) == Status::ok);
  REQUIRE(in.project(1 * ms));
  REQUIRE(in.work->projected.points().size() == 11);
  const Point& middle = in.work->projected.points()[5];
  CHECK(middle.x_m == Approx(0.5 + 2 * std::cos(0.5)));
  CHECK(middle.y_m == Approx(1.0).margin(1e-6));
  CHECK(middle.z_m == Approx(1.0 - 2 * std::sin(0.5)));
}

TEST_CASE("line intake: when the servo turns, what the map holds is that of an earlier sweep") {
  Intake in(settings_of(true, false));
  test::fill(in.stages->dem, [](double, double) { return 0.0; });
  const int slot = in.stages->dem.slot(12, 12);
  for (int n = 0; n < 60; ++n) in.intake->add_tilt({n * 20 * ms, 0.01f * static_cast<float>(n < 30 ? n : 60 - n)});
  for (int n = 1; n < 30; ++n) REQUIRE(in.place(n * 20 * ms + ms) == Status::ok);
  CHECK_FALSE(in.stages->dem.mapped_before(slot));
  for (int n = 30; n < 40; ++n) REQUIRE(in.place(n * 20 * ms + ms) == Status::ok);
  CHECK(in.stages->dem.mapped_before(slot));
}

TEST_CASE("line intake: the line that tells how late the servo is lies where the corrected map does") {
  Settings settings = settings_of(true, false);
  settings.laser.bearing_step_rad = 0.002f;
  settings.laser.first_bearing_rad = -0.01f;
  settings.tilt.T_base_tilt.y_m = 1.25f;
  Intake in(settings);
  test::fill(in.stages->dem, [](double, double) { return 0.0; });
  in.stages->settle();
  const auto angle_rad = [](int n) { return 0.3f + 0.01f * static_cast<float>(n < 30 ? n : 60 - n); };  // 0.5 rad/s
  for (int n = 0; n < 60; ++n) in.intake->add_tilt({n * 20 * ms, angle_rad(n)});
  for (int n = 1; n < 40; ++n) REQUIRE(in.place(n * 20 * ms) == Status::ok);
  const float later_rad = 0.5f * 0.01f;  // in 10 ms, as late as the servo is
  in.range_m = 1.0f / std::sin(angle_rad(40) - later_rad);
  REQUIRE(in.place(40 * 20 * ms) == Status::ok);
  REQUIRE(in.project(40 * 20 * ms));
  REQUIRE_FALSE(in.work->projected.points().empty());
  const float uncorrected_m = 1.0f - in.range_m * std::sin(angle_rad(40));
  CHECK(uncorrected_m < -0.009f);
  for (const Point& p : in.work->projected.points()) CHECK(p.z_m > 0.2f * uncorrected_m);
}

/// Lines with poses 20 ms apart. The localisation steps after 0.4 s and is found out; then the robot climbs by 8 cm on
/// two poses, neither of which is next to a line, while the localisation steps by step_m. The last line is placed.
struct Climb {
  explicit Climb(float step_m, std::int64_t last_ns = last_line_ns) : in(settings()) {
    test::fill(in.stages->dem, [](double, double) { return 0.0; });
    in.stages->settle();
    in.range_m = 1.0f / std::sin(0.5f);
    for (std::int64_t time_ns = t0 + 110 * ms; time_ns < t0 + 900 * ms; time_ns += 100 * ms) {
      place(time_ns, step_m);
      REQUIRE(in.project(time_ns));
    }
    REQUIRE(in.intake->pose_offset().localisation_steps());
    in.stages->dem.add({1.85f, 1.25f, 0.0f, 1e-4f});
    in.range_m = 1.08f / std::sin(0.5f);
    place(last_ns, step_m);
    REQUIRE_FALSE(in.work->motion.jumps.any());
  }
  static Settings settings() {
    Settings s = settings_of(false, true);
    s.pose = test::noisy_poses();
    return s;
  }
  void place(std::int64_t time_ns, float step_m) {
    for (; t0 + poses * 20 * ms < time_ns + 20 * ms; ++poses) {
      const float climbed_m = poses < 42 ? 0.0f : poses == 42 ? 0.05f : 0.08f;
      const float stepped_m = poses < 20 ? 0.0f : poses < 43 ? 0.02f : 0.02f + step_m;
      REQUIRE(in.intake->add_pose({t0 + poses * 20 * ms, 0.0f, 1.2f, climbed_m + stepped_m}));
    }
    REQUIRE(in.place(time_ns) == Status::ok);
  }
  /// Of ground that was seen before the climb.
  bool marked() const { return in.stages->dem.marked(in.stages->dem.slot(18, 12)); }

  static constexpr std::int64_t t0 = 5000 * ms, last_line_ns = t0 + 930 * ms;
  Intake in;
  int poses = 0;
};

TEST_CASE("line intake: where no line sees a jump of a climb, the next one begins it all the same") {
  Climb climb(0.0f), stepping(0.02f), over(0.0f, Climb::last_line_ns + 200 * ms);
  CHECK_FALSE(climb.marked());
  CHECK_FALSE(over.marked());
  CHECK(climb.in.project(Climb::last_line_ns));
  CHECK_FALSE(stepping.in.project(Climb::last_line_ns));
  CHECK(stepping.in.stages->counters.lines_off_map == 1);
}

}  // namespace
}  // namespace curbline
