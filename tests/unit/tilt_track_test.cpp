// The tilt servo's readings: interpolation and its bounds, bad readings, and a reader beside a writer that never waits.
#include "curbline/intake/tilt_track.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "support/terrain.hpp"

namespace curbline {
namespace {

constexpr Limits limits{.tilt_samples = 16};
using Track = TiltTrack<limits>;
using Snapshot = TiltSnapshot<limits>;
using Source = TiltAngle::Source;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t t0 = 1'290'682'980'025'000'000;  // nanoseconds of the epoch need more than 32 bits

/// A track with readings every 25 ms from a servo that turns at 0.3 rad/s.
std::unique_ptr<Track> turning(int readings, const TiltSettings& settings = {}) {
  auto track = std::make_unique<Track>();
  track->init(settings);
  for (int k = 0; k < readings; ++k) REQUIRE(track->push({t0 + 25 * ms * k, -0.2f + 0.0075f * static_cast<float>(k)}));
  return track;
}

Snapshot snapshot(Track& track, std::int64_t until_ns = INT64_MAX) {
  Snapshot out;
  track.snapshot(out, 0.0f, until_ns);
  return out;
}

TEST_CASE("tilt track: between two readings the angle is on the line through them") {
  const auto track = turning(10);
  Snapshot angles = snapshot(*track);
  for (int k = 0; k <= 90; ++k) {
    const TiltAngle a = angles.at(t0 + 5 * ms / 2 * k);
    CHECK(a.source == Source::interpolated);
    CHECK(a.angle_rad == Approx(-0.2 + 0.00075 * k).margin(1e-6));
    CHECK(a.rate_rad_s == Approx(0.3).epsilon(1e-4));
  }
}

TEST_CASE("tilt track: beyond its ends the angle goes on at the same rate, up to the bound") {
  const auto track = turning(10);
  Snapshot angles = snapshot(*track);
  const std::int64_t last = t0 + 225 * ms;
  const auto at = [&](std::int64_t time) {
    angles.rewind();
    return angles.at(time);
  };
  CHECK(at(last).source == Source::interpolated);
  CHECK(at(last + 50 * ms).source == Source::extrapolated);
  CHECK(at(last + 50 * ms).angle_rad == Approx(-0.2 + 0.0675 + 0.015).margin(1e-6));
  CHECK(at(last + 50 * ms + 1000).source == Source::none);
  CHECK(at(t0 - 50 * ms).source == Source::extrapolated);
  CHECK(at(t0 - 50 * ms).angle_rad == Approx(-0.2 - 0.015).margin(1e-6));
  CHECK(at(t0 - 50 * ms - 1000).source == Source::none);
}

TEST_CASE("tilt track: two stamps that lie close together do not tell the rate far beyond them") {
  const auto track = turning(10);  // 0.0075 rad in 25 ms
  // A frame that waited on the bus for the next one: an angle 2.25 mrad earlier, stamped 0.2 ms before it.
  track->push({t0 + 250 * ms - ms / 5, -0.2f + 0.075f - 0.00225f});
  track->push({t0 + 250 * ms, -0.2f + 0.075f});
  Snapshot angles = snapshot(*track);
  const TiltAngle beyond = angles.at(t0 + 270 * ms);
  CHECK(beyond.source == Source::extrapolated);
  CHECK(beyond.angle_rad == Approx(-0.2 + 0.081).margin(1e-4));
  CHECK(beyond.rate_rad_s == Approx(0.3).epsilon(0.01));
}

TEST_CASE("tilt track: readings that come as fast as their stamps jitter tell the rate all the same") {
  constexpr Limits many{.tilt_samples = 64};
  const auto track = std::make_unique<TiltTrack<many>>();
  track->init(TiltSettings{});
  test::Noise noise(5);
  for (int k = 0; k < 64; ++k) {  // 0.3 rad/s at 1 kHz, stamped up to 0.4 ms early or late
    const double jitter_ms = std::clamp(0.4 * noise.normal(), -0.4, 0.4);
    track->push({t0 + k * ms + static_cast<std::int64_t>(jitter_ms * 1e6), 0.3e-3f * static_cast<float>(k)});
  }
  TiltSnapshot<many> angles;
  track->snapshot(angles, 0.0f, INT64_MAX);
  for (int k = 0; k < 280; ++k) {
    const double time_ms = 0.25 * k - 3.0;
    INFO(time_ms << " ms");
    const TiltAngle angle = angles.at(t0 + static_cast<std::int64_t>(time_ms * 1e6));
    CHECK(angle.rate_rad_s == Approx(0.3).epsilon(0.053));  // 0.8 of 15 ms
    CHECK(angle.angle_rad == Approx(0.3e-3 * time_ms).margin(0.3e-3));
  }
}

TEST_CASE("tilt track: how many readings have come after a line's last beam changes none of its angles") {
  const auto track = std::make_unique<Track>();
  track->init(TiltSettings{});
  const std::int64_t last_beam = t0 + 47 * ms;
  std::vector<std::pair<float, float>> told;
  for (int k = 0; k < 16; ++k) {  // every 5 ms, ever faster
    track->push({t0 + 5 * k * ms, 1e-4f * static_cast<float>(k * k)});
    if (t0 + 5 * k * ms <= last_beam) continue;
    Snapshot angles = snapshot(*track, last_beam);
    std::vector<std::pair<float, float>> now;
    for (std::int64_t time = t0 + 22 * ms; time <= last_beam; time += ms) {
      const TiltAngle angle = angles.at(time);
      now.emplace_back(angle.angle_rad, angle.rate_rad_s);
    }
    CHECK(angles.reading_number() == 10);
    if (told.empty()) told = now;
    CHECK(now == told);
  }
  CHECK(told.size() == 26);
}

/// Readings every 10 ms, in the order given, in milliradians.
void push_mrad(TiltTrack<Limits{}>& track, std::int64_t from_ns, const std::vector<float>& angles) {
  for (std::size_t k = 0; k < angles.size(); ++k) {
    REQUIRE(track.push({from_ns + 10 * ms * static_cast<std::int64_t>(k), 1e-3f * angles[k]}));
  }
}

/// A track in which an angle was sent again so many times in a row, a second before t0.
std::unique_ptr<TiltTrack<Limits{}>> track_with(int repeats) {
  auto track = std::make_unique<TiltTrack<Limits{}>>();
  track->init(TiltSettings{});
  std::vector<float> angles{0, 10};
  for (int k = 0; k < repeats; ++k) angles.push_back(10);
  angles.push_back(10 * static_cast<float>(repeats + 2));
  push_mrad(*track, t0 - 1000 * ms, angles);
  TiltSnapshot<Limits{}> told;
  track->snapshot(told, 0.0f, INT64_MAX);
  REQUIRE(told.most_repeats() == repeats);
  return track;
}

/// The angles at the times of those readings, in milliradians, if there have been `repeats` in a row before.
std::vector<float> told_mrad(const std::vector<float>& angles, int repeats = 0) {
  TiltSnapshot<Limits{}> told;
  const auto track = track_with(repeats);
  push_mrad(*track, t0, angles);
  track->snapshot(told, 0.0f, INT64_MAX);
  std::vector<float> out;
  for (std::size_t k = 0; k < angles.size(); ++k) {
    out.push_back(std::round(1e4f * told.at(t0 + 10 * ms * static_cast<std::int64_t>(k)).angle_rad) / 10.0f);
  }
  return out;
}

TEST_CASE("tilt track: an angle sent again under a new stamp while the servo turns is none of that time") {
  CHECK(told_mrad({0, 5, 10, 10, 20, 25, 25, 25, 40, 45}) == std::vector<float>{0, 5, 10, 15, 20, 25, 30, 35, 40, 45});
  CHECK(told_mrad({0, -6, -12, -12, -24, -30}) == std::vector<float>{0, -6, -12, -18, -24, -30});
  // Angles of 33 Hz sent at 100 Hz: the first three are not known to be repeats.
  CHECK(told_mrad({0, 0, 0, 15, 15, 15, 30, 30, 30, 45}) == std::vector<float>{0, 0, 0, 15, 20, 25, 30, 35, 40, 45});
}

TEST_CASE("tilt track: a servo that stands keeps its angle, and so does one that turns round or is coarse") {
  const auto stays = [](const std::vector<float>& angles, int repeats = 0) {
    CHECK(told_mrad(angles, repeats) == angles);
  };
  stays({0, 5, 10, 10, 10, 10, 10, 10, 15, 20});  // it stops, and goes on
  stays({0, 5, 10, 10, 15, 20, 25});              // for a moment only
  stays({0, 5, 10, 10, 10, 10, 10, 10, 22, 34});  // twice as fast
  stays({0, 5, 10, 10, 10, 10});                  // until now
  stays({0, 5, 10, 10, 10, 10}, 2);               // for longer than repeats have been seen
  stays({0, 5, 10, 10, 0, -10});                  // it turns round
  stays({0, 2, 2, 4, 4, 4, 8, 8, 10});            // steps of its resolution
  stays({10, 10, 10, 10});
}

TEST_CASE("tilt track: where repeats have been seen the newest angle may be one") {
  CHECK(told_mrad({0, 5, 10, 10}) == std::vector<float>{0, 5, 10, 10});
  CHECK(told_mrad({0, 5, 10, 10}, 2) == std::vector<float>{0, 5, 10, 15});
  CHECK(told_mrad({0, 5, 10, 10, 20, 25, 25}) == std::vector<float>{0, 5, 10, 15, 20, 25, 30});
}

TEST_CASE("tilt track: that repeats have been seen is known for good, until it is initialised") {
  const auto newest_mrad = [](TiltTrack<Limits{}>& track) {
    std::vector<float> angles;
    for (int k = 0; k < Limits{}.tilt_samples; ++k) angles.push_back(static_cast<float>(5 * k));
    angles.push_back(angles.back());
    push_mrad(track, t0, angles);
    TiltSnapshot<Limits{}> told;
    track.snapshot(told, 0.0f, INT64_MAX);
    return 1e3f * told.at(t0 + 10 * ms * Limits{}.tilt_samples).angle_rad;
  };
  CHECK(newest_mrad(*track_with(0)) == Approx(315.0));
  CHECK(newest_mrad(*track_with(1)) == Approx(320.0));
  const auto anew = track_with(1);
  anew->init(TiltSettings{});
  CHECK(newest_mrad(*anew) == Approx(315.0));
}

TEST_CASE("tilt track: a repeat is not put where a rate between stamps a moment apart would have it, nor far beyond") {
  const auto track = track_with(1);
  track->push({t0, 0.0f});
  track->push({t0 + 198 * ms / 10, 0.010f});  // waited on the bus for the next one
  track->push({t0 + 20 * ms, 0.015f});
  track->push({t0 + 30 * ms, 0.015f});
  TiltSnapshot<Limits{}> told;
  track->snapshot(told, 0.0f, t0 + 29 * ms);
  CHECK(told.at(t0 + 29 * ms).angle_rad == Approx(0.015f));
  const std::vector<float> stops{0, 20, 40, 40, 40, 40, 40, 40, 40};  // 60 ms: max_extrapolation_s is 50
  CHECK(told_mrad(stops, 9) == stops);
}

TEST_CASE("tilt track: how many readings have come after a line does not decide what is a repeat") {
  const std::vector<float> angles{0, 5, 10, 10, 20, 25, 30, 30, 40, 45, 50};
  const std::int64_t last_beam = t0 + 65 * ms;  // awaits the repeat at 70 ms
  for (std::size_t known = 8; known <= angles.size(); ++known) {
    TiltSnapshot<Limits{}> told;
    const auto track = track_with(0);
    push_mrad(*track, t0, {angles.begin(), angles.begin() + static_cast<std::ptrdiff_t>(known)});
    track->snapshot(told, 0.0f, last_beam);
    CHECK(told.at(last_beam).angle_rad == Approx(0.0325));
  }
}

TEST_CASE("tilt track: near a turn, beside a damaged reading and where readings come slowly the rate is their own") {
  TiltSettings settings;
  settings.angle_sd_rad = 1e-4f;
  const auto turns = std::make_unique<Track>(), damaged = std::make_unique<Track>();
  turns->init(settings);
  damaged->init(settings);
  for (int k = 5; k <= 20; ++k) {  // every 5 ms at 0.2 rad/s; one track turns back at 50 ms
    turns->push({t0 + 5 * k * ms, 1e-3f * static_cast<float>(k < 10 ? k : 20 - k)});
    damaged->push({t0 + 5 * k * ms, 1e-3f * static_cast<float>(k) + (k == 12 ? 0.05f : 0.0f)});
  }
  Snapshot turned = snapshot(*turns), beside = snapshot(*damaged);
  for (const int time_ms : {37, 47, 49}) CHECK(turned.at(t0 + time_ms * ms).rate_rad_s == Approx(0.2).epsilon(1e-3));
  for (const int time_ms : {51, 63}) CHECK(turned.at(t0 + time_ms * ms).rate_rad_s == Approx(-0.2).epsilon(1e-3));
  for (const int time_ms : {47, 52, 67, 72})
    CHECK(beside.at(t0 + time_ms * ms).rate_rad_s == Approx(0.2).epsilon(1e-3));
  const auto slow = turning(10);  // every 25 ms
  slow->push({t0 + 250 * ms, -0.2f});
  Snapshot back = snapshot(*slow);
  CHECK(back.at(t0 + 220 * ms).rate_rad_s == Approx(0.3).epsilon(1e-3));
  CHECK(back.at(t0 + 230 * ms).rate_rad_s == Approx(-0.0675 / 0.025).epsilon(1e-3));
}

TEST_CASE("tilt track: the sample that tells the rate is found between stamps as far apart as any") {
  const std::array<std::int64_t, 2> times{-3'000'000'000'000'000'000, 3'000'000'000'000'000'000};
  const auto time_of = [&](int k) { return times[static_cast<std::size_t>(k)]; };
  CHECK(sample_for_rate(times[1] + 10 * ms, 1, -1, 2, time_of) == 0);
  CHECK(sample_for_rate(times[0] - 10 * ms, 0, 1, 2, time_of) == 1);
}

TEST_CASE("tilt track: readings a moment apart alone tell no rate") {
  const auto track = std::make_unique<Track>();
  track->init(TiltSettings{});
  track->push({t0, 0.5f});
  track->push({t0 + 1, 100.0f});
  Snapshot angles = snapshot(*track);
  CHECK(angles.at(t0 + 1).source == Source::interpolated);
  CHECK(angles.at(t0 + 2).source == Source::extrapolated);
  CHECK(angles.at(t0 + 25 * ms).source == Source::none);
}

TEST_CASE("tilt track: a reading that comes late by the latency is put back to its time") {
  TiltSettings settings;
  settings.latency_s = GENERATE(0.0075f, -0.010f);
  const auto track = turning(10, settings);
  Snapshot angles = snapshot(*track);
  CHECK(angles.at(t0 + 100 * ms).angle_rad ==
        Approx(-0.2 + 0.3 * (0.1 + static_cast<double>(settings.latency_s))).margin(2e-6));
}

TEST_CASE("tilt track: readings too far apart say nothing of the time between") {
  TiltSettings settings;
  settings.max_gap_s = 0.1f;
  const auto track = std::make_unique<Track>();
  track->init(settings);
  track->push({t0, 0.1f});
  track->push({t0 + 100 * ms, 0.2f});
  track->push({t0 + 201 * ms, 0.3f});
  Snapshot angles = snapshot(*track);
  CHECK(angles.at(t0 + 50 * ms).source == Source::interpolated);
  CHECK(angles.at(t0 + 150 * ms).source == Source::none);
  CHECK(angles.at(t0 + 201 * ms).source == Source::interpolated);  // the moment of a reading
  CHECK(angles.at(t0 + 210 * ms).source == Source::none);          // no rate to continue with
}

TEST_CASE("tilt track: across a gap of seconds, where the settings allow it, the angle is on the line all the same") {
  TiltSettings settings;
  settings.max_gap_s = 10.0f;
  const auto track = std::make_unique<Track>();
  track->init(settings);
  track->push({t0, 0.0f});
  track->push({t0 + 8000 * ms, 0.8f});
  Snapshot angles = snapshot(*track);
  for (int k = 0; k < 8; ++k) CHECK(angles.at(t0 + 1000 * ms * k).angle_rad == Approx(0.1 * k).margin(1e-6));
}

TEST_CASE("tilt track: without readings there is no angle, with one there is at its moment only") {
  const auto track = std::make_unique<Track>();
  track->init(TiltSettings{});
  CHECK(snapshot(*track).at(t0).source == Source::none);
  track->push({t0, 0.4f});
  Snapshot angles = snapshot(*track);
  CHECK(angles.at(t0).source == Source::interpolated);
  CHECK(angles.at(t0).angle_rad == 0.4f);
  CHECK(angles.at(t0 + 1).source == Source::none);
}

TEST_CASE("tilt track: repeated, older and not finite readings are dropped and counted") {
  const auto track = turning(3);
  const auto at = t0 + 50 * ms;
  CHECK_FALSE(track->push({at, 0.0f}));
  CHECK_FALSE(track->push({at - 1, 0.0f}));
  CHECK_FALSE(track->push({at + 25 * ms, std::numeric_limits<float>::quiet_NaN()}));
  CHECK_FALSE(track->push({at + 25 * ms, -std::numeric_limits<float>::infinity()}));
  CHECK_FALSE(track->push({at + 25 * ms, 1e30f}));  // a damaged float frame
  CHECK(track->dropped() == 5);
  CHECK(track->push({at + 25 * ms, 0.0f}));  // a dropped reading does not count as the newest
  CHECK(snapshot(*track).at(t0 + 25 * ms).angle_rad == Approx(-0.1925));
}

TEST_CASE("tilt track: after a stamp of the future, or a clock that is set back, readings are taken again") {
  for (const std::int64_t ahead : {500 * ms, 3'600'000 * ms}) {
    const auto track = turning(3);
    REQUIRE(track->push({t0 + 50 * ms + ahead, 0.0f}));
    int refused = 0;
    std::int64_t at = t0 + 75 * ms;
    for (; refused < 100 && !track->push({at, 0.1f}); at += 10 * ms) ++refused;
    CHECK(refused == RisingTimes::most_refused);
    CHECK(snapshot(*track).at(at).angle_rad == 0.1f);
    REQUIRE(track->push({at + 10 * ms, 0.2f}));
    Snapshot angles = snapshot(*track);
    CHECK(angles.at(t0 + 25 * ms).source == Source::none);  // from before
    CHECK(angles.at(at + 5 * ms).angle_rad == Approx(0.15));
    CHECK(angles.at(t0 + 50 * ms + ahead).source == Source::none);
  }
}

TEST_CASE("tilt track: stamps so far away that their difference is no time are dropped") {
  const auto track = turning(3);
  for (const std::int64_t stamp : {INT64_MAX, INT64_MIN, RisingTimes::furthest_ns + 1, -RisingTimes::furthest_ns - 1}) {
    for (int k = 0; k < 20; ++k) CHECK_FALSE(track->push({stamp, 0.1f}));
  }
  CHECK(track->push({t0 + 75 * ms, 0.1f}));
}

TEST_CASE("tilt track: readings that come late do not make it start afresh, however many they are") {
  const auto track = turning(4);
  for (int k = 0; k < 100; ++k) CHECK_FALSE(track->push({t0 + 25 * ms * (k % 3), 0.5f}));
  CHECK(snapshot(*track).at(t0 + 25 * ms).angle_rad == Approx(-0.1925));
  CHECK(track->push({t0 + 100 * ms, 0.0f}));
}

TEST_CASE("tilt track: the newest readings are kept") {
  const auto track = turning(100);
  Snapshot angles = snapshot(*track);
  CHECK(angles.at(t0 + (100 - 15) * 25 * ms).source == Source::interpolated);
  CHECK(angles.at(t0 + 99 * 25 * ms).angle_rad == Approx(-0.2 + 0.0075 * 99).margin(1e-6));
  angles.rewind();
  CHECK(angles.at(t0).source == Source::none);
}

TEST_CASE("tilt track: of a full ring the reading that the writer may be replacing is left out") {
  const auto track = turning(16);
  Snapshot angles = snapshot(*track);
  CHECK(angles.at(t0).source == Source::extrapolated);
  CHECK(angles.at(t0 + 25 * ms).source == Source::interpolated);
}

TEST_CASE("tilt track: after init it starts afresh") {
  const auto track = turning(5);
  track->push({t0, 0.0f});
  track->init(TiltSettings{});
  CHECK(track->dropped() == 0);
  CHECK(snapshot(*track).at(t0).source == Source::none);
  CHECK(track->push({t0 - 1000 * ms, 0.1f}));
}

TEST_CASE("tilt track: a snapshot beside a hammering writer is never torn") {
  // The angle encodes the reading's number, so that a time with another reading's angle would show.
  const auto track = std::make_unique<Track>();
  TiltSettings settings;
  settings.max_gap_s = 1.0f;
  track->init(settings);
  constexpr int readings = 400000;
  std::atomic<int> written{0};
  std::thread writer([&] {
    for (int k = 0; k < readings; ++k) {
      track->push({t0 + static_cast<std::int64_t>(k) * ms, static_cast<float>(k)});
      written.store(k + 1, std::memory_order_release);
    }
  });
  int torn = 0, stale = 0, asked = 0;
  Snapshot angles;
  for (int k = 0; k < readings;) {
    k = written.load(std::memory_order_acquire);
    track->snapshot(angles, 0.0f, INT64_MAX);
    // Queried midway between readings, with rising times: a descending or mixed pair has another angle or rate.
    for (int back = 12; back > 0 && k > 16; --back) {
      const TiltAngle a = angles.at(t0 + static_cast<std::int64_t>(k - back) * ms + ms / 2);
      if (a.source != Source::interpolated) continue;  // replaced in the meantime
      ++asked;
      torn += std::abs(a.angle_rad - (static_cast<float>(k - back) + 0.5f)) > 0.1f ||
              std::abs(a.rate_rad_s - 1000.0f) > 1.0f;
    }
    stale += k > 16 && angles.at(t0 + static_cast<std::int64_t>(k + readings) * ms).source != Source::none;
  }
  writer.join();
  CHECK(torn == 0);
  CHECK(stale == 0);
  CHECK(asked > 10);
}

}  // namespace
}  // namespace curbline
