// A scanner's clock against the host's. Delays are drawn as on a network: a minimum plus a random part.
#include <catch2/catch.hpp>
#include <random>

#include "lms200/turn_clock.hpp"
#include "scanner/device_clock.hpp"
#include "scanner_support.hpp"

namespace curbline::test {
namespace {

constexpr std::int64_t ms = 1'000'000, s = 1000 * ms;
constexpr std::int64_t epoch_ns = 1'700'000'000 * s;

TEST_CASE("clock: a stamp of 24 bits counts on where it wraps around") {
  scanner::StampCounter counter(24, ms);
  CHECK(counter.unwrap(0xFFFFF0) == 0xFFFFF0 * ms);
  CHECK(counter.unwrap(0x000009) == 0x1000009 * ms);
  CHECK_FALSE(counter.unwrap(0xFFFFFF));
  CHECK(counter.unwrap(0x000022) == 0x1000022 * ms);
}

TEST_CASE("clock: three stamps in a row that go back are a scanner that started anew") {
  scanner::StampCounter counter(32, 1000);
  CHECK(counter.unwrap(4000));
  CHECK_FALSE(counter.unwrap(10));
  CHECK_FALSE(counter.unwrap(20));
  CHECK_FALSE(counter.lost());
  CHECK_FALSE(counter.unwrap(30));
  CHECK(counter.lost());
  counter.restart();
  CHECK(counter.unwrap(40) == 40'000);
  CHECK_FALSE(counter.lost());
}

TEST_CASE("clock: the time of a log is found from its counter for hours around") {
  const scanner::StampCounter counter(24, ms);
  const std::int64_t time_ns = epoch_ns + 123 * ms;
  const std::int64_t device_ns = (time_ns / ms & 0xFFFFFF) * ms;
  for (const std::int64_t away_ns : {0 * s, 8000 * s, -8000 * s})
    CHECK(counter.nearest_ns(device_ns, time_ns + away_ns) == time_ns);
  CHECK(counter.nearest_ns(device_ns + 0x1000000 * ms, time_ns) == time_ns);
}

/// Lines at 40 Hz with a delay of 20 ms plus up to 30 ms; the scanner's clock is `ppm` fast. Returns the largest error
/// after the first second.
std::int64_t worst_error_ns(scanner::DeviceClock& clock, double ppm, int seconds, std::int64_t true_offset_ns) {
  std::mt19937 random(3);
  std::int64_t worst_ns = 0;
  for (int i = 0; i < 40 * seconds; ++i) {
    const std::int64_t host_ns = epoch_ns + i * 25 * ms;
    const auto device_ns =
        static_cast<std::int64_t>(static_cast<double>(i * 25 * ms) * (1 + ppm * 1e-6)) - true_offset_ns;
    clock.follow(device_ns, host_ns + 20 * ms + static_cast<std::int64_t>(random() % 30) * ms);
    if (i > 40) worst_ns = std::max(worst_ns, std::abs(clock.to_steady(device_ns) - host_ns));
  }
  return worst_ns;
}

TEST_CASE("clock: late lines do not move it, and a drift of 50 ppm is followed to within 1.5 ms") {
  scanner::DeviceClock clock(25 * ms);
  for (const std::int64_t delay_ns : {9 * ms, ms / 2, 4 * ms}) clock.anchor(-7 * s, epoch_ns - 7 * s + delay_ns);
  CHECK(worst_error_ns(clock, 50.0, 120, 0) < 3 * ms / 2);
}

TEST_CASE("clock: the drift is followed on for as long as lines come") {
  scanner::DeviceClock clock(25 * ms);
  clock.anchor(-77 * s, epoch_ns);
  CHECK(worst_error_ns(clock, -50.0, 400, 77 * s) < 2 * ms);
}

TEST_CASE("clock: without an anchor the least delay of a line is taken as stated") {
  scanner::DeviceClock clock(20 * ms);
  CHECK(worst_error_ns(clock, 0.0, 20, 5 * s) < 2 * ms);
}

TEST_CASE("clock: after an hour of silence the drift of that hour is made up for by the first line") {
  for (const std::int64_t drift_ns : {180 * ms, -180 * ms}) {  // 50 ppm
    scanner::DeviceClock clock(20 * ms);
    for (std::int64_t t_ns = 0; t_ns < 7 * s; t_ns += 25 * ms) clock.follow(t_ns, epoch_ns + t_ns + 20 * ms);
    const std::int64_t after_ns = 3600 * s;
    clock.follow(after_ns - drift_ns, epoch_ns + after_ns + 20 * ms);
    CHECK(clock.to_steady(after_ns - drift_ns) == epoch_ns + after_ns);
  }
}

TEST_CASE("turn clock: lines that wait in a driver and come in bunches keep their distance") {
  lms200::TurnClock clock;
  std::mt19937 random(5);
  std::int64_t worst_ns = 0, before_ns = INT64_MIN;
  for (int i = 0; i < 1500; ++i) {
    const std::int64_t sent_ns = epoch_ns + i * lms200::turn_ns;
    const std::int64_t arrival_ns =
        epoch_ns + (i / 5 * 5 + 4) * lms200::turn_ns + static_cast<std::int64_t>(random() % 3) * ms;  // five at once
    const std::int64_t time_ns = clock.sent_ns(arrival_ns, 1);
    CHECK(time_ns > before_ns);
    before_ns = time_ns;
    if (i > 10) worst_ns = std::max(worst_ns, std::abs(time_ns - sent_ns));
  }
  CHECK(worst_ns < 3 * ms);
}

TEST_CASE("turn clock: a gap is made up for") {
  lms200::TurnClock clock;
  for (int i = 0; i < 100; ++i) clock.sent_ns(epoch_ns + i * lms200::turn_ns, 1);
  const std::int64_t after_ns = epoch_ns + 175 * lms200::turn_ns;
  CHECK(std::abs(clock.sent_ns(after_ns, 1) - after_ns) < lms200::turn_ns);
}

/// Largest change of the time from a line's stamp to its arrival, over 80 lines that all take the same time to arrive.
/// The host's clock is set by `by_ns` before the 41st.
std::int64_t worst_change_ns(Scanner& scanner, std::int64_t by_ns) {
  start(scanner);
  const std::vector<Bytes> telegrams = telegrams_of(scanner, 80);
  const std::int64_t period_ns = line_of(scanner.first, 1).time_ns - scanner.first.time_ns;
  std::int64_t first_ns = 0, worst_ns = 0;
  for (int i = 0; i < 80; ++i) {
    const std::int64_t since_ns = 500 * ms + i * period_ns;
    const scanner::Now now{1'800'000'000 * s + since_ns + (i < 40 ? 0 : by_ns), since_ns};
    std::span<const std::uint8_t> left(telegrams[static_cast<std::size_t>(i)]);
    REQUIRE(scanner.session->take(left, now));
    const std::int64_t before_ns = now.host_ns - scanner.session->line().host_ns;
    if (i == 0) first_ns = before_ns;
    worst_ns = std::max(worst_ns, std::abs(before_ns - first_ns));
  }
  return worst_ns;
}

TEST_CASE("scanner: after a change of the host's clock the very next line has the new time") {
  for (const std::int64_t by_ns : {3 * s, 50 * ms, -300 * ms, 3600 * s, -3600 * s}) {
    for (Scanner& scanner : small_scanners()) {
      INFO(scanner.name << ", set by " << by_ns / ms << " ms");
      CHECK(worst_change_ns(scanner, by_ns) < ms);
    }
  }
}

}  // namespace
}  // namespace curbline::test
