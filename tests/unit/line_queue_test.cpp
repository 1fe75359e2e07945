// Lines that wait for their tilt: when each is given out, in which order, and what happens to those for which there is
// no room.
#include "curbline/intake/line_queue.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <limits>
#include <random>
#include <span>
#include <vector>

namespace curbline {
namespace {

constexpr Limits limits{.beams = 11};
using Queue = LineQueue<limits, 4>;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t t0 = 1'290'682'980'025'000'000;
constexpr std::int64_t none = std::numeric_limits<std::int64_t>::min();

/// Lines of 11 beams, 1 ms apart.
const LaserSettings laser{.beams = 11, .beam_interval_s = 1e-3f};

Queue queue(const TiltSettings& tilt = {}, const PoseSettings& pose = {}) {
  Queue out;
  out.init(laser, tilt, pose, 0.05f);
  return out;
}

/// Line k at time t0 + 25 k ms, with ranges that show its number.
struct Line {
  explicit Line(int number, std::size_t beams = 11) : ranges_m(beams, static_cast<float>(number)), k(number) {}
  ScanLine line() const { return {t0 + 25 * ms * k, ranges_m}; }
  std::int64_t end_ns() const { return t0 + 25 * ms * k + 10 * ms; }
  std::vector<float> ranges_m;
  int k;
};

bool adds_up(const Queue& q) {
  const LineQueueCounters& c = q.counters();
  return c.pushed ==
         c.covered + c.overdue + c.crowded + c.dropped + c.too_long + c.bad_time + static_cast<std::uint32_t>(q.size());
}

TEST_CASE("line queue: a line is given out when a reading is at or after its last beam") {
  Queue q = queue();
  CHECK_FALSE(q.pop({t0}, t0, 0.0f));
  const Line line(0);
  REQUIRE(q.push(line.line(), line.end_ns()));
  CHECK_FALSE(q.pop({}, line.end_ns(), 0.0f));
  CHECK_FALSE(q.pop({line.end_ns() - 1000}, line.end_ns(), 0.0f));
  const auto out = q.pop({line.end_ns() + 1000}, line.end_ns(), 0.0f);
  REQUIRE(out);
  CHECK(out->time_ns == t0);
  CHECK(out->ranges_m.size() == 11);
  CHECK(q.counters().covered == 1);
  CHECK_FALSE(q.pop({line.end_ns() + 1000}, line.end_ns(), 0.0f));
}

TEST_CASE("line queue: the reading that a line needs is later by the servo's latency") {
  TiltSettings late;
  late.latency_s = 0.02f;
  Queue q = queue(late);
  const Line line(0);
  q.push(line.line(), line.end_ns());
  CHECK_FALSE(q.pop({line.end_ns() + 19 * ms}, line.end_ns(), 0.0f));
  CHECK(q.pop({line.end_ns() + 21 * ms}, line.end_ns(), 0.0f));
}

TEST_CASE("line queue: it is later by what the pipeline has found of that latency, too") {
  const Line line(1);
  Queue q = queue();
  REQUIRE(q.push(line.line(), t0));
  CHECK_FALSE(q.pop({line.end_ns() + 11 * ms}, line.end_ns(), 0.012f));
  CHECK(q.pop({line.end_ns() + 13 * ms}, line.end_ns(), 0.012f));
  REQUIRE(q.push(line.line(), t0));
  CHECK(q.pop({line.end_ns() - 11 * ms}, line.end_ns(), -0.012f));  // or earlier
}

TEST_CASE("line queue: a laser at a fixed tilt on a robot that stands never waits") {
  TiltSettings fixed;
  fixed.fixed = true;
  Queue q = queue(fixed);
  q.push(Line(0).line(), t0);
  CHECK(q.pop({}, t0, 0.0f));
  CHECK(q.counters().covered == 1);
}

TEST_CASE("line queue: a robot that drives takes a line when a pose is at or after its last beam too") {
  PoseSettings driving;
  driving.still = false;
  const Line line(0);
  const std::int64_t before = line.end_ns() - 1000, after = line.end_ns() + 1000;
  Queue q = queue({}, driving);
  q.push(line.line(), t0);
  CHECK_FALSE(q.pop({.tilt_ns = after}, t0, 0.0f));
  CHECK_FALSE(q.pop({.tilt_ns = after, .pose_ns = before}, t0, 0.0f));
  CHECK_FALSE(q.pop({.tilt_ns = before, .pose_ns = after}, t0, 0.0f));
  CHECK(q.pop({.tilt_ns = after, .pose_ns = after}, t0, 0.0f));
  CHECK(q.counters().covered == 1);
  q.push(line.line(), t0);
  CHECK(q.pop({.tilt_ns = after}, t0 + 51 * ms, 0.0f));  // a robot whose odometry is silent continues without it
  CHECK(q.counters().overdue == 1);

  TiltSettings fixed;
  fixed.fixed = true;
  q = queue(fixed, driving);
  q.push(line.line(), t0);
  CHECK_FALSE(q.pop({.pose_ns = before}, t0, 0.0f));
  CHECK(q.pop({.pose_ns = after}, t0, 0.0f));
}

TEST_CASE("line queue: what has waited too long is given out without its tilt, and counted") {
  Queue q = queue();
  const Line line(0);
  q.push(line.line(), 7 * ms);  // the arrival is on another clock than the line
  CHECK_FALSE(q.pop({}, 56 * ms, 0.0f));
  CHECK(q.pop({}, 58 * ms, 0.0f));
  CHECK(q.counters().overdue == 1);
  CHECK(q.counters().covered == 0);
}

TEST_CASE("line queue: a line waits as much longer as the servo's readings are late") {
  TiltSettings tilt;
  tilt.latency_s = 0.15f;
  tilt.fixed = GENERATE(false, true);
  Queue q = queue(tilt, {.still = false});
  const Line line(0);
  q.push(line.line(), 0);
  CHECK_FALSE(q.pop({}, 49 * ms, 0.0f));
  CHECK(q.pop({}, 199 * ms, 0.0f).has_value() == tilt.fixed);
  CHECK((tilt.fixed || q.pop({}, 201 * ms, 0.0f)));
  CHECK(q.counters().overdue == 1);
}

TEST_CASE("line queue: the copy is the queue's own, and lines of any length keep theirs") {
  Queue q = queue();
  {
    Line gone(1, 3);
    q.push(gone.line(), t0);
    gone.ranges_m.assign(3, -1.0f);
  }
  q.push(Line(2, 0).line(), t0);
  const auto first = q.pop({t0 + 1000 * ms}, t0, 0.0f);
  REQUIRE(first);
  CHECK(std::vector<float>(first->ranges_m.begin(), first->ranges_m.end()) == std::vector<float>(3, 1.0f));
  CHECK(q.pop({t0 + 1000 * ms}, t0, 0.0f)->ranges_m.empty());
}

TEST_CASE("line queue: a short line ends with its own last beam") {
  Queue q = queue();
  q.push(Line(0, 3).line(), t0);
  CHECK(q.pop({t0 + 2 * ms + 1000}, t0, 0.0f));
}

TEST_CASE("line queue: who takes after each line loses none, even without tilt") {
  Queue q = queue();
  int next = 0;
  for (int k = 0; k < 10; ++k) {
    REQUIRE(q.push(Line(k).line(), t0));
    while (const auto out = q.pop({}, t0, 0.0f)) CHECK(out->time_ns == Line(next++).line().time_ns);
  }
  CHECK(next == 7);
  CHECK(q.size() == 3);
  CHECK(q.counters().crowded == 7);
  CHECK(q.counters().dropped == 0);
}

TEST_CASE("line queue: a full queue drops its oldest line for a new one, and counts it") {
  Queue q = queue();
  for (int k = 0; k < 6; ++k) CHECK(q.push(Line(k).line(), t0));
  CHECK(q.counters().dropped == 2);
  for (int k = 2; k < 6; ++k) CHECK(q.pop({t0 + 1000 * ms}, t0, 0.0f)->ranges_m[0] == static_cast<float>(k));
  CHECK(q.size() == 0);
}

TEST_CASE("line queue: a line with more beams than the limits is refused and counted") {
  Queue q = queue();
  CHECK_FALSE(q.push(Line(0, 12).line(), t0));
  CHECK(q.size() == 0);
  CHECK(q.counters().too_long == 1);
  CHECK(adds_up(q));
}

TEST_CASE("line queue: a line with a stamp that is no time is refused and counted") {
  Queue q = queue();
  for (const std::int64_t damaged : {INT64_MAX, INT64_MIN}) {
    Line line(0, 5);
    ScanLine stamped = line.line();
    stamped.time_ns = damaged;
    CHECK_FALSE(q.push(stamped, t0));
  }
  CHECK(q.size() == 0);
  CHECK(q.counters().bad_time == 2);
  CHECK(adds_up(q));
}

TEST_CASE("line queue: after init it is empty and has counted nothing") {
  Queue q = queue();
  const Line line(0);
  q.push(line.line(), line.end_ns());
  q.push(Line(1, 12).line(), t0);
  q.init(laser, {}, {}, 0.05f);
  CHECK(q.size() == 0);
  CHECK_FALSE(q.pop({line.end_ns() + ms}, line.end_ns(), 0.0f));
  CHECK(q.counters().pushed + q.counters().too_long + q.counters().covered == 0);
}

TEST_CASE("line queue: under any traffic lines stay in order, whole, and every one is accounted for") {
  std::mt19937 random(3);
  Queue q = queue();
  std::int64_t now = t0, tilt = none, last = none;
  for (int k = 0; k < 20'000; ++k) {
    now += static_cast<std::int64_t>(random() % 30) * ms;
    const Line line(k, static_cast<unsigned>(random() % 13));
    q.push(line.line(), now);
    if (k % 1000 < 500 && random() % 3 != 0) tilt = t0 + 25 * ms * k + static_cast<std::int64_t>(random() % 60) * ms;
    for (auto n = random() % 3; n > 0; --n) {
      const auto out = q.pop({tilt}, now, 0.0f);
      if (!out) break;
      REQUIRE(out->time_ns > last);
      last = out->time_ns;
      for (const float range_m : out->ranges_m) REQUIRE(range_m == static_cast<float>((last - t0) / (25 * ms)));
    }
    REQUIRE(adds_up(q));
  }
  const LineQueueCounters& c = q.counters();
  CHECK(c.covered > 100);
  CHECK(c.overdue > 100);
  CHECK(c.crowded > 100);
  CHECK(c.dropped > 100);
  CHECK(c.too_long > 100);
}

TEST_CASE("line queue: one in static memory begins as zeros, and takes no flash") {
  static constinit Queue q;
  const auto bytes = std::as_bytes(std::span(&q, 1));
  CHECK(std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; }));
}

}  // namespace
}  // namespace curbline
