// Where a servo reverses: what is a sweep, and what is play. tilt_latency_test.cpp has damaged readings.
#include "curbline/intake/sweep_turns.hpp"

#include <catch2/catch.hpp>
#include <cstdint>

namespace curbline {
namespace {

using Turn = SweepTurns::Turn;

constexpr float degree = 0.0174532925f;

/// A servo that is seen by 40 lines a second, each after another reading.
struct Servo {
  explicit Servo(float slow_rad_s) { turns.init(slow_rad_s); }

  /// Turns from where it is to an angle. Returns how many sweeps begin on the way; last_turn_rad is where the last did.
  int turn_to(float to_rad, float rate_rad_s) {
    int sweeps = 0;
    const float step_rad = (to_rad > angle_rad ? rate_rad_s : -rate_rad_s) / 40.0f;
    for (; (to_rad - angle_rad) * step_rad > 0.0f; angle_rad += step_rad) {
      if (turns.follow(angle_rad, step_rad * 40.0f, ++reading) != Turn::new_sweep) continue;
      ++sweeps;
      last_turn_rad = angle_rad;
    }
    return sweeps;
  }

  SweepTurns turns;
  std::uint32_t reading = 0;
  float angle_rad = 0.5f, last_turn_rad = 0.0f;
};

TEST_CASE("sweep turns: a servo that nods by five degrees sweeps, one that holds with two degrees of play does not") {
  const auto sweeps_of_ten_nods = [](float amplitude_rad) {
    Servo servo(0.1f);
    int sweeps = 0;
    for (int nod = 0; nod < 10; ++nod) {
      sweeps += servo.turn_to(0.5f + amplitude_rad, 0.5f);
      sweeps += servo.turn_to(0.5f, 0.5f);
    }
    return sweeps;
  };
  CHECK(sweeps_of_ten_nods(5 * degree) == 19);  // the first one begins with the first line
  CHECK(sweeps_of_ten_nods(2 * degree) == 0);
}

TEST_CASE("sweep turns: a servo that stops and goes on has not turned, however exactly its angle is known") {
  for (const float slow_rad_s : {0.1f, 0.0f}) {
    Servo servo(slow_rad_s);
    int sweeps = servo.turn_to(0.6f, 0.5f);
    for (const float next_rad : {0.8f, 1.0f, 0.7f}) {
      for (int line = 0; line < 20; ++line)
        sweeps += servo.turns.follow(servo.angle_rad, 0.0f, ++servo.reading) != Turn::none;
      sweeps += servo.turn_to(next_rad, 0.5f);
    }
    CHECK(sweeps == 1);
  }
}

TEST_CASE("sweep turns: of a servo too slow for its rate to tell, a turn is seen three degrees after it") {
  Servo servo(0.1f);
  REQUIRE(servo.turn_to(1.0f, 0.02f) == 0);
  CHECK(servo.turn_to(1.0f - 2.5f * degree, 0.02f) == 0);
  CHECK(servo.turn_to(1.0f, 0.02f) == 0);  // it was play
  CHECK(servo.turn_to(0.2f, 0.02f) == 1);
  CHECK(servo.last_turn_rad == Approx(1.0f - 3 * degree).margin(0.3f * degree));
}

}  // namespace
}  // namespace curbline
