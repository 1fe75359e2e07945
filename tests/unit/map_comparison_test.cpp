// A line compared with ground that an earlier sweep has mapped: which of its points count, and for what.
#include "curbline/intake/map_comparison.hpp"

#include <catch2/catch.hpp>
#include <memory>

#include "support/noisy_poses.hpp"
#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::small_limits;
using test::Stages;

constexpr float growth_m_s = 1.0f, rate_rad_s = 0.5f, lag_s = 0.01f;

float slope_m(float x_m) {
  return 0.1f * x_m;
}

/// A slope that one sweep has seen, with a wall of this height across it from 1.0 to 1.3 m. In the next sweep every
/// line is late by lag_s.
struct Late {
  explicit Late(float wall = 0.0f) : wall_m(wall) {
    test::fill(stages->dem, [this](double x, double) { return static_cast<double>(top_m(static_cast<float>(x))); });
    stages->settle();
    stages->dem.begin_sweep();
    const Settings settings = test::small_settings();
    latency.init(settings.tilt, settings.pose);
    offset.init(settings.pose);
    latency.begin_line(0.2f, rate_rad_s, 0);
  }
  float top_m(float x_m) const { return slope_m(x_m) + (x_m >= 1.0f && x_m < 1.3f ? wall_m : 0.0f); }
  /// Twenty lines, each with a point of row i in every column.
  void look(int i, const LineMotion& motion = {}) {
    const MapComparison<small_limits> map(stages->dem, stages->mixture, stages->field, 10);
    for (std::uint32_t n = 1; n <= 20; ++n) {
      latency.begin_line(1.2f - 0.01f * static_cast<float>(n), -rate_rad_s, n);
      auto line = std::make_unique<ProjectedLine<small_limits>>();
      const float x_m = 0.1f * static_cast<float>(i) + 0.02f;  // off the cell's points, so that the slope matters
      for (int j = 0; j < 24; ++j) {
        Point p{x_m, 0.1f * static_cast<float>(j) + 0.05f, top_m(x_m), 1e-4f};
        p.z_m -= growth_m_s * (lag_s - latency.offset_s());
        p.growth_m_s = growth_m_s;
        if (!motion.still) p.variance_m2 += motion.blur_m2(p.x_m, p.y_m);
        line->add(p);
      }
      map.follow_latency(*line, motion, offset, latency);
      latency.end_line(-rate_rad_s);
    }
  }

  float wall_m;
  std::unique_ptr<Stages<>> stages = std::make_unique<Stages<>>(test::small_settings());
  TiltLatency latency{};
  PoseOffset offset{};
};

TEST_CASE("map comparison: points on ground of an earlier sweep tell how late the tilt is, by the slope of its plane") {
  Late late;
  late.look(12);
  CHECK(late.latency.offset_s() == Approx(lag_s).margin(0.001));
}

TEST_CASE("map comparison: a point is compared where it lies, not where its cell has it, along the slope of any way") {
  const float slope_x = GENERATE(0.1f, -0.1f), slope_y = GENERATE(0.15f, 0.0f);
  const auto ground_m = [=](float x_m, float y_m) { return slope_x * x_m + slope_y * y_m; };
  const auto stages = std::make_unique<Stages<>>(test::small_settings());
  test::fill(stages->dem, [&](double x, double y) {
    return static_cast<double>(ground_m(static_cast<float>(x), static_cast<float>(y)));
  });
  stages->settle();
  stages->dem.begin_sweep();
  const Settings settings = test::small_settings();
  TiltLatency latency;
  latency.init(settings.tilt, settings.pose);
  PoseOffset offset;
  offset.init(settings.pose);
  latency.begin_line(0.2f, rate_rad_s, 0);
  const MapComparison<small_limits> map(stages->dem, stages->mixture, stages->field, 10);
  for (std::uint32_t n = 1; n <= 20; ++n) {
    latency.begin_line(1.2f - 0.01f * static_cast<float>(n), -rate_rad_s, n);
    auto line = std::make_unique<ProjectedLine<small_limits>>();
    for (int j = 0; j < 24; ++j) {
      Point p{1.22f, 0.1f * static_cast<float>(j) + 0.08f, 0.0f, 1e-4f};
      p.shift_x_m = 0.03f;  // where the beams beside its own place it
      p.shift_y_m = -0.02f;
      p.z_m = ground_m(p.x_m, p.y_m) - growth_m_s * (lag_s - latency.offset_s());
      p.growth_m_s = growth_m_s;
      line->add(p);
    }
    map.follow_latency(*line, {}, offset, latency);
    latency.end_line(-rate_rad_s);
  }
  CHECK(latency.offset_s() == Approx(lag_s).margin(0.001));
}

