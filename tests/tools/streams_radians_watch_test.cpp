// Angles of a servo that nods from 0.2 to 1.2 rad and back within 4 s, 100 a second.
#include "streams/radians_watch.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace curbline::tools::testing {
namespace {

constexpr std::int64_t period_ns = 10'000'000;
constexpr float degrees = 180.0f / std::numbers::pi_v<float>;

TiltReading nod(int i) {
  const int phase = i % 400;
  return {i * period_ns, 0.2f + static_cast<float>(phase < 200 ? phase : 400 - phase) / 200.0f};
}

RadiansWatch watch_of(float sweep_s = 4.0f) {
  RadiansWatch watch;
  watch.init(sweep_s);
  return watch;
}

TEST_CASE("radians watch: degrees are in doubt within a second, and as long as they come") {
  for (const int start : {0, 57, 100, 200, 399}) {
    INFO(start);
    RadiansWatch watch = watch_of();
    int since = -1, certain = 0;
    for (int i = start; i < start + 2000; ++i) {
      TiltReading reading = nod(i);
      reading.angle_rad *= degrees;
      watch.update(reading);
      if (since < 0 && watch.in_doubt()) {
        since = i - start;
        CHECK(watch.beyond() >= 16);  // those that led to the doubt as well
      }
      certain += since >= 0 && !watch.in_doubt();
    }
    CHECK(since > 0);
    CHECK(since < 100);
    CHECK(certain == 0);
    CHECK(watch.beyond() > 1000);
  }
}

TEST_CASE("radians watch: degrees that pass a turn from reading to reading are in doubt as well") {
  RadiansWatch watch = watch_of(1.0f);
  for (int i = 0; i < 200; ++i) watch.update({i * period_ns, 60.0f * std::sin(0.3f * static_cast<float>(i))});
  CHECK(watch.in_doubt());
}

TEST_CASE("radians watch: radians are not, whatever the servo's zero and turning, with one frame in four damaged") {
  for (const float zero : {0.0f, 12.0f, -300.0f}) {
    INFO(zero);
    for (const int damaged : {0, 1, 2, 3}) {
      RadiansWatch watch = watch_of();
      for (int i = 0; i < 2000; ++i) {
        TiltReading reading = nod(i);
        reading.angle_rad = i % 4 == damaged ? 1e5f * static_cast<float>(i % 7 - 3) : zero - reading.angle_rad;
        watch.update(reading);
        REQUIRE_FALSE(watch.in_doubt());
      }
      CHECK(watch.beyond() == 0);
    }
  }
}

TEST_CASE("radians watch: a servo that is given another zero, turns away, is in doubt for two sweeps at most") {
  RadiansWatch watch = watch_of();
  for (int i = 0; i < 3000; ++i) {
    TiltReading reading = nod(i);
    if (i > 130) reading.angle_rad += 20.0f;
    watch.update(reading);
    if (i > 130 + 2 * 402) REQUIRE_FALSE(watch.in_doubt());
  }
}

TEST_CASE("radians watch: a clock that is set back begins anew") {
  RadiansWatch watch = watch_of();
  for (int i = 0; i < 3000; ++i) {
    TiltReading reading = nod(i);
    if (i > 500) {  // the servo has started again meanwhile, too
      reading.time_ns -= 3'600'000'000'000;
      reading.angle_rad += 20.0f;
    }
    watch.update(reading);
    REQUIRE_FALSE(watch.in_doubt());
  }
}

}  // namespace
}  // namespace curbline::tools::testing
