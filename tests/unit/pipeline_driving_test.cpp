// The pipeline of a robot that drives, or that jumps: the window follows, and curbs keep their position in the map.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "curbline/pipeline.hpp"
#include "support/nodding_pipeline.hpp"
#include "support/noisy_poses.hpp"

namespace curbline {
namespace {

using test::add_tilts;
using test::FullPipeline;
using test::longest;
using test::NoddingLaser;
using test::started;
using test::Street;

float length_m(const Curb& curb) {
  return std::hypot(curb.x1_m - curb.x0_m, curb.y1_m - curb.y0_m);
}

/// A drive at 0.25 m/s over a step, and the largest errors of the curb while its whole width was reported as a step.
/// Ahead is along the map's x axis, or turned from it by heading_rad.
struct Drive {
  std::unique_ptr<FullPipeline> pipeline;
  double worst_place_m = 0.0, worst_height_m = 0.0;
  int sightings = 0;
};

Drive drive(const Street& street, int lines, const Settings& settings, int first_without_pose = 0,
            int last_without_pose = 0, double heading_rad = 0.0) {
  Drive out{started(settings)};
  NoddingLaser laser;
  const auto x = [](double time_s) { return 0.25 * time_s; };
  const double cosine = std::cos(heading_rad), sine = std::sin(heading_rad);
  const auto pose = [&](double time_s) {
    Pose p{NoddingLaser::ns(time_s), static_cast<float>(cosine * x(time_s)), static_cast<float>(sine * x(time_s))};
    p.qz = static_cast<float>(std::sin(heading_rad / 2));
    p.qw = static_cast<float>(std::cos(heading_rad / 2));
    return p;
  };
  const auto ahead_m = [&](float x_m, float y_m) {
    return cosine * static_cast<double>(x_m) + sine * static_cast<double>(y_m);
  };
  for (int line = 0; line < lines; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    add_tilts(*out.pipeline, line);
    if (line < first_without_pose || line >= last_without_pose) {
      out.pipeline->add_pose(pose(t));
      out.pipeline->add_pose(pose(t + 0.02));
    }
    const auto ranges = laser.ranges(street, line, x);
    out.pipeline->take({NoddingLaser::ns(t), ranges});
    for (const Curb& curb : out.pipeline->curbs()) {
      if (curb.kind == CurbKind::crease || curb.kind == CurbKind::ramp_edge || length_m(curb) < 2.0f) continue;
      out.worst_place_m = std::max({out.worst_place_m, std::abs(ahead_m(curb.x0_m, curb.y0_m) - street.step_x_m),
                                    std::abs(ahead_m(curb.x1_m, curb.y1_m) - street.step_x_m)});
      out.worst_height_m =
          std::max(out.worst_height_m, std::abs(std::abs(static_cast<double>(curb.height_m)) - street.step_m));
      ++out.sightings;
    }
  }
  return out;
}

Settings driving_settings() {
  Settings settings = NoddingLaser::settings();
  settings.pose.still = false;
  return settings;
}

TEST_CASE("pipeline: while the robot drives the window follows and the curb stays where it is") {
  const Drive d = drive({3.5, 0.12}, 640, driving_settings());  // to x = 4 m: past the step
  CHECK(d.sightings > 100);
  CHECK(d.worst_place_m < 0.1);
  CHECK(d.worst_height_m < 0.02);
  // The window begins at the robot, to within half a block.
  CHECK(d.pipeline->dem().origin_x_m() == Approx(4.0).margin(0.21));
  CHECK(d.pipeline->dem().origin_y_m() == Approx(-2.0).margin(1e-4));
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const bool valid = d.pipeline->dem().cell(d.pipeline->dem().slot(i, j)).valid();
      CHECK((d.pipeline->label(i, j) != no_label) == valid);  // nothing remains of cells that were here before
    }
  }
}

