// Times of lines that are stamped on arrival, from three lasers with turns of 25, 20 and 13.3 ms. Delays are
// exponential, like those of a host: never below 0, mostly short, rarely long.
#include "curbline/intake/line_clock.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

namespace curbline {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t t0 = 1'290'682'980'025'000'000;

struct Laser {
  const char* name;
  float bearing_step_rad, beam_interval_s;
  double turn_ns;
};
constexpr Laser utm30lx{"utm30lx", 0.004363323f, 25e-3f / 1440.0f, 25e6};
constexpr Laser lasers[] = {utm30lx,
                            {"lms151", 0.0087266463f, 20e-3f / 720.0f, 20e6},
                            {"lms200", 0.0174532925f, 1.0f / 75.0f / 360.0f, 1e9 / 75.0}};

LineClock clock_of(const Laser& laser) {
  LaserSettings settings;
  settings.bearing_step_rad = laser.bearing_step_rad;
  settings.beam_interval_s = laser.beam_interval_s;
  LineClock clock;
  clock.init(settings);
  return clock;
}

/// A line with the times of its measurement and its arrival.
struct Line {
  std::int64_t measured_ns, stamp_ns;
};

/// Lines that are late by `mean_ms` on average, in whole microseconds as in logs, in the order of their arrival. Each
/// is lost with probability `lost`.
std::vector<Line> late_lines(const Laser& laser, double mean_ms, double lost = 0.0, int count = 400) {
  std::mt19937 random(7);
  std::vector<Line> out;
  for (int i = 0; i < count; ++i) {
    const auto share = [&] { return (static_cast<double>(random()) + 0.5) / 4294967296.0; };
    const double late_ns = -mean_ms * 1e6 * std::log(share());
    if (share() < lost) continue;
    const auto measured_ns = t0 + std::llround(i * laser.turn_ns / 1e3) * 1000;
    std::int64_t stamp_ns = measured_ns + std::llround(late_ns / 1e3) * 1000;
    if (!out.empty()) stamp_ns = std::max(stamp_ns, out.back().stamp_ns + 1000);
    out.push_back({measured_ns, stamp_ns});
  }
  return out;
}

/// Deviations of the times from those of the measurements, and the number of lines without a time.
struct Errors {
  std::vector<std::int64_t> off_ns;  ///< ascending
  int left_out = 0;
  std::int64_t below(double share) const {
    return off_ns.at(static_cast<std::size_t>(share * static_cast<double>(off_ns.size() - 1)));
  }
};

/// Leaves out the first lines, which the clock needs to learn the turns.
Errors errors_of(const Laser& laser, const std::vector<Line>& lines) {
  LineClock clock = clock_of(laser);
  Errors out;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const auto time_ns = clock.time_of(lines[k].stamp_ns);
    if (k < 32) continue;
    time_ns ? out.off_ns.push_back(std::abs(*time_ns - lines[k].measured_ns)) : void(++out.left_out);
  }
  std::sort(out.off_ns.begin(), out.off_ns.end());
  return out;
}

void keeps(const Laser& laser, const std::vector<std::int64_t>& stamps) {
  INFO(laser.name);
  LineClock clock = clock_of(laser);
  int kept = 0;
  for (const std::int64_t stamp_ns : stamps) kept += clock.time_of(stamp_ns) == stamp_ns;
  CHECK(kept == static_cast<int>(stamps.size()));
  CHECK(clock.set_back() == 0);
  CHECK(clock.left_out() == 0);
}

TEST_CASE("line clock: lines that come late by a tenth of a turn get their times to half a millisecond") {
  for (const Laser& laser : lasers) {
    INFO(laser.name);
    const Errors errors = errors_of(laser, late_lines(laser, 0.1e-6 * laser.turn_ns));
    CHECK(errors.below(0.5) < ms / 8);
    CHECK(errors.below(0.9) < ms / 2);
    CHECK(errors.below(1.0) < 2 * ms);
    CHECK(errors.left_out <= 4);
  }
}

TEST_CASE("line clock: of lines late by 5 ms, 25 ms at most, nine in ten get their times to a millisecond") {
  const Errors errors = errors_of(utm30lx, late_lines(utm30lx, 5.0));
  CHECK(errors.below(0.9) < ms);
  CHECK(errors.left_out <= 12);
}

