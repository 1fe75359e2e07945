// The whole chain from scan lines to curbs: what is refused, what is survived, and what stays the same.
#include "curbline/pipeline.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "support/heap_count.hpp"
#include "support/nodding_pipeline.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

using test::add_tilts;
using test::FullPipeline;
using test::longest;
using test::NoddingLaser;
using test::started;
using test::Street;

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();

/// Takes lines [first, last) of a robot that stands in front of a street.
void stand(FullPipeline& pipeline, NoddingLaser& laser, const Street& street, int first, int last) {
  for (int line = first; line < last; ++line) {
    add_tilts(pipeline, line);
    const auto ranges = laser.ranges(street, line, [](double) { return 0.0; });
    REQUIRE(pipeline.take({NoddingLaser::ns(NoddingLaser::line_time_s(line)), ranges}) == Status::ok);
  }
}

/// The finished map of these points.
std::unique_ptr<FullPipeline> map_of(const std::vector<Point>& points,
                                     const Settings& settings = NoddingLaser::settings()) {
  auto pipeline = started(settings);
  pipeline->observe(points);
  pipeline->settle();
  return pipeline;
}

/// Everything about curbs except their numbers, which depend on how often they were traced.
std::vector<char> bytes(std::span<const Curb> curbs) {
  std::vector<char> out;
  for (const Curb& c : curbs) {
    for (const float v :
         {c.x0_m, c.y0_m, c.x1_m, c.y1_m, c.position_sd_m, c.height_m, c.height_sd_m, c.probability, c.face_width_m}) {
      const char* p = reinterpret_cast<const char*>(&v);
      out.insert(out.end(), p, p + sizeof v);
    }
    out.push_back(static_cast<char>(c.kind));
    out.push_back(static_cast<char>(c.near_label));
    out.push_back(static_cast<char>(c.far_label));
  }
  return out;
}

std::vector<std::uint16_t> ids(std::span<const Curb> curbs) {
  std::vector<std::uint16_t> out;
  for (const Curb& c : curbs) out.push_back(c.id);
  return out;
}

TEST_CASE("pipeline: with the default limits it fits into the 160 KiB that are promised") {
  CHECK(sizeof(FullPipeline) <= 160 * 1024);
}

TEST_CASE("pipeline: a step ahead is found with its place, height and direction from one sweep") {
  const double step = GENERATE(0.12, -0.15);
  const auto pipeline = started();
  NoddingLaser laser;
  stand(*pipeline, laser, {2.0, step}, 0, 200);
  const Curb& curb = longest(pipeline->curbs());
  CHECK(curb.kind == (step > 0.0 ? CurbKind::step_up : CurbKind::step_down));
  CHECK(curb.height_m == Approx(step).margin(4 * curb.height_sd_m + 0.005));
  // Half a cell; behind a step down the ground is hidden for |step| * 2 m / 1 m, and the border lies in the middle of
  // the gap.
  const double hidden = step < 0.0 ? -step * 2.0 : 0.0;
  CHECK(curb.x0_m == Approx(2.0 + 0.5 * hidden).margin(0.05 + 0.5 * hidden));
  CHECK(curb.x1_m == Approx(2.0 + 0.5 * hidden).margin(0.05 + 0.5 * hidden));
  CHECK(std::abs(curb.y1_m - curb.y0_m) > 3.0f);
  CHECK(pipeline->counters().lines == 200);
}

//           ___      35 cm wide; nothing beyond it is seen
//          |
//  ________|
TEST_CASE("pipeline: a narrow top is a wall's for a robot that stands, for one that drives it may be a pavement's") {
  const auto is_ground = [](bool still) {
    Settings settings = NoddingLaser::settings();
    settings.pose.still = still;
    test::Noise noise;
    const auto pipeline = map_of(
        test::sample({0, 2.35, -2, 2}, 0.05, 0.005, noise, [](double x, double) { return x < 2.0 ? 0.0 : 0.25; }),
        settings);
    return pipeline->label(21, 20) != pipeline->label(10, 20);
  };
  CHECK_FALSE(is_ground(true));
  CHECK(is_ground(false));
}

//      __.--.__       two planes or more, one surface
TEST_CASE(
    "pipeline: cells of a cambered road are of one surface, by the label of one of its planes, before init() of none") {
  const auto pipeline = started(NoddingLaser::settings());
  test::Noise noise;
  pipeline->observe(test::sample({0, 4, -2, 2}, 0.05, 0.003, noise, [](double, double y) { return -0.0125 * y * y; }));
  pipeline->settle();
  std::set<Label> planes, surfaces;
  for (int i = 0; i < pipeline->dem().rows(); ++i) {
    for (int j = 0; j < pipeline->dem().cols(); ++j) {
      planes.insert(pipeline->label(i, j));
      surfaces.insert(pipeline->surface(pipeline->label(i, j)));
    }
  }
  CHECK(planes.size() >= 2);
  CHECK(surfaces == std::set<Label>{*planes.begin()});
  CHECK(pipeline->curbs().empty());
  CHECK(pipeline->surface(no_label) == no_label);
  CHECK(std::make_unique<FullPipeline>()->surface(1) == 1);
}

