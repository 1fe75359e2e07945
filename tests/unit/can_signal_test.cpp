// Signals of servos: known frames to known angles, and round trips over every layout.
#include "can/signal.hpp"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <random>

using namespace curbline::can;

namespace {

constexpr double pi = std::numbers::pi;

Frame frame(std::uint32_t id, bool extended, std::initializer_list<std::uint8_t> bytes) {
  Frame f;
  f.id = id;
  f.extended = extended;
  for (const std::uint8_t byte : bytes) f.data[f.length++] = byte;
  return f;
}

}  // namespace

TEST_CASE("can signal: a CiA 402 position is read behind the statusword") {
  // 0xFFFD17CC counts of 2^20 a turn.
  const auto angle = decode(cia402_position(1), frame(0x181, false, {0x37, 0x06, 0xCC, 0x17, 0xFD, 0xFF}));
  REQUIRE(angle);
  CHECK(*angle == Approx(-190516.0 * 2.0 * pi / 1048576.0).epsilon(1e-15));
}

TEST_CASE("can signal: an ODrive position is a float of turns") {
  const auto angle = decode(odrive_encoder_estimates(3), frame(0x69, false, {0, 0, 0x80, 0xBE, 1, 2, 3, 4}));
  REQUIRE(angle);
  CHECK(*angle == Approx(-pi / 2).epsilon(1e-15));
}

TEST_CASE("can signal: a VESC position is the last two bytes, big-endian fiftieths of a degree") {
  const auto angle = decode(vesc_status_4(10), frame(0x100A, true, {0, 0, 0, 0, 0, 0, 0xEE, 0x6C}));  // -4500
  REQUIRE(angle);
  CHECK(*angle == Approx(-pi / 2).epsilon(1e-15));
}

TEST_CASE("can signal: a CubeMars position matches on the low byte of the id alone") {
  const Signal signal = cubemars_servo(0x68);
  const auto angle = decode(signal, frame(0x2968, true, {0x03, 0x84, 0, 0, 0, 0, 0, 0}));  // 900
  REQUIRE(angle);
  CHECK(*angle == Approx(pi / 2).epsilon(1e-15));
  CHECK_FALSE(decode(signal, frame(0x2969, true, {0x03, 0x84, 0, 0, 0, 0, 0, 0})));
}

TEST_CASE("can signal: a RobStride position matches on type and motor, whatever its mode and faults") {
  const Signal signal = robstride_feedback(0x7F);
  CHECK(*decode(signal, frame(0x02807F00, true, {0xFF, 0xFF, 0, 0, 0, 0, 0, 0})) == Approx(4 * pi).epsilon(1e-14));
  CHECK(*decode(signal, frame(0x02BF7FFD, true, {0, 0, 0, 0, 0, 0, 0, 0})) == Approx(-4 * pi).epsilon(1e-15));
  CHECK_FALSE(decode(signal, frame(0x02807E00, true, {0, 0, 0, 0, 0, 0, 0, 0})));
  CHECK_FALSE(decode(signal, frame(0x03807F00, true, {0, 0, 0, 0, 0, 0, 0, 0})));
}

TEST_CASE("can signal: a mini-cheetah position spans P_MIN to P_MAX behind the motor's number") {
  const Signal signal = mini_cheetah_reply(0, 12.5);
  CHECK(*decode(signal, frame(0, false, {1, 0, 0, 0, 0, 0})) == -12.5);
  CHECK(*decode(signal, frame(0, false, {1, 0xFF, 0xFF, 0, 0, 0})) == Approx(12.5).epsilon(1e-14));
  CHECK(std::abs(*decode(signal, frame(0, false, {1, 0x80, 0, 0, 0, 0}))) < 25.0 / 65535);
}

TEST_CASE("can signal: every preset is valid and gives back what was written, to half a count") {
  for (const Signal& signal : {cia402_position(127), odrive_encoder_estimates(63), vesc_status_4(255),
                               cubemars_servo(1), robstride_feedback(127), mini_cheetah_reply(0x7FF, 95.5)}) {
    REQUIRE(valid(signal));
    for (const double angle : {0.0, 0.7, -1.1345, 3.0}) {
      Frame f;
      encode(signal, angle, f);
      const auto back = decode(signal, f);
      REQUIRE(back);
      const double half_count = signal.is_float ? 3.0 * 1.2e-7 : std::abs(signal.scale) / 2;
      CHECK(std::abs(*back - angle) <= half_count * (1 + 1e-9));
    }
  }
}

TEST_CASE("can signal: other frames give nothing") {
  const Signal signal = cia402_position(1);
  Frame f = frame(0x181, false, {0, 0, 1, 0, 0, 0});
  REQUIRE(decode(signal, f));
  SECTION("another id") {
    f.id = 0x182;
  }
  SECTION("an extended frame of the same id") {
    f.extended = true;
  }
  SECTION("a remote request") {
    f.remote = true;
  }
  SECTION("an error message") {
    f.error = true;
  }
  SECTION("a frame one byte too short") {
    f.length = 5;
  }
  CHECK_FALSE(decode(signal, f));
}

