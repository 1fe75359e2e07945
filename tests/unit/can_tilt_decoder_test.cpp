// Frames to tilt readings: what is passed on, what is dropped and counted, and the time that SYNC defines.
#include "curbline/can/tilt_decoder.hpp"

#include <atomic>
#include <bit>
#include <catch2/catch.hpp>
#include <random>
#include <thread>

#include "curbline/can/servo_presets.hpp"

using namespace curbline;
using namespace curbline::can;

namespace {

constexpr std::int64_t ms = 1'000'000, us = 1'000;
constexpr std::int64_t t0 = 1'290'682'980'025'000'000;

Frame position(std::int64_t time_ns, double angle_rad, std::uint8_t node = 1) {
  Frame frame;
  encode(cia402_position(node), angle_rad, frame);
  frame.time_ns = time_ns;
  return frame;
}

Frame sync(std::int64_t time_ns) {
  Frame frame;
  frame.id = default_sync_id;
  frame.time_ns = time_ns;
  return frame;
}

TiltDecoder decoder(std::optional<std::uint16_t> sync_id = std::nullopt) {
  TiltDecoder out;
  REQUIRE(out.init(cia402_position(1), sync_id));
  return out;
}

bool adds_up(const TiltDecoderCounters& c) {
  return c.frames == c.readings + c.others + c.syncs + c.malformed + c.without_sync;
}

}  // namespace

TEST_CASE("tilt decoder: a position frame is a reading of the frame's time") {
  TiltDecoder tilt = decoder();
  const auto reading = tilt.take(position(t0, 0.5));
  REQUIRE(reading);
  CHECK(reading->time_ns == t0);
  CHECK(reading->angle_rad == Approx(0.5).margin(6e-6));
  CHECK(tilt.counters().readings == 1);
}

TEST_CASE("tilt decoder: every frame is counted once, by what became of it") {
  TiltDecoder tilt = decoder();
  Frame cut = position(t0, 0.5);
  cut.length = 5;
  Frame request = position(t0, 0.5);
  request.remote = true;
  CHECK(tilt.take(position(t0, 0.5)));
  CHECK_FALSE(tilt.take(cut));
  CHECK_FALSE(tilt.take(request));
  CHECK_FALSE(tilt.take(position(t0, 0.5, 2)));
  CHECK_FALSE(tilt.take(sync(t0)));  // has no meaning for a servo that sends by itself
  const TiltDecoderCounters c = tilt.counters();
  CHECK(c.frames == 5);
  CHECK(c.readings == 1);
  CHECK(c.malformed == 1);
  CHECK(c.others == 3);
  CHECK(adds_up(c));
}