TEST_CASE("pipeline: rain in one beam of fifty moves no curb, makes none, and takes little of the ground to drive on") {
  const auto dry = started(), wet = started();
  NoddingLaser laser, same;
  stand(*dry, laser, {2.0, 0.04}, 0, 200);
  test::Noise rain(5);
  for (int line = 0; line < 200; ++line) {
    add_tilts(*wet, line);
    auto ranges = same.ranges({2.0, 0.04}, line, [](double) { return 0.0; });
    for (float& range_m : ranges) {
      const bool drop = rain.uniform() < 0.02;
      const auto drop_m = static_cast<float>(0.3 + 2.7 * rain.uniform());
      if (drop && drop_m < range_m) range_m = drop_m;
    }
    REQUIRE(wet->take({NoddingLaser::ns(NoddingLaser::line_time_s(line)), ranges}) == Status::ok);
  }
  float length_m = 0.0f;
  for (const Curb& curb : wet->curbs()) {
    INFO(to_string(curb.kind) << " of " << curb.height_m << " m at " << curb.x0_m << ", " << curb.y0_m);
    CHECK(curb.x0_m == Approx(2.0).margin(0.01));
    CHECK(curb.x1_m == Approx(2.0).margin(0.01));
    CHECK(curb.height_m == Approx(0.04).margin(0.005));
    length_m += std::abs(curb.y1_m - curb.y0_m);
  }
  CHECK(length_m > 3.5f);
  const auto passable = [](const FullPipeline& pipeline) {
    int cells = 0;
    for (int i = 0; i < pipeline.dem().rows(); ++i)
      for (int j = 0; j < pipeline.dem().cols(); ++j) cells += pipeline.passable(i, j, 0.1f, 0.1f);
    return cells;
  };
  CHECK(passable(*wet) > 0.9 * passable(*dry));
  CHECK(wet->counters().echoes_alone > 500);
}

TEST_CASE("pipeline: a curb beyond which nothing is seen is not passable, whatever the robot takes") {
  const auto pipeline = started();
  std::vector<Point> face;  // of a curb, from x = 1.2 to 1.5 m
  for (float x = 0.01f; x < 1.5f; x += 0.02f) {
    for (float y = -1.0f; y < 1.0f; y += 0.02f) face.push_back({x, y, x < 1.2f ? 0.0f : 0.4f * (x - 1.2f), 1e-4f});
  }
  pipeline->observe(face);
  pipeline->settle();
  int ends = 0;
  for (const Curb& curb : pipeline->curbs()) {
    const bool end = curb.far_label == no_label;
    ends += end;
    CHECK(pipeline->passable(curb, 1.0f, 1.0f) == !end);
  }
  CHECK(ends == 1);
}

TEST_CASE("pipeline: a cell is in the way in which a drop begins, though all that is seen of it is above the edge") {
  const double edge_m = GENERATE(2.03, 2.05, 2.07, 2.09);
  const auto pipeline = started();
  NoddingLaser laser;
  stand(*pipeline, laser, {edge_m, -0.12}, 0, 200);
  int before = 0, at = 0;
  for (int j = 10; j < 30; ++j) {
    before += pipeline->passable(18, j, 0.04f, 0.1f);
    at += pipeline->passable(20, j, 0.04f, 0.1f);
    CHECK(pipeline->label(20, j) != no_label);
  }
  CHECK(before == 20);
  CHECK(at == 0);
}

TEST_CASE("pipeline: outside the window no cell is passable and none has a label") {
  const auto pipeline = started();
  std::vector<Point> level;
  for (float x = 0.01f; x < 4.0f; x += 0.02f) {
    for (float y = -1.99f; y < 2.0f; y += 0.02f) level.push_back({x, y, 0.0f, 1e-4f});
  }
  pipeline->observe(level);
  pipeline->settle();
  const int rows = pipeline->dem().rows(), cols = pipeline->dem().cols();
  for (const auto& [i, j] : {std::pair{0, 0}, {rows - 1, cols - 1}}) {
    CHECK(pipeline->passable(i, j, 0.1f, 0.1f));
    CHECK(pipeline->label(i, j) != no_label);
  }
  for (const auto& [i, j] : {std::pair{-1, 5}, {5, -1}, {rows, 5}, {5, cols}, {-rows, 5}, {rows, cols}, {1 << 30, 5}}) {
    INFO("cell " << i << ", " << j);
    CHECK_FALSE(pipeline->passable(i, j, 0.1f, 0.1f));
    CHECK(pipeline->label(i, j) == no_label);
    CHECK(pipeline->ground_label(i, j) == no_label);
    CHECK(pipeline->label_probability(i, j) == 0.0f);
  }
}

/// A front of 0.6 m, a metre wide, before the step of a street.
float with_front(float range_m, int beam, int line) {
  const double bearing = -0.5 * pi + pi / 360.0 * beam;
  const double tilt = NoddingLaser::tilt_rad(NoddingLaser::line_time_s(line) +
                                             static_cast<double>(LaserSettings{}.beam_interval_s) * beam);
  const double to_front_m = 1.4 / (std::cos(bearing) * std::cos(tilt));
  const double y_m = to_front_m * std::sin(bearing), z_m = 1.0 - to_front_m * std::cos(bearing) * std::sin(tilt);
  const bool hit = std::abs(y_m) < 0.5 && z_m > 0.0 && z_m < 0.6 && to_front_m > 0.0;
  return hit ? std::min(range_m, static_cast<float>(to_front_m)) : range_m;
}

/// Number of passable cells between the robot and the step, straight ahead.
int passable_ahead(const FullPipeline& pipeline) {
  int out = 0;
  for (int i = 10; i < 18; ++i) {
    for (int j = 16; j < 24; ++j) out += pipeline.passable(i, j, 0.03f, 0.2f);
  }
  return out;
}

