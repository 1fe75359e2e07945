// The servo's watch: each change is told once, and its state is that of the newest reading's age.
#include "curbline/intake/tilt_watch.hpp"

#include <catch2/catch.hpp>

namespace curbline {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t t0 = 1'290'682'980'025'000'000;

TiltWatch watch() {
  TiltWatch out;
  out.init(0.2f, false);
  return out;
}

TEST_CASE("tilt watch: a servo that never reports is told once, after the bound") {
  TiltWatch tilt = watch();
  CHECK(tilt.update(TiltWatch::no_reading, t0) == TiltEvent::none);
  CHECK(tilt.update(TiltWatch::no_reading, t0 + 199 * ms) == TiltEvent::none);
  CHECK(tilt.update(TiltWatch::no_reading, t0 + 201 * ms) == TiltEvent::missing);
  CHECK(tilt.update(TiltWatch::no_reading, t0 + 500 * ms) == TiltEvent::none);
  CHECK(tilt.state() == TiltState::never);
  CHECK(tilt.times_lost() == 0);
  CHECK(tilt.update(t0 + 600 * ms, t0 + 600 * ms) == TiltEvent::first);
  CHECK(tilt.state() == TiltState::ok);
}

TEST_CASE("tilt watch: silence is told once, recovery once") {
  TiltWatch tilt = watch();
  CHECK(tilt.update(t0, t0) == TiltEvent::first);
  CHECK(tilt.update(t0, t0 + 199 * ms) == TiltEvent::none);
  CHECK(tilt.update(t0, t0 + 201 * ms) == TiltEvent::lost);
  CHECK(tilt.state() == TiltState::stale);
  CHECK(tilt.update(t0, t0 + 202 * ms) == TiltEvent::none);
  CHECK(tilt.update(t0, t0 + 900 * ms) == TiltEvent::none);
  CHECK(tilt.update(t0 + 901 * ms, t0 + 901 * ms) == TiltEvent::recovered);
  CHECK(tilt.state() == TiltState::ok);
  CHECK(tilt.update(t0 + 902 * ms, t0 + 902 * ms) == TiltEvent::none);
  CHECK(tilt.times_lost() == 1);
  CHECK(tilt.longest_silence_ns() == 900 * ms);
}

TEST_CASE("tilt watch: a first reading that is old already is a servo lost, not one found") {
  TiltWatch tilt = watch();
  CHECK(tilt.update(t0, t0 + 300 * ms) == TiltEvent::lost);
  CHECK(tilt.update(t0 + 301 * ms, t0 + 301 * ms) == TiltEvent::recovered);
}

TEST_CASE("tilt watch: readings ahead of the clock are fresh") {
  TiltWatch tilt = watch();
  CHECK(tilt.update(t0 + 50 * ms, t0) == TiltEvent::first);
  CHECK(tilt.longest_silence_ns() == 0);
}

TEST_CASE("tilt watch: a tilt that is fixed is well without a servo") {
  TiltWatch tilt;
  tilt.init(0.2f, true);
  CHECK(tilt.state() == TiltState::ok);
  CHECK(tilt.update(TiltWatch::no_reading, t0) == TiltEvent::none);
  CHECK(tilt.update(TiltWatch::no_reading, t0 + 900 * ms) == TiltEvent::none);
  CHECK(tilt.state() == TiltState::ok);
}

TEST_CASE("tilt watch: a new start forgets") {
  TiltWatch tilt = watch();
  tilt.update(t0, t0);
  tilt.update(t0, t0 + 300 * ms);
  tilt.init(0.2f, false);
  CHECK(tilt.state() == TiltState::never);
  CHECK(tilt.times_lost() == 0);
  CHECK(tilt.update(t0 + 400 * ms, t0 + 400 * ms) == TiltEvent::first);
}

}  // namespace
}  // namespace curbline