TEST_CASE("can signal: a float that is not finite gives nothing") {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Frame f = frame(0x69, false, {0, 0, 0, 0, 0, 0, 0, 0});
    const auto bits = std::bit_cast<std::uint32_t>(bad);
    for (std::size_t i = 0; i < 4; ++i) f.data[i] = static_cast<std::uint8_t>(bits >> (8 * i));
    CHECK_FALSE(decode(odrive_encoder_estimates(3), f));
  }
}

TEST_CASE("can signal: bits are numbered as in a DBC file") {
  // The same twelve bits, 0xABC, across the bytes 1 and 2.
  const Signal little{.id = 1, .start_bit = 12, .length = 12, .is_signed = false};
  const Signal big{.id = 1, .start_bit = 11, .length = 12, .order = ByteOrder::big, .is_signed = false};
  CHECK(*decode(little, frame(1, false, {0, 0xC0, 0xAB})) == 0xABC);
  CHECK(*decode(big, frame(1, false, {0, 0x0A, 0xBC})) == 0xABC);
  CHECK_FALSE(decode(big, frame(1, false, {0, 0x0A})));
}

TEST_CASE("can signal: any place, length, order and sign round-trips, and other bits stay") {
  std::mt19937 random(1);
  for (int trial = 0; trial < 20000; ++trial) {
    Signal signal{.id = static_cast<std::uint32_t>(random() % 0x800)};
    signal.length = static_cast<std::uint8_t>(1 + random() % 64);
    signal.start_bit = static_cast<std::uint8_t>(random() % 256);
    signal.order = random() % 2 != 0 ? ByteOrder::big : ByteOrder::little;
    signal.is_signed = random() % 2 != 0;
    REQUIRE(valid(signal));
    const int bits = std::min<int>(signal.length, 52);  // what a double holds
    const double span = std::ldexp(1.0, signal.is_signed ? bits - 1 : bits);
    const double value = std::floor(std::ldexp(static_cast<double>(random()), -32) * span) -
                         (signal.is_signed && random() % 2 ? span : 0.0);
    Frame f;
    for (auto& byte : f.data) byte = static_cast<std::uint8_t>(random());
    Frame again = f;
    encode(signal, value, f);
    REQUIRE(decode(signal, f) == value);
    CHECK(fd_length(f.length) == f.length);
    int changed = 0;
    for (std::size_t i = 0; i < f.data.size(); ++i) {
      changed += std::popcount(static_cast<unsigned>(f.data[i] ^ again.data[i]));
    }
    REQUIRE(changed <= signal.length);
    encode(signal, value, again);
    REQUIRE(again.data == f.data);
  }
}

TEST_CASE("can signal: what does not fit is clamped and rounded to the nearest count") {
  const Signal byte{.id = 1, .length = 8, .scale = 0.5, .offset = 10.0};
  const auto through = [&](double value) {
    Frame f;
    encode(byte, value, f);
    return *decode(byte, f);
  };
  CHECK(through(1e9) == 10.0 + 127 * 0.5);
  CHECK(through(-1e9) == 10.0 - 128 * 0.5);
  CHECK(through(std::numeric_limits<double>::quiet_NaN()) == 10.0 - 128 * 0.5);
  CHECK(through(10.24) == 10.0);
  CHECK(through(10.26) == 10.5);
  CHECK(through(9.74) == 9.5);
  const Signal widest{.id = 1, .length = 64, .is_signed = false};
  Frame f;
  encode(widest, 1e30, f);
  CHECK(*decode(widest, f) == 0x1p64);
}

TEST_CASE("can signal: a description that cannot be is not valid") {
  const Signal good = cia402_position(1);
  REQUIRE(valid(good));
  Signal bad = good;
  SECTION("no bits") {
    bad.length = 0;
  }
  SECTION("65 bits") {
    bad.length = 65;
  }
  SECTION("a float of 16 bits") {
    bad.is_float = true;
    bad.length = 16;
  }
  SECTION("12 bits of id in a standard frame") {
    bad.id = 0x800;
  }
  SECTION("30 bits of id") {
    bad.extended = true;
    bad.id = 0x20000000;
  }
  SECTION("no scale") {
    bad.scale = 0.0;
  }
  SECTION("a scale that is not finite") {
    bad.scale = std::numeric_limits<double>::infinity();
  }
  SECTION("an offset that is not finite") {
    bad.offset = std::numeric_limits<double>::quiet_NaN();
  }
  CHECK_FALSE(valid(bad));
  CHECK_FALSE(valid(odrive_encoder_estimates(64)));
}

TEST_CASE("can frame: lengths of CAN FD are those of the standard") {
  CHECK(fd_length(0) == 0);
  CHECK(fd_length(8) == 8);
  CHECK(fd_length(9) == 12);
  CHECK(fd_length(33) == 48);
  CHECK(fd_length(64) == 64);
}