TEST_CASE("map comparison: what a jump of the poses adds to variances is common to a line: many points tell no more") {
  LineMotion jumping;
  jumping.still = false;
  jumping.jumps.height_m2 = square(0.06f);
  Late calm, jumped;
  calm.look(12);
  jumped.look(12, jumping);
  const float prior_s2 = square(test::small_settings().tilt.latency_sd_s);
  const float line_s2 = jumping.blur_m2(0.0f, 0.0f) / square(growth_m_s);
  const float least_s2 = 1.0f / (1.0f / prior_s2 + 20.0f / line_s2);
  CHECK(square(calm.latency.sd_s()) < 0.1f * least_s2);
  CHECK(square(jumped.latency.sd_s()) > least_s2);
}

TEST_CASE("map comparison: ground that this sweep has seen, or that holds two surfaces, tells nothing of it") {
  Late seen, two;
  for (int j = 0; j < 24; ++j) {
    const float y_m = 0.1f * static_cast<float>(j) + 0.05f;
    seen.stages->dem.add({1.25f, y_m, slope_m(1.25f), 1e-4f});
  }
  seen.look(12);
  CHECK(seen.latency.offset_s() == 0.0f);
  for (int j = 0; j < 24; ++j) {
    const float y_m = 0.1f * static_cast<float>(j) + 0.05f;
    for (int k = 0; k < 4; ++k) two.stages->dem.add({1.25f, y_m, slope_m(1.25f) + 0.05f, 1e-4f});
  }
  two.stages->dem.begin_sweep();
  two.look(12);
  CHECK(two.latency.offset_s() == 0.0f);
}

TEST_CASE("map comparison: what covers the ground, such as a wall or a hedge, does not tell how late the tilt is") {
  Late late(0.4f);
  late.look(12);
  CHECK(late.latency.offset_s() == 0.0f);
  late.look(16);
  CHECK(late.latency.offset_s() == Approx(lag_s).margin(0.001));
}

TEST_CASE("map comparison: points beside the window are asked nothing") {
  Late outside;
  outside.look(24);
  CHECK(outside.latency.offset_s() == 0.0f);
}

/// Level ground seen before poses jump by 2 cm, and lines measured during the jump.
struct Jumping {
  Jumping() {
    test::fill(stages->dem, [](double, double) { return 0.0; });
    stages->settle();
    stages->dem.begin_marking();
    const Settings settings = test::small_settings();
    latency.init(settings.tilt, settings.pose);
    offset.init(test::noisy_poses());
    offset.begin_line(0.0f, 1.2f);
  }
  using Line = ProjectedLine<small_limits>;
  using JumpLine = MapComparison<small_limits>::JumpLine;
  /// A line across, with its points at this height.
  static std::unique_ptr<Line> line(float above_m, float slope_y = 0.0f) {
    auto line = std::make_unique<Line>();
    for (int j = 0; j < 24; ++j) {
      const float y_m = 0.1f * static_cast<float>(j) + 0.05f;
      line->add({1.25f, y_m, above_m + slope_y * (y_m - 1.2f), 1e-4f});
    }
    return line;
  }
  JumpLine check(Line& line, float attitude_rad = 0.007f, float height_m = 0.02f, bool climbs = false) const {
    const MapComparison<small_limits> map(stages->dem, stages->mixture, stages->field, 10);
    LineMotion motion;
    motion.still = false;
    motion.jumps = {square(height_m), square(attitude_rad)};
    motion.T_map_base_first.translation.y() = 1.2f;
    return map.check_jump(line, motion, climbs, latency, offset);
  }
  bool off(float above_m, float slope_y = 0.0f) const {
    const auto across = line(above_m, slope_y);
    const JumpLine lies = check(*across);
    CHECK(across->points().size() == 24);
    return lies == JumpLine::off_map;
  }

  std::unique_ptr<Stages<>> stages = std::make_unique<Stages<>>(test::small_settings());
  TiltLatency latency{};
  PoseOffset offset{};
};

