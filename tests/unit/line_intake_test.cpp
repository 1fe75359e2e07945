// How a line is taken in: what is refused before it changes anything, and what the map is told.
#include "curbline/intake/line_intake.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

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
    ranges_m.assign(beams, 2.0f);
    work = std::make_unique<LineIntake<small_limits>::Work>();
    return intake->place({time_ns, ranges_m}, stages->dem, *work);
  }
  bool project(std::int64_t time_ns) {
    const MapComparison<small_limits> map(stages->dem, stages->mixture, stages->field, 10);
    const Bounds bounds = stages->dem.surroundings(1e9f);
    return intake->project({time_ns, ranges_m}, bounds, map, stages->dem, *work, stages->counters);
  }

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

}  // namespace
}  // namespace curbline