//  \\  \\     along curbs that the way meets at 10 to 45 degrees: few borders lie on one row, or far ahead, and the
//  line
//   \\ ^\\    through them may pass the robot on either side
TEST_CASE("pipeline: a curb that the robot drives along is up where it is up, and down where it is down") {
  const double step_m = GENERATE(0.03, -0.03, 0.06);
  const auto x = [](double time_s) { return 0.08 * time_s; };
  double all_m = 0.0, wrong_m = 0.0;
  for (const double aslant_rad : {1.0, 1.2, 1.3}) {
    const Street street{1.2, step_m, aslant_rad};
    const double cosine = std::cos(aslant_rad), sine = std::sin(aslant_rad);
    const auto pipeline = started(driving_settings());
    NoddingLaser laser;
    for (int line = 0; line < 1000; ++line) {
      const double t = NoddingLaser::line_time_s(line);
      add_tilts(*pipeline, line);
      for (const double at : {t, t + 0.02}) pipeline->add_pose({NoddingLaser::ns(at), static_cast<float>(x(at))});
      const auto ranges = laser.ranges(street, line, x);
      pipeline->take({NoddingLaser::ns(t), ranges});
      const double away_m = 1.2 - cosine * x(t);
      if (line % 10 != 0 || std::abs(away_m) < 0.2) continue;
      for (const Curb& curb : pipeline->curbs()) {
        const double off_m = cosine * static_cast<double>(curb.x0_m + curb.x1_m) / 2 +
                             sine * static_cast<double>(curb.y0_m + curb.y1_m) / 2 - 1.2;
        if (!is_step(curb) || std::abs(off_m) > 0.15) continue;
        all_m += static_cast<double>(length_m(curb));
        if (static_cast<double>(curb.height_m) * step_m * away_m < 0.0) wrong_m += static_cast<double>(length_m(curb));
      }
    }
  }
  INFO("step of " << step_m << " m: " << wrong_m << " of " << all_m << " m");
  CHECK(all_m > 300.0);
  CHECK(wrong_m < 0.001 * all_m);
}

TEST_CASE("pipeline: the window lies ahead of the robot, whatever way it heads") {
  const double quarters = GENERATE(1.0, 2.0, 3.0, 0.5, 1.4);
  const Drive d = drive({3.5, 0.12}, 560, driving_settings(), 0, 0, quarters * pi / 2);  // to the step
  CHECK(d.sightings > 100);
  CHECK(d.worst_place_m < 0.1);
  CHECK(d.worst_height_m < 0.02);
  int valid = 0;
  d.pipeline->dem().for_each_valid([&](int, int, int) { ++valid; });
  CHECK(valid > 700);
}

TEST_CASE("pipeline: when the window moves a plane stays where it is in the map") {
  const auto pipeline = started(driving_settings());
  test::Noise noise;
  const auto slope =
      test::sample({0, 4, -2, 2}, 0.05, 0.005, noise, [](double x, double y) { return 0.1 * x - 0.05 * y; });
  pipeline->observe(slope);
  pipeline->settle();
  const int label = pipeline->label(20, 20);
  const auto height = [&](double x_m, double y_m) {
    return pipeline->plane(label).height_m(static_cast<float>(x_m) - pipeline->dem().origin_x_m(),
                                           static_cast<float>(y_m) - pipeline->dem().origin_y_m());
  };
  REQUIRE(height(2.0, 0.0) == Approx(0.2).margin(0.002));
  pipeline->add_pose({NoddingLaser::ns(0.0), 0.8f, -0.4f});
  add_tilts(*pipeline, 0);
  REQUIRE(pipeline->observe({NoddingLaser::ns(0.0), {}}) == Status::ok);
  REQUIRE(pipeline->dem().origin_x_m() == Approx(0.8));
  REQUIRE(pipeline->dem().origin_y_m() == Approx(-2.4));
  CHECK(height(2.0, 0.0) == Approx(0.2).margin(0.002));
}

TEST_CASE("pipeline: when the window moves on to another plane, however large, a plane keeps its label") {
  const auto pipeline = started(driving_settings());
  test::Noise noise;
  const auto observe = [&](double from_x_m, double to_x_m) {
    pipeline->observe(test::sample({from_x_m, to_x_m, -2, 2}, 0.05, 0.005, noise,
                                   [](double x, double) { return x < 4.0 ? 0.0 : -0.3; }));
    pipeline->settle();
  };
  observe(0.0, 4.0);
  const Label before = pipeline->label(30, 20);
  REQUIRE(before != no_label);
  pipeline->add_pose({NoddingLaser::ns(0.0), 2.4f});
  add_tilts(*pipeline, 0);
  REQUIRE(pipeline->observe({NoddingLaser::ns(0.0), {}}) == Status::ok);
  observe(4.0, 6.4);
  CHECK(pipeline->label(6, 20) == before);  // at the same position
  CHECK(pipeline->label(30, 20) != before);
}