TEST_CASE("map comparison: a line that was measured as poses jumped is off the map if it lies above or below it") {
  const Jumping jumping;
  CHECK(jumping.off(0.02f));
  CHECK(jumping.off(-0.02f));
  CHECK(jumping.off(0.0f, 0.02f));
  CHECK_FALSE(jumping.off(0.0f));
  CHECK_FALSE(jumping.off(0.003f));
  CHECK_FALSE(jumping.offset.undecided());
}

TEST_CASE(
    "map comparison: a line only on ground seen since the jump cannot be checked: points that may be off are left "
    "out") {
  const Jumping jumping;
  test::fill(jumping.stages->dem, [](double, double) { return 0.0; });
  const auto little = Jumping::line(0.02f), much = Jumping::line(0.02f);
  CHECK(jumping.check(*little, 0.001f, 0.01f) == Jumping::JumpLine::on_map);
  CHECK(little->points().size() == 24);
  CHECK(jumping.check(*much, 0.02f, 0.0f) == Jumping::JumpLine::in_part);
  // 0.02 rad / sqrt 6 at 1.25 m ahead is 10 mm, more than the 7 mm that the points of a cell share.
  CHECK(much->points().empty());
}

TEST_CASE(
    "map comparison: of a line that a turn alone may move, where there is no map the points near the robot stay") {
  const Jumping jumping;
  test::fill(jumping.stages->dem, [](double, double) { return 0.0; });
  const auto line = std::make_unique<Jumping::Line>();
  for (int i = 0; i < 24; ++i) line->add({0.1f * static_cast<float>(i) + 0.05f, 1.2f, 0.0f, 1e-4f});
  const float turn_rad = 0.02f, common_m2 = jumping.stages->dem.prior().common_m2();
  const float far_m = square_root(6.0f * common_m2) / turn_rad;
  CHECK(jumping.check(*line, turn_rad, 0.0f) == Jumping::JumpLine::in_part);
  REQUIRE(!line->points().empty());
  CHECK(line->points().front().x_m == Approx(0.05));
  CHECK(line->points().back().x_m < far_m);
  CHECK(line->points().back().x_m > far_m - 0.1f);
}

TEST_CASE(
    "map comparison: a line between the jumps of a robot that climbs is off the map if it lies above or below it") {
  const Jumping jumping;
  for (const float above_m : {0.03f, -0.03f})
    CHECK(jumping.check(*Jumping::line(above_m), 0.0f, 0.0f, true) == Jumping::JumpLine::off_map);
  for (const float above_m : {0.0f, 0.003f})
    CHECK(jumping.check(*Jumping::line(above_m), 0.0f, 0.0f, true) == Jumping::JumpLine::on_map);
}

TEST_CASE("map comparison: after a climb ground that is seen from farther than two cells away tells of no step") {
  const auto follow = [](int rows_seen_since) {
    Jumping jumping;
    for (int i = -rows_seen_since; i <= rows_seen_since; ++i) {
      for (int j = 0; j < 24; ++j)
        jumping.stages->dem.add(
            {1.25f + 0.1f * static_cast<float>(i), 0.1f * static_cast<float>(j) + 0.05f, 0.0f, 1e-4f});
    }
    const MapComparison<small_limits> map(jumping.stages->dem, jumping.stages->mixture, jumping.stages->field, 10);
    jumping.offset.follow({PoseStepNews::Kind::begun, {0.02f, 0.0f, 0.0f}});
    jumping.offset.follow({PoseStepNews::Kind::confirmed});
    map.follow_jump(*Jumping::line(0.02f), jumping.latency, jumping.offset);
    REQUIRE(jumping.offset.localisation_steps());
    jumping.offset.follow({PoseStepNews::Kind::climbed});
    for (int k = 0; k < 3 && jumping.offset.undecided(); ++k)
      map.follow_jump(*Jumping::line(0.03f), jumping.latency, jumping.offset);
    return jumping.offset;
  };
  CHECK(follow(1).offset().at(1.25f, 0.0f) == Approx(-0.05).margin(0.005));
  CHECK(follow(2).offset().at(1.25f, 0.0f) == Approx(-0.02).margin(0.005));
  CHECK(follow(2).undecided());
}

}  // namespace
}  // namespace curbline
