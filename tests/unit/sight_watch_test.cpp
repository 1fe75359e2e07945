// The watch on what the laser sees, by the counters of the pipeline after each line.
#include "curbline/intake/sight_watch.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "support/nodding_pipeline.hpp"

namespace curbline {
namespace {

constexpr std::int64_t ms = 1'000'000;

/// A laser of 40 lines a second.
class Lines {
 public:
  explicit Lines(float longest_away_s) { watch.init(longest_away_s); }
  /// Lines that each gave so many points in the window and outside. Returns what was said of the last.
  bool take(int lines, std::uint32_t points, std::uint32_t outside) {
    bool sees = false;
    for (; lines > 0; --lines) {
      ++counters.lines;
      counters.points += points;
      counters.outside += outside;
      sees = watch.update(counters, time_ns += 25 * ms);
      lost += watch.event() == SourceEvent::lost;
      recovered += watch.event() == SourceEvent::recovered;
    }
    return sees;
  }

  SightWatch watch;
  Counters counters{};
  std::int64_t time_ns = 1'290'682'980'025'000'000;
  int lost = 0, recovered = 0;
};

TEST_CASE("sight watch: a covered laser is blind from its first line on, and sees again with the first that is not") {
  Lines laser(4.0f);
  CHECK(laser.take(40, 100, 50));
  CHECK_FALSE(laser.take(1, 0, 0));
  CHECK_FALSE(laser.take(40, 0, 0));
  CHECK(laser.take(1, 100, 50));
}

TEST_CASE("sight watch: a laser that looks beside the window at one end of its sweeps sees, for as long as they take") {
  Lines laser(4.0f);
  for (int sweep = 0; sweep < 3; ++sweep) {
    CHECK(laser.take(80, 1, 50));
    CHECK(laser.take(80, 0, 50));
  }
  CHECK(laser.lost == 0);
  CHECK_FALSE(laser.take(100, 0, 50));  // it has been knocked
  CHECK(laser.lost == 1);
  CHECK(laser.take(1, 1, 50));
  CHECK(laser.recovered == 1);
}

TEST_CASE("sight watch: before the laser has seen the window, nothing is known of it") {
  Lines laser(4.0f);
  CHECK(laser.watch.watch().state() == SourceState::never);
  CHECK_FALSE(laser.take(10, 0, 50));
  CHECK(laser.lost == 0);  // it may come
  CHECK_FALSE(laser.take(160, 0, 50));
  CHECK(laser.lost == 1);
  CHECK(laser.take(1, 1, 0));
}

TEST_CASE("sight watch: a dropped line says nothing") {
  Lines laser(4.0f);
  REQUIRE(laser.take(10, 100, 50));
  ++laser.counters.lines_dropped;
  CHECK_FALSE(laser.watch.update(laser.counters, laser.time_ns + 25 * ms));
  CHECK(laser.watch.watch().state() == SourceState::ok);
}

TEST_CASE("sight watch: a clock that is set back does not make a laser see for as long") {
  Lines laser(4.0f);
  REQUIRE(laser.take(10, 100, 50));
  laser.time_ns -= 3'600'000 * ms;
  CHECK(laser.take(10, 0, 50));
  CHECK_FALSE(laser.take(160, 0, 50));
}

TEST_CASE("sight watch: lines of a pipeline whose laser is covered are taken, and say nothing") {
  using test::NoddingLaser;
  const auto pipeline = test::started();
  NoddingLaser laser;
  SightWatch watch;
  watch.init(4.0f);
  const std::vector<float> zeros(NoddingLaser::beams, 0.0f), infinite(NoddingLaser::beams, INFINITY);
  for (int line = 0; line < 200; ++line) {
    test::add_tilts(*pipeline, line);
    const bool covered = line >= 100;
    const auto ranges = !covered       ? laser.ranges({2.0, 0.12}, line, [](double) { return 0.0; })
                        : line % 2 > 0 ? zeros
                                       : infinite;
    const std::int64_t time_ns = NoddingLaser::ns(NoddingLaser::line_time_s(line));
    REQUIRE(pipeline->take({time_ns, ranges}) == Status::ok);
    INFO("line " << line);
    CHECK(watch.update(pipeline->counters(), time_ns) == !covered);
  }
  CHECK(pipeline->curbs().size() > 0);  // as they were seen before
}

}  // namespace
}  // namespace curbline
