// Curbs as frames: bytes as the header says, both ways, and values that no frame can hold.
#include "curbline/can/curb_frames.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "curbline/can/servo_presets.hpp"
#include "curbline/can/tilt_decoder.hpp"

using namespace curbline;
using namespace curbline::can;

namespace {

std::optional<CurbAhead> through(const CurbAhead& curb) {
  std::optional<CurbAhead> back;
  REQUIRE(read_curb_ahead(curb_ahead_frame(curb), back));
  return back;
}

}  // namespace

TEST_CASE("curb frames: a curb's bytes are those of the header") {
  const Frame f = curb_ahead_frame(CurbAhead{1.25f, -0.3f, 0.12f, 0.004f, CurbKind::step_up, 0.96f});
  CHECK(f.id == 0x6A0);
  CHECK_FALSE(f.extended);
  CHECK(f.length == 8);
  // 1250, -300, 120, 4, probability 48 and kind 1
  const std::array<std::uint8_t, 8> bytes{0xE2, 0x04, 0xD4, 0xFE, 0x78, 0x00, 0x04, 48 << 2 | 1};
  CHECK(std::equal(bytes.begin(), bytes.end(), f.data.begin()));
}

TEST_CASE("curb frames: a way without a curb says so, and is farther than any curb") {
  std::optional<CurbAhead> back = CurbAhead{};
  const Frame f = curb_ahead_frame(std::nullopt);
  CHECK(f.length == 8);
  CHECK((f.data[0] == 0xFF && f.data[1] == 0xFF && (f.data[7] & 3) == 0));
  REQUIRE(read_curb_ahead(f, back));
  CHECK_FALSE(back);
}

TEST_CASE("curb frames: every curb comes back to half a count") {
  std::mt19937 random(5);
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  for (int k = 0; k < 5000; ++k) {
    const CurbAhead in{
        uniform(0, 65), uniform(-32, 32), uniform(-1, 1), uniform(0, 0.25f), static_cast<CurbKind>(k % 3),
        uniform(0, 1)};
    const auto out = through(in);
    REQUIRE(out);
    REQUIRE(std::abs(out->distance_m - in.distance_m) <= 0.000505f);
    REQUIRE(std::abs(out->lateral_m - in.lateral_m) <= 0.000505f);
    REQUIRE(std::abs(out->height_m - in.height_m) <= 0.000505f);
    REQUIRE(std::abs(out->height_sd_m - in.height_sd_m) <= 0.000505f);
    REQUIRE(std::abs(out->probability - in.probability) <= 0.01001f);
    REQUIRE(out->kind == in.kind);
  }
}

TEST_CASE("curb frames: what is out of range is clamped, to the careful side") {
  const auto high = through({1e6f, 1e6f, 1e6f, 1e6f, CurbKind::step_down, 7.0f});
  REQUIRE(high);
  CHECK(high->distance_m == Approx(65.534));
  CHECK(high->lateral_m == Approx(32.767));
  CHECK(high->height_m == Approx(32.767));
  CHECK(high->height_sd_m == Approx(0.255));
  CHECK(high->probability == Approx(1.0));
  const auto low = through({-1e6f, -1e6f, -1e6f, -1.0f, CurbKind::crease, -7.0f});
  REQUIRE(low);
  CHECK(low->distance_m == 0.0f);
  CHECK(low->lateral_m == Approx(-32.767));
  CHECK(low->height_m == Approx(-32.767));
  CHECK(low->height_sd_m == 0.0f);
  CHECK(low->probability == 0.0f);
}

TEST_CASE("curb frames: a curb without a place is none, an unknown sd the largest, an unknown probability 0") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, infinity, -infinity}) {
    CHECK_FALSE(through({bad, 0, 0.1f, 0.01f, CurbKind::step_up, 1}));
    CHECK_FALSE(through({1, bad, 0.1f, 0.01f, CurbKind::step_up, 1}));
    CHECK_FALSE(through({1, 0, bad, 0.01f, CurbKind::step_up, 1}));
    CHECK(through({1, 0, 0.1f, bad, CurbKind::step_up, 1})->height_sd_m == Approx(0.255));
  }
  CHECK(through({1, 0, 0.1f, 0.01f, CurbKind::step_up, nan})->probability == 0.0f);
}

TEST_CASE("curb frames: the status comes back, its counter of 8 bits and at most 255 curbs") {
  for (const SourceState state : {SourceState::never, SourceState::ok, SourceState::stale}) {
    const Frame f = curb_status_frame({200, state, 300});
    CHECK(f.id == 0x6A1);
    CHECK(f.length == 3);
    CurbStatus back;
    REQUIRE(read_curb_status(f, back));
    CHECK(back.counter == 200);
    CHECK(back.tilt == state);
    CHECK(back.curbs == 255);
    CHECK_FALSE(back.resting);
  }
}

TEST_CASE("curb frames: a tilt that rests is told, unless the servo is silent, which is worse") {
  CurbStatus back;
  const Frame rests = curb_status_frame({200, SourceState::ok, 3, true});
  CHECK((rests.data[1] & 3) == 3);
  REQUIRE(read_curb_status(rests, back));
  CHECK(back.tilt == SourceState::ok);
  CHECK(back.resting);
  CHECK(back.counter == 200);
  CHECK(back.curbs == 3);
  for (const SourceState state : {SourceState::never, SourceState::stale}) {
    REQUIRE(read_curb_status(curb_status_frame({200, state, 3, true}), back));
    CHECK(back.tilt == state);
    CHECK_FALSE(back.resting);
  }
}

TEST_CASE("curb frames: other and short frames are not read") {
  std::optional<CurbAhead> curb;
  CurbStatus status;
  Frame ahead = curb_ahead_frame(CurbAhead{}), state = curb_status_frame({});
  CHECK_FALSE(read_curb_ahead(state, curb));
  CHECK_FALSE(read_curb_status(ahead, status));
  ahead.length = 7;
  CHECK_FALSE(read_curb_ahead(ahead, curb));
  state.length = 2;
  CHECK_FALSE(read_curb_status(state, status));
}

TEST_CASE("curb frames: a servo that sends their ids is told") {
  for (int node = 0; node < 64; ++node) {
    CHECK(shares_ids(odrive_encoder_estimates(static_cast<std::uint8_t>(node))) == (node == 53));
  }
  Signal on_29_bits = odrive_encoder_estimates(53);
  on_29_bits.extended = true;
  CHECK_FALSE(shares_ids(on_29_bits));
  CHECK_FALSE(shares_ids(vesc_status_4(0xA0)));
  CHECK(shares_ids(Signal{.id = 0x0A0, .id_mask = 0x1FF}));
  CHECK_FALSE(shares_ids(cia402_position(1), default_sync_id));
  CHECK(shares_ids(cia402_position(1), std::uint16_t{0x6A1}));
}

TEST_CASE("curb frames: fields do not share a bit and are valid signals") {
  std::array<std::array<int, 64>, 2> used{};
  for (const CurbField& field : curb_fields()) {
    INFO(field.name);
    CHECK(valid(field.signal));
    auto& bits = used[field.signal.id == curb_ahead_id ? 0 : 1];
    for (int b = 0; b < field.signal.length; ++b)
      CHECK(++bits[static_cast<std::size_t>(field.signal.start_bit + b)] == 1);
  }
}