TEST_CASE("pipeline: lines without a pose are dropped, and the map goes on when poses do") {
  const Drive d = drive({3.2, 0.12}, 600, driving_settings(), 300, 350);  // 1.25 s without poses
  CHECK(d.pipeline->counters().lines_dropped == 46);                      // the first ones are extrapolated, for 0.1 s
  CHECK(d.sightings > 400);
  CHECK(d.worst_place_m < 0.1);
  CHECK(d.worst_height_m < 0.02);
}

TEST_CASE("pipeline: with both tasks apart the window may move before labels follow") {
  // Lines are taken in at their own rate, inference runs every twentieth time.
  const auto pipeline = started(driving_settings());
  NoddingLaser laser;
  const auto x = [](double time_s) { return 0.25 * time_s; };
  for (int line = 0; line < 400; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    add_tilts(*pipeline, line);
    pipeline->add_pose({NoddingLaser::ns(t), static_cast<float>(x(t))});
    pipeline->add_pose({NoddingLaser::ns(t + 0.02), static_cast<float>(x(t + 0.02))});
    REQUIRE(pipeline->observe({NoddingLaser::ns(t), laser.ranges({4.0, 0.12}, line, x)}) == Status::ok);
    if (line % 20 == 19) pipeline->infer();
  }
  const Curb& curb = longest(pipeline->curbs());
  CHECK(curb.height_m == Approx(0.12).margin(0.02));
  CHECK(curb.x0_m == Approx(4.0).margin(0.1));
}

TEST_CASE("pipeline: a pose far off moves the window there and back, and the map starts afresh") {
  const auto pipeline = started(driving_settings());
  NoddingLaser laser;
  const float jump = GENERATE(1000.0f, 1e6f);
  for (int line = 0; line < 420; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    add_tilts(*pipeline, line);
    pipeline->add_pose({NoddingLaser::ns(t), line == 20 ? jump : 0.0f});
    pipeline->add_pose({NoddingLaser::ns(t + 0.02), line == 20 ? jump : 0.0f});
    REQUIRE(pipeline->take({NoddingLaser::ns(t), laser.ranges({}, line, [](double) { return 0.0; })}) == Status::ok);
  }
  CHECK(pipeline->dem().origin_x_m() == Approx(0.0).margin(1e-3));
  CHECK(longest(pipeline->curbs()).height_m == Approx(0.12).margin(0.01));
}

/// Number of lines with a step in view during a drive over level ground at 1 m/s. lag_s(time) is the delay of a servo
/// reading.
template <typename Lag>
int lines_with_steps(FullPipeline& pipeline, int lines, Lag&& lag_s) {
  NoddingLaser laser;
  const auto x = [](double time_s) { return time_s; };
  int with_steps = 0;
  for (int line = 0; line < lines; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    add_tilts(pipeline, line, lag_s);
    pipeline.add_pose({NoddingLaser::ns(t), static_cast<float>(x(t))});
    pipeline.add_pose({NoddingLaser::ns(t + 0.02), static_cast<float>(x(t + 0.02))});
    pipeline.take({NoddingLaser::ns(t), laser.ranges({1e4, 0.12}, line, x)});
    with_steps += std::any_of(pipeline.curbs().begin(), pipeline.curbs().end(), is_step);
  }
  return with_steps;
}

TEST_CASE("pipeline: while the robot drives over level ground a servo that is in time stays in time") {
  const auto pipeline = started(driving_settings());
  lines_with_steps(*pipeline, 8000, [](double) { return 0.0; });  // 200 m
  CHECK(std::abs(pipeline->tilt_latency().offset_s()) < 0.005f);
}