TEST_CASE(
    "pipeline: a person who stood before a stationary robot is forgotten after leaving, an object put down is seen") {
  const auto pipeline = started();
  NoddingLaser laser;
  const Street street{2.0, 0.12};
  const int sweep = 200, before = 6 * sweep;
  const int stays = GENERATE(1, 4) * sweep;
  stand(*pipeline, laser, street, 0, before);
  const int free = passable_ahead(*pipeline);
  REQUIRE(free == 64);
  const auto told = [&] { return longest(pipeline->curbs()); };
  for (int line = before; line < before + stays; ++line) {
    add_tilts(*pipeline, line);
    auto ranges = laser.ranges(street, line, [](double) { return 0.0; });
    for (int b = 0; b < NoddingLaser::beams; ++b) {
      auto& range_m = ranges[static_cast<std::size_t>(b)];
      range_m = with_front(range_m, b, line);
    }
    REQUIRE(pipeline->take({NoddingLaser::ns(NoddingLaser::line_time_s(line)), ranges}) == Status::ok);
  }
  CHECK(passable_ahead(*pipeline) < free - 6);  // the front's own cells are not passable
  stand(*pipeline, laser, street, before + stays, before + stays + 8 * sweep);
  CHECK(passable_ahead(*pipeline) == free);
  CHECK(told().height_m == Approx(0.12).margin(0.01));
  CHECK(std::abs(told().y1_m - told().y0_m) > 3.0f);
}

TEST_CASE("pipeline: settings beyond the limits, or bad, are refused with the status that names them") {
  const auto pipeline = std::make_unique<FullPipeline>();
  const auto init = [&](auto&& change) {
    Settings s = NoddingLaser::settings();
    change(s);
    return pipeline->init(s);
  };
  CHECK(init([](Settings& s) { s.window.rows = 44; }) == Status::bad_window);
  CHECK(init([](Settings& s) { s.window.cols = 44; }) == Status::bad_window);
  CHECK(init([](Settings& s) { s.laser.beams = 1082; }) == Status::bad_laser);
  CHECK(init([](Settings& s) { s.window.cell_x_m = 0.0f; }) == Status::bad_window);
  CHECK(init([](Settings& s) { s.laser.range_sd_m = nan; }) == Status::bad_laser);
  CHECK(init([](Settings& s) { s.tilt.max_gap_s = 0.0f; }) == Status::bad_tilt);
  CHECK(init([](Settings& s) { s.pose.height_sd_m = -1.0f; }) == Status::bad_pose);
  CHECK(init([](Settings& s) { s.labels.coupling = 0.0f; }) == Status::bad_inference);
  CHECK(init([](Settings&) {}) == Status::ok);
}

TEST_CASE("pipeline: heights are expected to err by no less than ranges make them, where rays fall at 45 degrees") {
  const auto noise_m = [](float range_sd_m, float expected_m) {
    Settings settings = NoddingLaser::settings();
    settings.laser.range_sd_m = range_sd_m;
    settings.planes.prior.noise_m2 = expected_m * expected_m;
    return std::sqrt(double{started(settings)->dem().prior().noise_m2});
  };
  CHECK(noise_m(0.03f, 0.01f) == Approx(0.0212).epsilon(0.01));
  CHECK(noise_m(0.03f, 0.025f) == Approx(0.025));
  CHECK(noise_m(0.012f, 0.01f) == Approx(0.01));
}

TEST_CASE("pipeline: before init, and after a refused one, it takes nothing and answers so") {
  const auto pipeline = std::make_unique<FullPipeline>();
  const std::vector<float> ranges(10, 2.0f);
  const Point point{1.0f, 0.0f, 0.0f, 1e-4f};
  const auto takes_nothing = [&] {
    CHECK(pipeline->take({NoddingLaser::epoch_ns, ranges}) == Status::not_initialised);
    pipeline->observe(std::span<const Point>(&point, 1));
    pipeline->infer();
    CHECK(pipeline->settle() == 0);
    CHECK(pipeline->curbs().empty());
    CHECK(pipeline->counters().points == 0);
  };
  takes_nothing();
  Settings bad = NoddingLaser::settings();
  bad.laser.beams = 0;
  CHECK(pipeline->init(bad) == Status::bad_laser);
  takes_nothing();
}

TEST_CASE("pipeline: before init, and after a refused one, lines and poses are counted as dropped") {
  const auto pipeline = std::make_unique<FullPipeline>();
  const std::vector<float> ranges(10, 2.0f);
  const auto drops = [&](std::uint32_t lines, std::uint32_t poses) {
    CHECK(pipeline->take({NoddingLaser::epoch_ns, ranges}) == Status::not_initialised);
    CHECK_FALSE(pipeline->add_pose({NoddingLaser::epoch_ns}));
    CHECK(pipeline->counters().lines_dropped == lines);
    CHECK(pipeline->counters().poses_dropped == poses);
  };
  drops(1, 1);
  Settings bad = NoddingLaser::settings();
  bad.laser.beams = 0;
  REQUIRE(pipeline->init(bad) == Status::bad_laser);
  drops(2, 2);
}

