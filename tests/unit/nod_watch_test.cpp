// The watch on whether the tilt moves.
#include "curbline/intake/nod_watch.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace curbline {
namespace {

/// Readings of 100 Hz.
class Servo {
 public:
  explicit Servo(bool fixed = false) { watch.init(6.0f, fixed); }
  /// For so long at an angle that swings by `swing_rad` to both sides, there and back in `period_s`.
  void run(double seconds, double middle_rad, double swing_rad, double period_s = 6.0) {
    for (const std::int64_t end_ns = time_ns + static_cast<std::int64_t>(seconds * 1e9); time_ns < end_ns;) {
      time_ns += 10'000'000;
      const double turns = 1e-9 * static_cast<double>(time_ns - start_ns) / period_s;
      const double angle_rad = middle_rad + swing_rad * std::sin(2.0 * 3.14159265 * turns);
      const SourceEvent event = watch.update({time_ns, static_cast<float>(angle_rad)});
      rested += event == SourceEvent::lost;
      moved += event == SourceEvent::recovered;
      others += event == SourceEvent::first || event == SourceEvent::missing;
    }
  }

  static constexpr std::int64_t start_ns = 1'290'682'980'025'000'000;
  NodWatch watch;
  std::int64_t time_ns = start_ns;
  int rested = 0, moved = 0, others = 0;
};

TEST_CASE(
    "nod watch: of a laser that nods, slower than stated or by a little more than a servo's play, nothing is told") {
  Servo usual, slow, little;
  usual.run(60.0, 0.7, 0.5);
  slow.run(60.0, 0.7, 0.5, 12.0);
  little.run(60.0, 0.7, 0.06);
  for (const Servo* servo : {&usual, &slow, &little}) {
    CHECK(servo->watch.watch().state() == SourceState::ok);
    CHECK(servo->rested + servo->moved + servo->others == 0);
  }
}

TEST_CASE("nod watch: a tilt that rests is told once, after a sweep there and back, and once that it moves again") {
  Servo servo;
  servo.run(12.0, 0.7, 0.5);
  servo.run(5.9, 0.7, 0.001);
  CHECK(servo.rested == 0);
  servo.run(60.0, 0.7, 0.001);
  CHECK(servo.rested == 1);
  CHECK(servo.watch.watch().state() == SourceState::stale);
  servo.run(12.0, 0.7, 0.5);
  CHECK(servo.moved == 1);
  CHECK(servo.rested == 1);
  CHECK(servo.watch.watch().times_lost() == 1);
}

TEST_CASE("nod watch: an encoder that is stuck from its first reading on is told too, a fixed tilt is not") {
  Servo stuck, fixed(true);
  stuck.run(7.0, 0.3, 0.0);
  fixed.run(7.0, 0.3, 0.0);
  CHECK(stuck.rested == 1);
  CHECK(fixed.rested == 0);
  CHECK(fixed.watch.watch().state() == SourceState::ok);
}

TEST_CASE("nod watch: a clock that is set back does not make a tilt that moves rest") {
  Servo servo;
  servo.run(12.0, 0.7, 0.5);
  servo.time_ns -= 3'600'000'000'000;
  servo.run(12.0, 0.7, 0.5);
  CHECK(servo.rested == 0);
}

TEST_CASE("nod watch: nor does a clock that is set, nor readings that are missing for longer than a sweep takes") {
  Servo servo;
  for (int time = 0; time < 100; ++time) {  // at any angle
    servo.run(2.03, 0.7, 0.5);
    servo.time_ns += 3'600'000'000'000;
  }
  CHECK(servo.rested == 0);
  servo.run(5.0, 0.7, 0.0);
  servo.time_ns += 3'600'000'000'000;
  servo.run(1.0, 0.7, 0.0);
  CHECK(servo.watch.watch().state() == SourceState::ok);  // it may have moved meanwhile
  servo.run(6.0, 0.7, 0.0);
  CHECK(servo.rested == 1);
  servo.time_ns += 3'600'000'000'000;
  servo.run(1.0, 0.7, 0.0);
  CHECK(servo.moved == 0);  // nobody has seen it move
}

}  // namespace
}  // namespace curbline