TEST_CASE("pipeline: while the robot drives, a servo that is late makes no steps of level ground") {
  const auto pipeline = started(driving_settings());
  CHECK(lines_with_steps(*pipeline, 2000, [](double) { return 0.02; }) == 0);
  CHECK(pipeline->tilt_latency().offset_s() == Approx(0.02).margin(0.003));
}

TEST_CASE("pipeline: while the robot drives, a servo that is late by another time in each sweep makes none either") {
  const auto pipeline = started(driving_settings());
  test::Noise lot(5);
  std::array<double, 12> lag_s{};
  for (double& lag : lag_s) lag = 0.01 + 0.005 * lot.normal();
  const auto of_its_sweep = [&](double time_s) {
    return lag_s.at(static_cast<std::size_t>(std::floor(time_s / NoddingLaser::sweep_s) + 1.0));
  };
  CHECK(lines_with_steps(*pipeline, 2000, of_its_sweep) == 0);
}

/// Drives over level ground at 0.5 m/s with a localisation that corrects itself: calls change(line, z_m, pitch_rad)
/// before each line and seen(pipeline) after it.
template <typename Change, typename Seen>
void drive_with_localisation(FullPipeline& pipeline, int lines, Change&& change, Seen&& seen) {
  NoddingLaser laser;
  const auto x = [](double time_s) { return 0.5 * time_s; };
  float z_m = 0.0f, pitch_rad = 0.0f;
  const auto pose = [&](double time_s) {
    return Pose{NoddingLaser::ns(time_s), static_cast<float>(x(time_s)), 0.0f, z_m, 0.0f, 0.5f * pitch_rad};
  };
  for (int line = 0; line < lines; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    change(line, z_m, pitch_rad);
    add_tilts(pipeline, line);
    pipeline.add_pose(pose(t));
    pipeline.add_pose(pose(t + 0.0125));
    pipeline.take({NoddingLaser::ns(t), laser.ranges({1e4, 0.12}, line, x)});
    seen(pipeline);
  }
}

std::unique_ptr<FullPipeline> with_noisy_poses() {
  Settings settings = driving_settings();
  settings.pose = test::noisy_poses();
  return started(settings);
}

TEST_CASE(
    "pipeline: while the robot drives, a localisation that thinks better of itself makes no steps of level ground") {
  test::Noise lot(1);
  int with_steps = 0;
  drive_with_localisation(
      *with_noisy_poses(), 2000,
      [&](int line, float& z_m, float& pitch_rad) {
        if (line % 160 != 70) return;
        z_m += lot.uniform() < 0.5 ? 0.02f : -0.02f;
        pitch_rad += lot.uniform() < 0.5 ? 0.007f : -0.007f;
      },
      [&](const FullPipeline& pipeline) {
        with_steps += std::any_of(pipeline.curbs().begin(), pipeline.curbs().end(), is_step);
      });
  CHECK(with_steps == 0);
}

TEST_CASE("pipeline: tells by what its map lies off the poses when a localisation has thought better of itself") {
  const auto pipeline = with_noisy_poses();
  float before_m = 1.0f, after_m = 0.0f;
  drive_with_localisation(
      *pipeline, 260, [](int line, float& z_m, float&) { z_m = line < 200 ? 0.0f : 0.02f; },
      [&, line = 0](const FullPipeline& p) mutable {
        (++line <= 200 ? before_m : after_m) = p.pose_offset().height_m;
      });
  CHECK(before_m == Approx(0.0).margin(0.001));
  CHECK(after_m == Approx(-0.02).margin(0.003));
}

/// Drives over level ground at 0.5 m/s and, after five seconds, up by 16 cm within a twentieth of a second. The
/// localisation steps by before_m on the level ground, and by step_m while the robot climbs. Returns the final offset
/// of the map from the poses.
float offset_after_climb_m(float before_m, float step_m) {
  constexpr double level_s = 2.5, climb_s = 5.0;
  const auto pipeline = with_noisy_poses();
  NoddingLaser laser;
  const auto x = [](double time_s) { return 0.5 * time_s; };
  const auto risen_m = [](double time_s) { return 0.16 * std::clamp(20.0 * (time_s - climb_s), 0.0, 1.0); };
  for (int line = 0; line < 260; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    add_tilts(*pipeline, line);
    for (const double time_s : {t, t + 0.0125}) {
      const double off_m = (time_s < level_s ? 0.0 : before_m) + (time_s < climb_s + 0.02 ? 0.0 : step_m);
      pipeline->add_pose(
          {NoddingLaser::ns(time_s), static_cast<float>(x(time_s)), 0.0f, static_cast<float>(risen_m(time_s) + off_m)});
    }
    pipeline->take({NoddingLaser::ns(t), laser.ranges({-1.0, -risen_m(t)}, line, x)});
  }
  return pipeline->pose_offset().height_m;
}