TEST_CASE("pipeline: after a refused init nothing is left of what it told before") {
  Settings settings = NoddingLaser::settings();
  const auto pipeline = started(settings);
  NoddingLaser laser;
  stand(*pipeline, laser, {2.0, 0.12}, 0, 200);
  REQUIRE_FALSE(pipeline->curbs().empty());
  const Curb curb = longest(pipeline->curbs());
  REQUIRE(pipeline->passable(10, 20, 0.03f, 0.2f));
  settings.laser.beams = 0;
  REQUIRE(pipeline->init(settings) == Status::bad_laser);
  CHECK(pipeline->curbs().empty());
  CHECK(pipeline->label(10, 20) == no_label);
  CHECK_FALSE(pipeline->passable(10, 20, 0.03f, 0.2f));
  CHECK_FALSE(pipeline->passable(curb, 1.0f, 1.0f));
  CHECK_FALSE(pipeline->add_pose({NoddingLaser::epoch_ns}));
}

TEST_CASE("pipeline: each bad line is answered with its reason, counted, and changes nothing else") {
  const auto pipeline = started();
  NoddingLaser laser;
  stand(*pipeline, laser, {}, 0, 50);
  const auto before = bytes(pipeline->curbs());
  const auto points = pipeline->counters().points;
  const std::vector<float> ranges(NoddingLaser::beams, 2.0f), long_line(NoddingLaser::beams + 1, 2.0f);
  const std::int64_t last = NoddingLaser::ns(NoddingLaser::line_time_s(49));
  CHECK(pipeline->take({last, ranges}) == Status::line_out_of_order);
  CHECK(pipeline->take({last - 1000, ranges}) == Status::line_out_of_order);
  CHECK(pipeline->take({last + 25'000'000, long_line}) == Status::line_too_long);
  CHECK(pipeline->take({last + 2'000'000'000, ranges}) == Status::no_tilt);
  CHECK(pipeline->counters().lines_dropped == 4);
  CHECK(pipeline->counters().lines == 50);
  CHECK(pipeline->counters().points == points);
  CHECK(bytes(pipeline->curbs()) == before);
}

TEST_CASE("pipeline: when the clock is set back it goes on within half a second, and finds the same curbs") {
  const auto pipeline = started(), untouched = started();
  NoddingLaser laser, same;
  constexpr int before = 120, after = 220;
  stand(*untouched, same, {}, 0, after);
  stand(*pipeline, laser, {}, 0, before);
  int dropped = 0;
  for (int line = before; line < after; ++line) {
    constexpr std::int64_t hour_ns = 3'600'000'000'000;
    const double time_s = NoddingLaser::line_time_s(line);
    for (const double tilt_s : {time_s + 0.01, time_s + 0.02, time_s + 0.03}) {
      pipeline->add_tilt({NoddingLaser::ns(tilt_s) - hour_ns, static_cast<float>(NoddingLaser::tilt_rad(tilt_s))});
    }
    const auto ranges = laser.ranges(Street{}, line, [](double) { return 0.0; });
    dropped += pipeline->take({NoddingLaser::ns(time_s) - hour_ns, ranges}) != Status::ok;
  }
  CHECK(dropped < 20);
  REQUIRE(pipeline->curbs().size() == untouched->curbs().size());
  CHECK(pipeline->curbs()[0].height_m == Approx(untouched->curbs()[0].height_m).margin(0.003));
}

TEST_CASE("pipeline: a robot that moves needs poses") {
  Settings settings = NoddingLaser::settings();
  settings.pose.still = false;
  const auto pipeline = started(settings);
  add_tilts(*pipeline, 0);
  const std::vector<float> ranges(NoddingLaser::beams, 2.0f);
  CHECK(pipeline->take({NoddingLaser::ns(0.0), ranges}) == Status::no_pose);
  CHECK(pipeline->add_pose({NoddingLaser::ns(0.0)}));
  CHECK(pipeline->take({NoddingLaser::ns(0.0), ranges}) == Status::ok);
  CHECK_FALSE(pipeline->add_pose({NoddingLaser::ns(0.0)}));
  CHECK(pipeline->counters().poses_dropped == 1);
}

TEST_CASE("pipeline: a laser at a fixed tilt needs no servo") {
  Settings settings = NoddingLaser::settings();
  settings.tilt.fixed = true;
  settings.tilt.fixed_tilt_rad = 0.5f;
  const auto pipeline = started(settings);
  CHECK(pipeline->take({NoddingLaser::ns(0.0), std::vector<float>(NoddingLaser::beams, 2.0f)}) == Status::ok);
  CHECK(pipeline->counters().points > 0);
}

TEST_CASE("pipeline: bad data leave no trace: the curbs are the same to the bit") {
  const auto clean = started(), plagued = started();
  NoddingLaser laser, same;
  stand(*clean, laser, {}, 0, 220);
  stand(*plagued, same, {}, 0, 100);
  const std::int64_t now = NoddingLaser::ns(NoddingLaser::line_time_s(99));
  const std::vector<float> ranges(NoddingLaser::beams, 1.5f), long_line(2000, 1.5f);
  plagued->add_tilt({now - 1'000'000'000, 0.3f});
  plagued->add_tilt({now + 500'000'000, nan});
  plagued->add_tilt({now + 500'000'000, infinity});
  plagued->add_pose({now, nan});
  plagued->take({now, ranges});
  plagued->take({now - 1'000'000'000, ranges});
  plagued->take({now + 12'000'000, long_line});
  plagued->take({now + 10'000'000'000, ranges});
  const std::vector<Point> points{{nan, 0.0f, 0.0f, 1e-4f},       {1.0f, infinity, 0.0f, 1e-4f},
                                  {1.0f, 0.0f, -infinity, 1e-4f}, {1.0f, 0.0f, 0.0f, nan},
                                  {1e30f, 0.0f, 0.0f, 1e-4f},     {-5.0f, 0.0f, 0.0f, 1e-4f}};
  plagued->observe(points);
  CHECK(plagued->counters().tilt_dropped <= 3);
  stand(*plagued, same, {}, 100, 220);
  CHECK(plagued->counters().tilt_dropped == 3);
  CHECK(plagued->counters().poses_dropped == 1);
  CHECK(plagued->counters().lines_dropped == 4);
  CHECK(bytes(plagued->curbs()) == bytes(clean->curbs()));
  CHECK(ids(plagued->curbs()) == ids(clean->curbs()));
  CHECK_FALSE(clean->curbs().empty());
}

TEST_CASE("pipeline: tilt readings that are damaged in the first sweep leave no wrong latency behind") {
  const auto pipeline = started();
  NoddingLaser laser;
  // The reading before every eighth line of the first 2.5 s is ahead by 0.3 s, so that from it to the next the servo
  // goes back.
  const auto lag_s = [](double time_s) {
    const double line = (time_s + 0.005) / NoddingLaser::line_s;
    const bool before_line = std::abs(line - std::round(line)) < 0.01;
    return before_line && line < 100.5 && std::lround(line) % 8 == 5 ? -0.3 : 0.0;
  };
  for (int line = 0; line < 500; ++line) {
    add_tilts(*pipeline, line, lag_s);
    const auto ranges = laser.ranges(Street{}, line, [](double) { return 0.0; });
    REQUIRE(pipeline->take({NoddingLaser::ns(NoddingLaser::line_time_s(line)), ranges}) == Status::ok);
  }
  CHECK(std::abs(pipeline->tilt_latency().offset_s()) < 0.002f);
  const Curb& curb = longest(pipeline->curbs());
  CHECK(curb.height_m == Approx(Street{}.step_m).margin(0.003));
  CHECK(curb.x0_m == Approx(Street{}.step_x_m).margin(0.05));
  CHECK(curb.x1_m == Approx(Street{}.step_x_m).margin(0.05));
}

TEST_CASE("pipeline: a line whose ranges are all bad is taken and does nothing") {
  const auto pipeline = started();
  add_tilts(*pipeline, 0);
  std::vector<float> ranges(NoddingLaser::beams);
  for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i] = i % 3 == 0 ? nan : i % 3 == 1 ? infinity : -1.0f;
  CHECK(pipeline->take({NoddingLaser::ns(0.0), ranges}) == Status::ok);
  CHECK(pipeline->take({NoddingLaser::ns(0.001), {}}) == Status::ok);
  CHECK(pipeline->counters().no_returns == NoddingLaser::beams);
  CHECK(pipeline->counters().points == 0);
  CHECK(pipeline->curbs().empty());
}

TEST_CASE("pipeline: points above the ceiling are ignored") {
  Settings settings = NoddingLaser::settings();
  settings.window.max_height_m = 0.5f;
  const auto pipeline = started(settings);
  const std::vector<Point> points{{1.0f, 0.0f, 0.4f, 1e-4f}, {1.0f, 0.0f, 0.6f, 1e-4f}};
  pipeline->observe(points);
  CHECK(pipeline->counters().points == 1);
  CHECK(pipeline->counters().outside == 1);
}

TEST_CASE(
    "pipeline: the beams of a line that return fall in cells or count as outside, of the sky and of what is far away") {
  const auto pipeline = started();
  add_tilts(*pipeline, 0);
  std::vector<float> ranges(NoddingLaser::beams, 1.5f);
  for (std::size_t i = 0; i < ranges.size(); i += 3) ranges[i] = 9.0f;
  REQUIRE(pipeline->take({NoddingLaser::ns(0.0), ranges}) == Status::ok);
  CHECK(pipeline->counters().no_returns == 0);
  CHECK(pipeline->counters().points > 0);
  CHECK(pipeline->counters().outside >= ranges.size() / 3);
  CHECK(pipeline->counters().points + pipeline->counters().outside == ranges.size());
}

TEST_CASE("pipeline: the same input gives the same bytes twice, also after a second init") {
  const auto first = started();
  NoddingLaser laser;
  stand(*first, laser, {}, 0, 200);
  const auto expected = bytes(first->curbs());
  const auto expected_ids = ids(first->curbs());
  REQUIRE_FALSE(expected.empty());
  NoddingLaser again, once_more;
  const auto second = started();
  stand(*second, again, {}, 0, 200);
  CHECK(bytes(second->curbs()) == expected);
  REQUIRE(first->init(NoddingLaser::settings()) == Status::ok);
  CHECK(first->curbs().empty());
  CHECK(first->counters().lines == 0);
  stand(*first, once_more, {}, 0, 200);
  CHECK(bytes(first->curbs()) == expected);
  CHECK(ids(first->curbs()) == expected_ids);
}

TEST_CASE("pipeline: a line costs half an inference, and the curbs are those of whole ones") {
  const auto halves = started(), whole = started();
  NoddingLaser laser, same;
  for (int line = 0; line < 200; ++line) {
    const auto before = halves->counters();
    stand(*halves, laser, {}, line, line + 1);
    const bool planes = halves->counters().evidences != before.evidences,
               labels = halves->counters().messages != before.messages;
    CHECK_FALSE((planes && labels));
    add_tilts(*whole, line);
    const auto ranges = same.ranges({}, line, [](double) { return 0.0; });
    REQUIRE(whole->observe({NoddingLaser::ns(NoddingLaser::line_time_s(line)), ranges}) == Status::ok);
    whole->infer();
  }
  CHECK(10 * halves->counters().evidences < 6 * whole->counters().evidences);
  const Curb& ours = longest(halves->curbs());
  const Curb& theirs = longest(whole->curbs());
  CHECK(ours.kind == theirs.kind);
  CHECK(ours.x0_m == Approx(theirs.x0_m).margin(0.02));
  CHECK(ours.height_m == Approx(theirs.height_m).margin(0.002));
}

TEST_CASE("pipeline: a whole inference after half of one misses nothing that the half has changed") {
  for (const int lines : {15, 19, 21, 57}) {
    const auto halves = started(), whole = started();
    NoddingLaser laser, same;
    const Street street{2.0, 0.12};
    stand(*halves, laser, street, 0, lines);  // after an odd number, regions have changed and labels have not
    halves->infer();
    stand(*whole, same, street, 0, lines - 1);
    add_tilts(*whole, lines - 1);
    const auto ranges = same.ranges(street, lines - 1, [](double) { return 0.0; });
    REQUIRE(whole->observe({NoddingLaser::ns(NoddingLaser::line_time_s(lines - 1)), ranges}) == Status::ok);
    whole->infer();
    int different = 0;
    for (int i = 0; i < halves->dem().rows(); ++i) {
      for (int j = 0; j < halves->dem().cols(); ++j) different += halves->label(i, j) != whole->label(i, j);
    }
    CHECK(different == 0);
    CHECK(bytes(halves->curbs()) == bytes(whole->curbs()));
  }
}

TEST_CASE("pipeline: observing alone changes no curb, inferring does") {
  const auto pipeline = started();
  NoddingLaser laser;
  for (int line = 0; line < 200; ++line) {
    add_tilts(*pipeline, line);
    const auto ranges = laser.ranges({}, line, [](double) { return 0.0; });
    REQUIRE(pipeline->observe({NoddingLaser::ns(NoddingLaser::line_time_s(line)), ranges}) == Status::ok);
  }
  CHECK(pipeline->curbs().empty());
  for (int k = 0; k < 20; ++k) pipeline->infer();  // a whole window at once exceeds the budget of one call
  CHECK(longest(pipeline->curbs()).height_m == Approx(0.12).margin(0.01));
}

TEST_CASE("pipeline: project gives out the points that lie in the window or beside it, and takes none") {
  const auto projects = started(), observes = started();
  add_tilts(*projects, 150);
  add_tilts(*observes, 150);
  NoddingLaser laser;
  const auto ranges = laser.ranges({}, 150, [](double) { return 0.0; });
  const ScanLine line{NoddingLaser::ns(NoddingLaser::line_time_s(150)), ranges};
  const Dem<Limits{}>& dem = projects->dem();
  std::uint32_t points = 0, in_window = 0;
  CHECK(projects->project(line, [&](const Point& p) {
    ++points;
    CHECK(p.variance_m2 > 0.0f);
    const float x_m = p.place_x_m(), y_m = p.place_y_m();
    in_window += dem.place_at(x_m, y_m).inside();
    CHECK(dem.surroundings().hold(x_m, y_m, p.z_m));
  }) == Status::ok);
  CHECK(projects->counters().points == 0);
  REQUIRE(observes->observe(line) == Status::ok);
  const Counters& told = observes->counters();
  CHECK(told.points > 200);
  CHECK(told.points == in_window);
  CHECK(points >= told.points);
  CHECK(told.points + told.outside == points + projects->counters().outside);
}

TEST_CASE("pipeline: a line that begins in a gap of the tilt readings loses only the beams in it") {
  Settings settings = NoddingLaser::settings();
  settings.laser.beam_interval_s = 50e-6f;
  const auto pipeline = started(settings);
  const std::int64_t t0 = NoddingLaser::epoch_ns, ms = 1'000'000;
  // Unknown until beam 100, turning to 0.4 rad until beam 200, at rest from there.
  for (const auto& [time, angle] : {std::pair{-300, 0.3f}, {5, 0.3f}, {10, 0.4f}, {30, 0.4f}}) {
    REQUIRE(pipeline->add_tilt({t0 + time * ms, angle}));
  }
  const std::vector<float> ranges(NoddingLaser::beams, 2.0f);
  std::vector<Point> points;
  REQUIRE(pipeline->project({t0, ranges}, [&](const Point& p) { points.push_back(p); }) == Status::ok);
  REQUIRE(points.size() == NoddingLaser::beams - 100);
  CHECK(pipeline->counters().beams_without_tilt == 100);
  const auto tilt_of = [&](std::size_t beam) {
    const double bearing = -1.5707963267948966 + 3.141592653589793 / 360.0 * static_cast<double>(beam);
    const double down = NoddingLaser::height_m - static_cast<double>(points[beam - 100].z_m);
    return std::asin(down / (2.0 * std::cos(bearing)));
  };
  CHECK(tilt_of(110) == Approx(0.31).margin(1e-5));
  CHECK(tilt_of(150) == Approx(0.35).margin(1e-5));
  CHECK(tilt_of(300) == Approx(0.4).margin(1e-5));
}

TEST_CASE("pipeline: a finished map settles, and then nothing changes any more") {
  const auto pipeline = started();
  NoddingLaser laser;
  stand(*pipeline, laser, {}, 0, 200);
  const int passes = pipeline->settle(50);
  CHECK(passes < 50);
  const auto settled = bytes(pipeline->curbs());
  CHECK(pipeline->settle(50) == 1);
  CHECK(bytes(pipeline->curbs()) == settled);
  CHECK(longest(pipeline->curbs()).height_m == Approx(0.12).margin(0.01));
  CHECK_FALSE(settled.empty());
}

TEST_CASE("pipeline: the cells that a low step crosses tilt no plane of a finished map") {
  test::Noise noise;
  const auto ground = [](double x, double y) { return x < 2.0 + 0.3 * y ? 0.0 : 0.02; };
  const auto points = test::sample({0, 4, -2, 2}, 0.03, 0.006, noise, ground);
  const auto settled = [&](bool inferred) {
    auto pipeline = started();
    pipeline->observe(points);
    if (inferred) pipeline->infer();
    pipeline->settle();
    return longest(pipeline->curbs());
  };
  CHECK(settled(false).kind == CurbKind::step_up);
  // Some 700 cells of 11 points on either side; the 60 that are crossed hold half of the step.
  CHECK(settled(false).height_m == Approx(0.02).margin(0.0005));
  CHECK(settled(true).height_m == Approx(0.02).margin(0.0005));
}

//           ______
//        __/            a slope of 14 cm: a face, as far as the laser's spot blurs it, or ground
//  _____/
TEST_CASE("pipeline: the wider the laser's spot, the less of a slope beside a step may be ground") {
  const auto told = [](float divergence_rad) {
    Settings settings = NoddingLaser::settings();
    settings.laser.beam_divergence_rad = divergence_rad;
    test::Noise noise;
    const auto ground = [](double x, double) { return x < 2.0 ? 0.0 : x < 2.14 ? (x - 2.0) : 0.14; };
    return longest(map_of(test::sample({0, 4, -2, 2}, 0.03, 0.006, noise, ground), settings)->curbs());
  };
  CHECK(told(0.0f).kind == CurbKind::step_up);
  CHECK(told(0.0f).height_sd_m > 2.0f * told(0.05f).height_sd_m);
}

TEST_CASE(
    "pipeline: the ground of a narrow verge is known no better than its roughness allows, in a finished map too") {
  test::Noise noise;
  const auto ground = [&](double x, double y) {
    const double across = x - 1.95 - 0.1 * y;
    return across >= 0.0 && across < 0.3 ? 0.05 + 0.01 * noise.normal() : 0.0;
  };
  const auto pipeline = map_of(test::sample({0, 4, -2, 2}, 0.03, 0.006, noise, ground));
  CHECK(longest(pipeline->curbs()).height_sd_m > 0.006f);  // the edge may begin anywhere within 1 cm / sqrt 3
}

//           ,.-,_.,-.     readings of a lawn, 3 cm to either side of its middle: few cells are even, by chance
//  ________|
TEST_CASE("pipeline: the step before a wide lawn is as high as the middle of its readings, in a finished map") {
  double errors_m2 = 0.0, pieces = 0.0;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    test::Noise noise(seed);
    const double at_m = 1.5 + noise.uniform(), slope = 0.15 * (noise.uniform() - 0.5);
    std::vector<Point> points(6400);
    for (Point& p : points) {
      const double x = 4.0 * noise.uniform(), y = 4.0 * noise.uniform() - 2.0;
      const double lawn_m = x < at_m + slope * y ? 0.0 : 0.12 + 0.03 * noise.normal();
      p = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(lawn_m + 0.005 * noise.normal()), 2.5e-5f};
    }
    const auto pipeline = map_of(points);
    for (const Curb& curb : pipeline->curbs()) {
      if (!is_step(curb) || length_of(curb) < 1.0f) continue;
      errors_m2 += std::pow(static_cast<double>(curb.height_m) - 0.12, 2);
      pieces += 1.0;
    }
  }
  REQUIRE(pieces >= 40.0);
  CHECK(std::sqrt(errors_m2 / pieces) < 0.006);
}

TEST_CASE("pipeline: a damaged tilt reading leaves no wrong latency where readings come more slowly than lines") {
  const auto pipeline = started();
  NoddingLaser laser;
  for (int line = 0; line < 500; ++line) {
    const double time_s = NoddingLaser::line_time_s(line);
    if (line % 2 == 0) {  // at 20 Hz; lines come at 40 Hz
      for (const double t : {time_s, time_s + 0.05}) {
        const double ahead_s = line == 100 ? 0.3 : 0.0;
        pipeline->add_tilt({NoddingLaser::ns(t), static_cast<float>(NoddingLaser::tilt_rad(t + ahead_s))});
      }
    }
    const auto ranges = laser.ranges(Street{}, line, [](double) { return 0.0; });
    REQUIRE(pipeline->take({NoddingLaser::ns(time_s), ranges}) == Status::ok);
  }
  CHECK(std::abs(pipeline->tilt_latency().offset_s()) < 0.002f);
}

TEST_CASE("pipeline: a robot that stands knows how its scan lines err, whichever way its laser looks") {
  // Mean of six, as a single one has few sweeps to tell by.
  const auto line_m2 = [](float yaw_rad, float window_x_m, float window_y_m) {
    Settings settings = NoddingLaser::settings();
    settings.tilt.T_base_tilt.yaw_rad = yaw_rad;
    settings.window.origin_x_m = window_x_m;
    settings.window.origin_y_m = window_y_m;
    constexpr unsigned seeds = 6;
    float sum_m2 = 0.0f;
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      auto pipeline = started(settings);
      NoddingLaser laser;
      test::Noise noise(seed);
      for (int line = 0; line < 400; ++line) {
        const double off_rad = 0.003 * noise.normal();  // of all readings near the line
        test::add_angles(*pipeline, line, [&](double t) { return NoddingLaser::tilt_rad(t) + off_rad; });
        const auto ranges = laser.ranges({1e4, 0.0}, line, [](double) { return 0.0; });
        pipeline->take({NoddingLaser::ns(NoddingLaser::line_time_s(line)), ranges});
      }
      sum_m2 += pipeline->dem().line_m2();
    }
    return sum_m2 / seeds;
  };
  const float ahead_m2 = line_m2(0.0f, 0.0f, -2.0f);
  REQUIRE(ahead_m2 > 0.003f * 0.003f);
  CHECK(line_m2(0.5f * pi, -2.0f, 0.0f) == Approx(ahead_m2).epsilon(0.5));
  CHECK(line_m2(pi, -4.0f, -2.0f) == Approx(ahead_m2).epsilon(0.5));
}

TEST_CASE("pipeline: how far ahead a place lies counts from the tilt axis, also of a robot that stands") {
  Settings settings = NoddingLaser::settings();
  settings.tilt.T_base_tilt.y_m = 0.3f;
  settings.tilt.T_base_tilt.yaw_rad = 0.5f * pi;
  const auto pipeline = started(settings);
  CHECK(pipeline->dem().ahead_m(0.7f, 2.0f) == Approx(1.7));
}

TEST_CASE("pipeline: on ground that turns out to be even a step of 15 mm is found") {
  const auto pipeline = started();
  CHECK(pipeline->dem().prior().common_share == PlanePrior{}.common_share);
  NoddingLaser laser;
  stand(*pipeline, laser, {2.0, 0.015}, 0, 400);
  CHECK(pipeline->dem().prior().common_share < 0.3f);
  const Curb& curb = longest(pipeline->curbs());
  CHECK(curb.kind == CurbKind::step_up);
  CHECK(curb.height_m == Approx(0.015).margin(0.003));
  REQUIRE(pipeline->init(NoddingLaser::settings()) == Status::ok);
  CHECK(pipeline->dem().prior().common_share == PlanePrior{}.common_share);
}

TEST_CASE("pipeline: cells tell their plane and how sure it is") {
  const auto pipeline = started();
  NoddingLaser laser;
  stand(*pipeline, laser, {}, 0, 200);
  const auto near = pipeline->label(15, 20), far = pipeline->label(30, 20);
  REQUIRE(near != no_label);
  REQUIRE(far != no_label);
  CHECK(near != far);
  CHECK(pipeline->label_probability(15, 20) > 0.95f);
  CHECK(pipeline->plane(near).height_m(1.55f, 2.05f) == Approx(0.0).margin(0.005));
  CHECK(pipeline->plane(far).height_m(3.05f, 2.05f) == Approx(0.12).margin(0.005));
}

TEST_CASE("heap count: it sees an allocation") {
  const long before = test::heap_count();
  void* p = ::operator new(16);
  CHECK(test::heap_count() == before + 1);
  ::operator delete(p);
  const auto q = std::make_unique<std::vector<int>>(100);
  CHECK(test::heap_count() >= before + 3);
}

TEST_CASE("heap count: it sees malloc and what Eigen asks for") {
  const long before = test::heap_count();
  void* volatile p = std::malloc(16);  // volatile: otherwise the pair may be optimised away
  CHECK(test::heap_count() == before + 1);
  std::free(p);
  const Eigen::MatrixXf matrix = Eigen::MatrixXf::Zero(20, 20);
  CHECK(test::heap_count() == before + 2);
  CHECK(matrix.sum() == 0.0f);
}

TEST_CASE("pipeline: nothing is taken from the heap, in any call") {
  const auto pipeline = std::make_unique<FullPipeline>();
  NoddingLaser laser;
  std::vector<std::vector<float>> lines;
  for (int line = 0; line < 100; ++line) lines.push_back(laser.ranges({}, line, [](double) { return 0.0; }));
  Settings settings = NoddingLaser::settings();
  settings.pose.still = false;
  const std::vector<Point> points{{1.0f, 0.0f, 0.0f, 1e-4f}};
  int good = 0;

  const long before = test::heap_count();
  good += pipeline->init(settings) == Status::ok;
  for (int line = 0; line < 100; ++line) {
    const double t = NoddingLaser::line_time_s(line);
    add_tilts(*pipeline, line);
    pipeline->add_pose({NoddingLaser::ns(t), 0.01f * static_cast<float>(line)});
    pipeline->add_pose({NoddingLaser::ns(t + 0.02), 0.01f * static_cast<float>(line)});
    const std::int64_t time = NoddingLaser::ns(t);
    good += pipeline->take({time, lines[static_cast<std::size_t>(line)]}) == Status::ok;
    good += pipeline->take({time, lines[0]}) == Status::ok;  // refused
  }
  pipeline->observe(points);
  pipeline->infer();
  pipeline->settle();
  const long after = test::heap_count();

  CHECK(after == before);
  CHECK(good == 101);
  CHECK_FALSE(pipeline->curbs().empty());
}

}  // namespace
}  // namespace curbline