TEST_CASE("line clock: lost lines make none of the others a turn off") {
  for (const Laser& laser : lasers) {
    INFO(laser.name);
    const Errors errors = errors_of(laser, late_lines(laser, 0.1e-6 * laser.turn_ns, 0.05));
    CHECK(errors.below(0.9) < ms / 2);
    CHECK(errors.below(0.995) < static_cast<std::int64_t>(laser.turn_ns / 4));
    CHECK(errors.left_out <= 40);  // the first after each loss
  }
}

TEST_CASE("line clock: stamps on turns are kept to the nanosecond, whatever is lost, repeated or passed over") {
  for (const Laser& laser : lasers) {
    for (const double rate : {1.0, 1.004, 0.996}) {
      for (const int every : {1, 2, 8}) {
        std::vector<std::int64_t> stamps;
        std::mt19937 random(3);
        for (int i = 0; i < 300; ++i) {
          if (random() % 20 == 0) continue;
          stamps.push_back(t0 + std::llround(i * every * laser.turn_ns * rate / 1e3) * 1000);
          if (random() % 20 == 0) stamps.push_back(stamps.back());
        }
        INFO("rate " << rate << ", every " << every);
        keeps(laser, stamps);
      }
    }
  }
}

TEST_CASE("line clock: a line that comes twice tells nothing new") {
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 300; ++i) {
    stamps.push_back(t0 + i * 25 * ms);
    if (i % 7 == 0) stamps.push_back(stamps.back() + ms / 2);
  }
  keeps(utm30lx, stamps);
}

TEST_CASE("line clock: stamps of another rate than the settings', or of none, are kept") {
  for (const double turns : {1.33, 0.6, 1.6, 0.98, 0.99, 1.0055, 1.007, 1.01, 1.02, 2.97, 3.03, 4.1}) {
    std::vector<std::int64_t> stamps;
    for (int i = 0; i < 300; ++i) stamps.push_back(t0 + std::llround(i * 25e6 * turns));
    INFO("a line in " << turns << " turns");
    keeps(utm30lx, stamps);
  }
  std::vector<std::int64_t> stamps{t0};
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i)
    stamps.push_back(stamps.back() + 25 * ms + static_cast<std::int64_t>(random() % 25) * ms);
  INFO("at any time");
  keeps(utm30lx, stamps);
}

TEST_CASE("line clock: a motor that is 1 % off, with late lines, makes no time worse") {
  for (const double rate : {0.99, 1.01}) {
    Laser slower = utm30lx;
    slower.turn_ns *= rate;
    INFO("rate " << rate);
    LineClock clock = clock_of(utm30lx);
    for (const Line& line : late_lines(slower, 0.3)) {
      const auto time_ns = clock.time_of(line.stamp_ns);
      REQUIRE(time_ns);
      CHECK(*time_ns >= line.measured_ns - 2 * ms);
    }
  }
}

TEST_CASE("line clock: a repeated line gets no time if it had none, and keeps the time that it had") {
  LineClock clock = clock_of(utm30lx);
  int refused = 0, moved = 0;
  for (const Line& line : late_lines(utm30lx, 5.0, 0.05, 2000)) {
    const auto time_ns = clock.time_of(line.stamp_ns);
    const auto again_ns = clock.time_of(line.stamp_ns);
    refused += !time_ns && again_ns;
    moved += time_ns && again_ns && *again_ns != *time_ns;
  }
  CHECK(refused == 0);
  CHECK(moved == 0);
}

TEST_CASE("line clock: every line that gets no time is counted, one that comes twice too") {
  LineClock clock = clock_of(utm30lx);
  std::uint32_t none = 0;
  for (const Line& line : late_lines(utm30lx, 5.0, 0.05, 2000)) {
    for (int times = 0; times < 2; ++times) none += !clock.time_of(line.stamp_ns);
  }
  CHECK(none > 0);
  CHECK(clock.left_out() == none);
}