TEST_CASE("pipeline: a localisation that steps, and does so while the robot climbs too, is found out each time") {
  CHECK(offset_after_climb_m(0.02f, 0.03f) == Approx(-0.05).margin(0.008));
  CHECK(offset_after_climb_m(0.02f, -0.03f) == Approx(0.01).margin(0.008));
  CHECK(offset_after_climb_m(0.02f, 0.0f) == Approx(-0.02).margin(0.004));
}

TEST_CASE("pipeline: of a localisation that was never found to step a climb is the robot's") {
  CHECK(offset_after_climb_m(0.0f, 0.0f) == 0.0f);
  CHECK(offset_after_climb_m(0.0f, 0.03f) == 0.0f);
}

/// A pipeline driven over level ground at 0.5 m/s until poses rise while a line is measured, and the points of that
/// line. The heights of the last poses are given, 80 a second; the last pose is later than the line. The robot itself
/// rises by robot_m before the line.
struct Rise {
  std::unique_ptr<FullPipeline> pipeline = with_noisy_poses();
  std::vector<Point> points;
  std::uint32_t outside = 0;  ///< as counted for that line, taken or not
};

Rise rise(const std::vector<float>& last_poses_m, double robot_m) {
  constexpr int last_line = 230;
  Rise out;
  NoddingLaser laser;
  const auto x = [](double time_s) { return 0.5 * time_s; };
  const int first = 2 * last_line + 2 - static_cast<int>(last_poses_m.size());
  for (int line = 0; line <= last_line; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    add_tilts(*out.pipeline, line);
    for (int k = 2 * line; k <= 2 * line + 1; ++k) {  // the line takes 6 ms; they are 3 ms before and 3 ms after it
      const double time_s = 0.0125 * k - 0.003;
      const float z_m = k < first ? 0.0f : last_poses_m[static_cast<std::size_t>(k - first)];
      REQUIRE(out.pipeline->add_pose({NoddingLaser::ns(time_s), static_cast<float>(x(time_s)), 0.0f, z_m}));
    }
    const Street below{-1.0, line == last_line ? -robot_m : 0.0};
    out.points.clear();
    const auto ranges = laser.ranges(below, line, x);
    const std::uint32_t before = out.pipeline->counters().outside;
    out.pipeline->project({NoddingLaser::ns(t), ranges}, [&](const Point& p) { out.points.push_back(p); });
    out.outside = out.pipeline->counters().outside - before;
    out.pipeline->observe(out.points);
    out.pipeline->infer();
  }
  return out;
}

TEST_CASE("pipeline: a line is left out of the map if a localisation has stepped meanwhile, not if the robot has") {
  const Rise stepped = rise({0.02f}, 0.0), bumped = rise({0.02f}, 0.01);
  CHECK(stepped.points.empty());
  CHECK(stepped.pipeline->counters().lines_off_map == 1);
  CHECK(bumped.points.size() > 200);
  CHECK(bumped.pipeline->counters().lines_off_map == 0);
}

TEST_CASE("pipeline: of a line that is left out of the map, what lies outside is counted as of any other") {
  const Rise stepped = rise({0.02f}, 0.0), bumped = rise({0.02f}, 0.01);
  CHECK(bumped.outside > 100);
  CHECK(stepped.outside > 100);
}

/// Poses of a climbing robot: the last ones, and its height halfway between the last two.
const std::vector<float> climb{0.05f, 0.1f};
constexpr double half_way_m = 0.075;

