// Recorded times for frames that are played on a bus.
#include "streams/recorded_times.hpp"

#include "curbline/can/servo_presets.hpp"
#include "formats_support.hpp"

namespace curbline::tools::testing {
namespace {

constexpr std::int64_t ms = 1'000'000, t0 = 1'700'000'000'000'000'000, bus0 = 1'800'000'000'000'000'000;

can::Frame position(std::int64_t time_ns, double angle_rad) {
  can::Frame frame;
  can::encode(can::cia402_position(1), angle_rad, frame);
  frame.time_ns = time_ns;
  return frame;
}

/// A log with a frame every 10 ms; frame k has the angle angle_of(k).
template <typename AngleOf>
LogClock clock_of(const TemporaryDirectory& directory, int frames, AngleOf angle_of) {
  std::ostringstream log;
  for (int k = 0; k < frames; ++k) write_can_frame(log, position(t0 + 10 * ms * k, angle_of(k)), "can0");
  RecordedTimes recorded(directory.write("can.log", log.str()), can::cia402_position(1), std::nullopt);
  return LogClock(std::move(recorded));
}

/// Number of the recorded frame whose time is assigned to frame k when it arrives `late_ms` after its own time.
template <typename AngleOf>
double given(LogClock& clock, int k, AngleOf angle_of, int late_ms = 0) {
  can::Frame frame = position(bus0 + 10 * ms * k + late_ms * ms, angle_of(k));
  clock.set_log_time(frame, t0);
  return static_cast<double>(frame.time_ns - t0) / (10.0 * ms);
}

TEST_CASE("recorded times: a log whose times go back is refused with its line") {
  const TemporaryDirectory directory;
  std::ostringstream log;
  for (const int k : {0, 2, 1}) write_can_frame(log, position(t0 + 10 * ms * k, 0.1 * k), "can0");
  RecordedTimes recorded(directory.write("can.log", log.str()), can::cia402_position(1), std::nullopt);
  CHECK(error_of([&] { recorded.read_all(); }).starts_with("can.log:3: the time goes back"));
}

TEST_CASE("recorded times: after a gap in which the servo turned, a frame is not taken for one of the way before") {
  const TemporaryDirectory directory;
  const auto nods = [](int k) { return 0.01 * std::abs(k - 30); };  // 45 has the angle of 15
  LogClock clock = clock_of(directory, 100, nods);
  for (int k = 0; k < 10; ++k) REQUIRE(given(clock, k, nods) == k);
  for (int k = 45; k < 100; ++k) REQUIRE(given(clock, k, nods) == k);
  CHECK(clock.not_recorded() == 0);
  CHECK(clock.recorded()->missed() == 35);
}

TEST_CASE("recorded times: a repeated frame is not mistaken for the one with its angle on the way back") {
  const TemporaryDirectory directory;
  const auto nods = [](int k) { return 0.01 * std::abs(k - 60); };
  LogClock clock = clock_of(directory, 120, nods);
  for (int k = 0; k < 120; ++k) {
    REQUIRE(given(clock, k, nods) == k);
    if (k == 20) CHECK(given(clock, k, nods, 1) == Approx(20.1));  // 100 has the angle of 20
  }
  CHECK(clock.not_recorded() == 1);
  CHECK(clock.recorded()->missed() == 0);
}

TEST_CASE("recorded times: while a servo rests its equal frames are met one by one, however late they come") {
  const TemporaryDirectory directory;
  const auto rests = [](int) { return 0.3; };
  LogClock clock = clock_of(directory, 100, rests);
  for (int k = 0; k < 100; ++k) REQUIRE(given(clock, k, rests, k % 7 * 6) == k);
  CHECK(clock.recorded()->missed() == 0);
}

TEST_CASE("recorded times: a player that stalls, at first or for seconds, has each frame met when it catches up") {
  const TemporaryDirectory directory;
  const auto nods = [](int k) { return 0.01 * std::abs(k - 200); };
  LogClock clock = clock_of(directory, 400, nods);
  const auto late_ms = [](int k) { return k < 50 ? std::max(0, 700 - 20 * k) : std::max(0, 2500 - 10 * (k - 50)); };
  for (int k = 0; k < 400; ++k) REQUIRE(given(clock, k, nods, late_ms(k)) == k);
  CHECK(clock.not_recorded() == 0);
  CHECK(clock.recorded()->missed() == 0);
}

TEST_CASE("recorded times: a frame that was not recorded has the time of its arrival, and the next its own") {
  const TemporaryDirectory directory;
  const auto rises = [](int k) { return 0.001 * k; };
  LogClock clock = clock_of(directory, 50, rises);
  REQUIRE(given(clock, 0, rises) == 0);
  can::Frame other = position(bus0 + 14 * ms, 0.7);
  clock.set_log_time(other, t0);
  CHECK(other.time_ns == t0 + 14 * ms);
  CHECK(clock.not_recorded() == 1);
  CHECK(given(clock, 2, rises) == 2);
}

}  // namespace
}  // namespace curbline::tools::testing