TEST_CASE("line clock: a line that comes before its turn, out of order, leaves what is known of the others") {
  LineClock clock = clock_of(utm30lx);
  const auto lines = late_lines(utm30lx, 2.0, 0.0, 1000);
  int off = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const auto time_ns = clock.time_of(lines[k].stamp_ns);
    off += k >= 32 && time_ns && std::abs(*time_ns - lines[k].measured_ns) > ms;
    if (k % 20 == 19) clock.time_of(lines[k].stamp_ns - 3 * ms);
  }
  CHECK(off < 10);
}

TEST_CASE("line clock: of lines that come out of order, none older than the newest passes for a newer one") {
  LineClock clock = clock_of(utm30lx);
  for (int i = 0; i < 100; ++i) clock.time_of(t0 + i * 25 * ms);
  const std::int64_t turn_ns = t0 + 100 * 25 * ms;
  const auto set_back_ns = clock.time_of(turn_ns + 5 * ms);
  REQUIRE(set_back_ns);
  REQUIRE(*set_back_ns < turn_ns + ms);
  CHECK(clock.time_of(turn_ns + 2 * ms) == std::nullopt);
  CHECK(clock.left_out() == 1);
  CHECK(clock.time_of(*set_back_ns) == set_back_ns);  // the pipeline drops it, and counts it
}

TEST_CASE("line clock: a sensor without a beam interval does not turn, and keeps its stamps") {
  std::vector<std::int64_t> stamps;
  for (const Line& line : late_lines(utm30lx, 5.0)) stamps.push_back(line.stamp_ns);
  keeps({"flash", 0.01f, 0.0f, 0.0}, stamps);
}

TEST_CASE(
    "line clock: where the clock is set or the mirror falls out of step, stamps are kept again after eight lines") {
  for (const std::int64_t by_ns : {10 * ms, -10 * ms, 3'600'000 * ms + 7 * ms, -3'600'000 * ms + 7 * ms}) {
    INFO("by " << by_ns / ms << " ms");
    LineClock clock = clock_of(utm30lx);
    for (int i = 0; i < 100; ++i) clock.time_of(t0 + i * 25 * ms);
    int other = 0;
    for (int i = 100; i < 200; ++i) other += clock.time_of(t0 + i * 25 * ms + by_ns) != t0 + i * 25 * ms + by_ns;
    CHECK(other <= 8);
  }
}

TEST_CASE("line clock: a line that had to wait for a turn and more is not mapped at a wrong one a second time") {
  LineClock clock = clock_of(utm30lx);
  for (int i = 0; i < 100; ++i) clock.time_of(t0 + i * 25 * ms);
  const auto bunch = [&](int first) {  // three arrive together with the last
    std::vector<std::optional<std::int64_t>> times;
    for (int i = first; i < first + 3; ++i) times.push_back(clock.time_of(t0 + (first + 2) * 25 * ms + (i - first)));
    return times;
  };
  bunch(100);
  for (int i = 103; i < 120; ++i) CHECK(clock.time_of(t0 + i * 25 * ms) == t0 + i * 25 * ms);
  const auto times = bunch(120);
  CHECK(times[0] == std::nullopt);
  REQUIRE(times[1]);
  CHECK(std::abs(*times[1] - (t0 + 121 * 25 * ms)) < ms / 4);
  CHECK(times[2] == t0 + 122 * 25 * ms + 2);
  CHECK(clock.time_of(t0 + 123 * 25 * ms) == t0 + 123 * 25 * ms);
}

TEST_CASE("line clock: times rise, whatever comes") {
  LineClock clock = clock_of(utm30lx);
  std::mt19937 random(11);
  std::int64_t stamp_ns = t0, before_ns = INT64_MIN;
  int falls = 0;
  for (int i = 0; i < 20'000; ++i) {
    stamp_ns += 1 + static_cast<std::int64_t>(random() % 40) * ms * (random() % 100 == 0 ? 20 : 1);
    const auto time_ns = clock.time_of(stamp_ns);
    if (!time_ns) continue;
    falls += *time_ns <= before_ns;
    CHECK(*time_ns <= stamp_ns);
    before_ns = *time_ns;
  }
  CHECK(falls == 0);
  for (const std::int64_t far_ns : {INT64_MAX, INT64_MIN, std::int64_t{0}, t0}) CHECK(clock.time_of(far_ns) == far_ns);
}

}  // namespace
}  // namespace curbline
