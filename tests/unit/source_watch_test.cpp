// The watch on a source of readings: each change is reported once, and its state depends on the age of the newest
// reading.
#include "curbline/intake/source_watch.hpp"

#include <catch2/catch.hpp>

namespace curbline {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t t0 = 1'290'682'980'025'000'000;

SourceWatch watch() {
  SourceWatch out;
  out.init(0.2f, false);
  return out;
}

TEST_CASE("source watch: a servo that never reports is told once, after the bound") {
  SourceWatch tilt = watch();
  CHECK(tilt.update(SourceWatch::no_reading, t0) == SourceEvent::none);
  CHECK(tilt.update(SourceWatch::no_reading, t0 + 199 * ms) == SourceEvent::none);
  CHECK(tilt.update(SourceWatch::no_reading, t0 + 201 * ms) == SourceEvent::missing);
  CHECK(tilt.update(SourceWatch::no_reading, t0 + 500 * ms) == SourceEvent::none);
  CHECK(tilt.state() == SourceState::never);
  CHECK(tilt.times_lost() == 0);
  CHECK(tilt.update(t0 + 600 * ms, t0 + 600 * ms) == SourceEvent::first);
  CHECK(tilt.state() == SourceState::ok);
}

TEST_CASE("source watch: silence is told once, recovery once") {
  SourceWatch tilt = watch();
  CHECK(tilt.update(t0, t0) == SourceEvent::first);
  CHECK(tilt.update(t0, t0 + 199 * ms) == SourceEvent::none);
  CHECK(tilt.update(t0, t0 + 201 * ms) == SourceEvent::lost);
  CHECK(tilt.state() == SourceState::stale);
  CHECK(tilt.update(t0, t0 + 202 * ms) == SourceEvent::none);
  CHECK(tilt.update(t0, t0 + 900 * ms) == SourceEvent::none);
  CHECK(tilt.update(t0 + 901 * ms, t0 + 901 * ms) == SourceEvent::recovered);
  CHECK(tilt.state() == SourceState::ok);
  CHECK(tilt.update(t0 + 902 * ms, t0 + 902 * ms) == SourceEvent::none);
  CHECK(tilt.times_lost() == 1);
  CHECK(tilt.longest_silence_ns() == 900 * ms);
}

TEST_CASE("source watch: a first reading that is old already is a servo lost, not one found") {
  SourceWatch tilt = watch();
  CHECK(tilt.update(t0, t0 + 300 * ms) == SourceEvent::lost);
  CHECK(tilt.update(t0 + 301 * ms, t0 + 301 * ms) == SourceEvent::recovered);
}

TEST_CASE("source watch: readings ahead of the clock are fresh") {
  SourceWatch tilt = watch();
  CHECK(tilt.update(t0 + 50 * ms, t0) == SourceEvent::first);
  CHECK(tilt.longest_silence_ns() == 0);
}

TEST_CASE("source watch: a tilt that is fixed is well without a servo") {
  SourceWatch tilt;
  tilt.init(0.2f, true);
  CHECK(tilt.state() == SourceState::ok);
  CHECK(tilt.update(SourceWatch::no_reading, t0) == SourceEvent::none);
  CHECK(tilt.update(SourceWatch::no_reading, t0 + 900 * ms) == SourceEvent::none);
  CHECK(tilt.state() == SourceState::ok);
}

TEST_CASE("source watch: a new start forgets") {
  SourceWatch tilt = watch();
  tilt.update(t0, t0);
  tilt.update(t0, t0 + 300 * ms);
  tilt.init(0.2f, false);
  CHECK(tilt.state() == SourceState::never);
  CHECK(tilt.times_lost() == 0);
  CHECK(tilt.update(t0 + 400 * ms, t0 + 400 * ms) == SourceEvent::first);
}

}  // namespace
}  // namespace curbline