TEST_CASE(
    "pipeline: a line that is measured while the robot climbs is taken where the map has it, and counts for less") {
  const Rise climbs = rise(climb, half_way_m);
  REQUIRE(climbs.points.size() > 200);
  CHECK(climbs.pipeline->counters().lines_off_map == 0);
  const float jump_m = 0.1f - 0.05f - 0.05f / 4;  // relative to where the four poses before it lead
  CHECK(std::all_of(climbs.points.begin(), climbs.points.end(),
                    [&](const Point& p) { return p.variance_m2 > square(jump_m) / 6; }));
}

TEST_CASE("pipeline: a line that is measured while the robot climbs is left out if its poses are late") {
  const Rise late = rise(climb, half_way_m + 0.05);
  CHECK(late.points.empty());
  CHECK(late.pipeline->counters().lines_off_map == 1);
}

/// All that a pipeline reports, line by line, during a drive at 0.5 m/s that begins with line `first`, up to a step.
/// The servo is late, the localisation steps after 100 and after 180 lines, and the robot climbs from the 150th line
/// on.
std::vector<float> told_on_the_way(FullPipeline& pipeline, int first, int lines) {
  std::vector<float> told;
  NoddingLaser laser;
  const double begin_s = NoddingLaser::line_time_s(first);
  const auto x = [=](double time_s) { return 0.5 * (time_s - begin_s); };
  for (int line = first; line < first + lines; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    const double off_m = line < first + 100 ? 0.0 : line < first + 180 ? 0.02 : -0.01;
    add_tilts(pipeline, line, [](double) { return 0.02; });
    for (const double time_s : {t, t + 0.0125}) {
      const double risen_m = std::clamp(time_s - begin_s - 3.75, 0.0, 0.1);
      pipeline.add_pose(
          {NoddingLaser::ns(time_s), static_cast<float>(x(time_s)), 0.0f, static_cast<float>(risen_m + off_m)});
    }
    pipeline.take({NoddingLaser::ns(t), laser.ranges({4.0, 0.12}, line, x)});
    const Counters& counters = pipeline.counters();
    for (const std::uint32_t count : {counters.lines, counters.points, counters.evidences, counters.messages})
      told.push_back(static_cast<float>(count));
    for (const Curb& curb : pipeline.curbs())
      told.insert(told.end(), {curb.x0_m, curb.y0_m, curb.height_m, curb.height_sd_m, static_cast<float>(curb.id)});
    told.insert(told.end(), {pipeline.tilt_latency().offset_s(), pipeline.pose_offset().height_m});
  }
  return told;
}

TEST_CASE("pipeline: after init() a drive goes as with a new one, whatever it was in the middle of before") {
  const int before = GENERATE(1, 101, 102, 153, 190, 239);
  for (const int first : {0, before}) {  // the clock was set back, or goes on
    const auto used = with_noisy_poses(), fresh = with_noisy_poses();
    told_on_the_way(*used, 0, before);
    REQUIRE(used->init(used->settings()) == Status::ok);
    CHECK((told_on_the_way(*used, first, 200) == told_on_the_way(*fresh, first, 200)));
  }
}

TEST_CASE("pipeline: poses that jump all the time leave a map, as they have it") {
  const auto pipeline = with_noisy_poses();
  NoddingLaser laser;
  const auto x = [](double time_s) { return 0.5 * time_s; };
  std::size_t points = 0;
  int pose = 0;
  for (int line = 0; line < 200; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    add_tilts(*pipeline, line);
    for (; 0.025 * pose < t + 0.055; ++pose) {  // two localisations in turn, 2 cm apart
      const double time_s = 0.025 * pose;
      const float z_m = pose % 2 == 0 ? 0.0f : 0.02f;
      REQUIRE(pipeline->add_pose({NoddingLaser::ns(time_s), static_cast<float>(x(time_s)), 0.0f, z_m}));
    }
    const auto ranges = laser.ranges({-1.0, 0.0}, line, x);
    const std::uint32_t before = pipeline->counters().points;
    pipeline->take({NoddingLaser::ns(t), ranges});
    if (line >= 100) points += pipeline->counters().points - before;
  }
  CHECK(points > 100 * 150);
}

}  // namespace
}  // namespace curbline