TEST_CASE("tilt decoder: a float that is no angle of a servo is malformed") {
  TiltDecoder tilt;
  REQUIRE(tilt.init(odrive_encoder_estimates(3)));
  for (const std::uint32_t bits : {0x7F800000u, 0x7FC00000u, 0xFF800000u, std::bit_cast<std::uint32_t>(1e30f)}) {
    Frame frame;
    frame.id = 0x69;
    frame.length = 8;
    for (std::size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<std::uint8_t>(bits >> (8 * i));
    CHECK_FALSE(tilt.take(frame));
  }
  CHECK(tilt.counters().malformed == 4);
}

TEST_CASE("tilt decoder: without a valid signal nothing is decoded") {
  TiltDecoder tilt;
  CHECK_FALSE(tilt.take(position(t0, 0.5)));
  CHECK_FALSE(tilt.take(Frame{.time_ns = t0, .length = 8}));  // id 0, as of an NMT command
  CHECK_FALSE(tilt.init(Signal{.id = 0x800}));
  CHECK_FALSE(tilt.take(position(t0, 0.5)));
  CHECK_FALSE(tilt.init(cia402_position(1), 0x800));
  CHECK_FALSE(tilt.init(cia402_position(1), 0x181));  // no frame can be both
  CHECK_FALSE(tilt.take(position(t0, 0.5)));
  CHECK(tilt.init(cia402_position(1)));
  CHECK(tilt.counters().frames == 0);
  CHECK(tilt.take(position(t0, 0.5)));
}

TEST_CASE("tilt decoder: with SYNC the angle is that of the SYNC's time, however late it is sent") {
  TiltDecoder tilt = decoder(default_sync_id);
  for (int k = 0; k < 10; ++k) {
    const std::int64_t sampled = t0 + 10 * ms * k;
    CHECK_FALSE(tilt.take(sync(sampled)));
    const auto reading = tilt.take(position(sampled + 200 * us + 900 * us * k, 0.1 * k));
    REQUIRE(reading);
    CHECK(reading->time_ns == sampled);
    CHECK(reading->angle_rad == Approx(0.1 * k).margin(6e-6));
  }
  CHECK(tilt.counters().syncs == 10);
  CHECK(tilt.counters().readings == 10);
}

TEST_CASE("tilt decoder: a SYNC that counts, and one of another id, is a SYNC as it was set up") {
  TiltDecoder tilt = decoder(std::uint16_t{0x7F});
  Frame counting = sync(t0);
  counting.id = 0x7F;
  counting.length = 1;
  counting.data[0] = 240;
  tilt.take(counting);
  tilt.take(sync(t0 + us));
  CHECK(tilt.take(position(t0 + ms, 0.5))->time_ns == t0);
  CHECK(tilt.counters().others == 1);
}

TEST_CASE("tilt decoder: what has the SYNC's id and is another kind of frame is none") {
  TiltDecoder tilt = decoder(default_sync_id);
  for (bool Frame::*const other : {&Frame::extended, &Frame::remote, &Frame::error}) {
    tilt.take(sync(t0));
    Frame frame = sync(t0 + us);
    frame.*other = true;
    tilt.take(frame);
    CHECK(tilt.take(position(t0 + ms, 0.5))->time_ns == t0);
  }
  CHECK(tilt.counters().others == 3);
}

TEST_CASE("tilt decoder: a bus whose clock is set back is followed") {
  TiltDecoder tilt = decoder(default_sync_id);
  for (int k = 0; k < 5; ++k) tilt.take(sync(t0 + 10 * ms * k));
  tilt.take(sync(t0 - 5000 * ms));
  CHECK(tilt.take(position(t0 - 5000 * ms + 300 * us, 0.5))->time_ns == t0 - 5000 * ms);
}

TEST_CASE("tilt decoder: a frame whose stamp is no time is dropped, and those after it are taken") {
  TiltDecoder tilt = decoder(default_sync_id);
  for (int k = 0; k < 5; ++k) tilt.take(sync(t0 + 10 * ms * k));
  for (const std::int64_t no_time_ns : {INT64_MIN, INT64_MAX}) {
    tilt.take(sync(no_time_ns));
    CHECK_FALSE(tilt.take(position(no_time_ns, 0.5)));
  }
  CHECK(tilt.counters().syncs == 5);
  CHECK(tilt.counters().malformed == 2);
  CHECK(tilt.take(position(t0 + 40 * ms + 300 * us, 0.5))->time_ns == t0 + 40 * ms);
}

TEST_CASE("tilt decoder: a drive may answer every n-th SYNC") {
  TiltDecoder tilt = decoder(default_sync_id);
  for (int k = 0; k < 20; ++k) {
    tilt.take(sync(t0 + 2 * ms * k));
    if (k % 5 == 4) CHECK(tilt.take(position(t0 + 2 * ms * k + 300 * us, 0.5))->time_ns == t0 + 2 * ms * k);
  }
  CHECK(tilt.counters().without_sync == 0);
}

TEST_CASE("tilt decoder: a position whose SYNC was not seen is dropped and counted, the next is good again") {
  TiltDecoder tilt = decoder(default_sync_id);
  for (int k = 6; k >= 2; --k) tilt.take(sync(t0 - 10 * ms * k));
  SECTION("one SYNC lost") {
    tilt.take(sync(t0 - 10 * ms));
    REQUIRE(tilt.take(position(t0 - 10 * ms + 300 * us, 0.5)));
    CHECK_FALSE(tilt.take(position(t0 + 300 * us, 0.5)));
  }
  SECTION("a position repeated") {
    tilt.take(sync(t0));
    REQUIRE(tilt.take(position(t0 + 300 * us, 0.5)));
    CHECK_FALSE(tilt.take(position(t0 + 310 * us, 0.5)));
  }
  SECTION("a position lost, and the next one's SYNC") {
    tilt.take(sync(t0 - 10 * ms));
    CHECK_FALSE(tilt.take(position(t0 + 300 * us, 0.5)));
  }
  SECTION("the same just after another SYNC was lost") {
    tilt.take(sync(t0 - 20 * ms + 10 * ms));
    tilt.take(position(t0 - 10 * ms + 300 * us, 0.5));
    tilt.take(sync(t0 + 10 * ms));  // 20 ms after the last one
    CHECK_FALSE(tilt.take(position(t0 + 20 * ms + 300 * us, 0.5)));
  }
  SECTION("the same just after a SYNC was repeated") {
    tilt.take(sync(t0 - 10 * ms));
    tilt.take(sync(t0 - 10 * ms + 100 * us));
    CHECK(tilt.take(position(t0 - 10 * ms + 300 * us, 0.5)));
    CHECK_FALSE(tilt.take(position(t0 + 300 * us, 0.5)));
  }
  SECTION("a position older than its SYNC") {
    tilt.take(sync(t0));
    CHECK_FALSE(tilt.take(position(t0 - 1, 0.5)));
  }
  CHECK(tilt.counters().without_sync == 1);
  tilt.take(sync(t0 + 40 * ms));
  CHECK(tilt.take(position(t0 + 40 * ms + 300 * us, 0.5))->time_ns == t0 + 40 * ms);
  CHECK(adds_up(tilt.counters()));
}

TEST_CASE("tilt decoder: before the second SYNC a position is taken within 5 ms, later ones are dropped") {
  TiltDecoder tilt = decoder(default_sync_id);
  CHECK_FALSE(tilt.take(position(t0 - 1 * ms, 0.5)));
  tilt.take(sync(t0));
  SECTION("soon") {
    CHECK(tilt.take(position(t0 + 4 * ms, 0.5)));
  }
  SECTION("late: of another SYNC that was lost") {
    CHECK_FALSE(tilt.take(position(t0 + 900 * ms, 0.5)));
    CHECK(tilt.counters().without_sync == 2);
  }
  tilt.take(sync(t0 + 1000 * ms));
  CHECK(tilt.take(position(t0 + 1000 * ms + 300 * us, 0.5)));
}

TEST_CASE("tilt decoder: after a silence of the bus positions are taken as before") {
  TiltDecoder tilt = decoder(default_sync_id);
  for (int k = 0; k < 5; ++k) tilt.take(sync(t0 + 10 * ms * k));
  tilt.take(sync(t0 + 9000 * ms));
  CHECK(tilt.take(position(t0 + 9000 * ms + 300 * us, 0.5)));
  CHECK_FALSE(tilt.take(position(t0 + 9010 * ms + 300 * us, 0.5)));  // its SYNC was lost
}

TEST_CASE("tilt decoder: a damaged position uses its SYNC up") {
  TiltDecoder tilt = decoder(default_sync_id);
  tilt.take(sync(t0));
  Frame cut = position(t0 + 300 * us, 0.5);
  cut.length = 2;
  CHECK_FALSE(tilt.take(cut));
  CHECK_FALSE(tilt.take(position(t0 + 400 * us, 0.5)));
  CHECK(tilt.counters().malformed == 1);
  CHECK(tilt.counters().without_sync == 1);
}

TEST_CASE("tilt decoder: any mix of frames is survived, and the counters add up") {
  std::mt19937 random(7);
  TiltDecoder tilt = decoder(default_sync_id);
  std::int64_t time_ns = t0;
  for (int k = 0; k < 100'000; ++k) {
    time_ns += static_cast<std::int64_t>(random() % 2'000'000) - 200'000;
    Frame frame = random() % 3 == 0 ? sync(time_ns) : position(time_ns, 0.5);
    if (random() % 4 == 0) frame.id ^= 1u << random() % 11;
    if (random() % 8 == 0) frame.length = static_cast<std::uint8_t>(random() % 9);
    if (random() % 16 == 0) frame.extended = true;
    if (random() % 16 == 0) frame.error = true;
    const auto reading = tilt.take(frame);
    if (reading) REQUIRE(reading->time_ns <= frame.time_ns);
  }
  const TiltDecoderCounters c = tilt.counters();
  CHECK(c.frames == 100'000);
  CHECK(c.readings > 1000);
  CHECK(adds_up(c));
}

TEST_CASE("tilt decoder: counters may be read while frames are taken") {
  TiltDecoder tilt = decoder();
  std::atomic<bool> done{false};
  std::thread reader([&] {
    std::uint32_t last = 0;
    while (!done) {
      const std::uint32_t now = tilt.counters().frames;
      if (now < last) std::terminate();
      last = now;
    }
  });
  for (int k = 0; k < 200'000; ++k) tilt.take(position(t0 + k, 0.5));
  done = true;
  reader.join();
  CHECK(tilt.counters().readings == 200'000);
}
