// Signals of servos: known frames to known angles, and round trips over all layouts.
#include "curbline/can/signal.hpp"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "support/can_frame.hpp"

using namespace curbline::can;
using curbline::test::frame;

namespace {

/// Four bytes after a statusword.
constexpr Signal position{.id = 0x181, .start_bit = 16, .scale = 1e-3};
constexpr Signal turns{.id = 0x69, .is_float = true};

}  // namespace

TEST_CASE("can signal: other frames give nothing") {
  const Signal signal = position;
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
    CHECK_FALSE(decode(turns, f));
  }
}

TEST_CASE("can signal: bits are numbered as in a DBC file") {
  // The same twelve bits, 0xABC, across bytes 1 and 2.
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
    signal.start_bit = static_cast<std::uint16_t>(random() % 440);  // 64 more bits fit in any order
    signal.order = random() % 2 != 0 ? ByteOrder::big : ByteOrder::little;
    signal.is_signed = random() % 2 != 0;
    REQUIRE(valid(signal));
    const int bits = std::min<int>(signal.length, 52);  // the bits that a double holds
    const double span = std::ldexp(1.0, signal.is_signed ? bits - 1 : bits);
    const double value = std::floor(std::ldexp(static_cast<double>(random()), -32) * span) -
                         (signal.is_signed && random() % 2 ? span : 0.0);
    Frame f;
    for (auto& byte : f.data) byte = static_cast<std::uint8_t>(random());
    Frame again = f;
    encode(signal, value, f);
    REQUIRE(decode(signal, f) == value);
    CHECK(fd_length(f.length) == f.length);
    CHECK(f.fd == (f.length > 8));
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
  CHECK(through(9.75) == 9.5);
  const Signal widest{.id = 1, .length = 64, .is_signed = false};
  Frame f;
  encode(widest, 1e30, f);
  CHECK(*decode(widest, f) == 0x1p64);
}

TEST_CASE("can signal: a float is clamped to the numbers that a float has") {
  const Signal number{.id = 1, .is_float = true, .scale = 0.5};
  constexpr double most = 0.5 * double{std::numeric_limits<float>::max()};
  const auto through = [&](double value) {
    Frame f;
    encode(number, value, f);
    return decode(number, f);
  };
  CHECK(through(1e300) == most);
  CHECK(through(-1e300) == -most);
  CHECK(through(std::numeric_limits<double>::infinity()) == most);
  CHECK(through(std::numeric_limits<double>::quiet_NaN()) == -most);
  CHECK(through(-0.25) == -0.25);
}

TEST_CASE("can signal: a description that cannot be is not valid") {
  const Signal good = position;
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
  SECTION("bits beyond the 64th byte") {
    bad.start_bit = 481;
  }
  SECTION("big-endian bits beyond the 64th byte") {
    bad.order = ByteOrder::big;
    bad.start_bit = 487;  // 32 bits from the first of byte 60
    REQUIRE(valid(bad));
    bad.start_bit = 486;
  }
  SECTION("in frames of 9 bytes, which CAN FD does not have") {
    bad.start_bit = 40;
    bad.max_bytes = 12;
    REQUIRE(valid(bad));
    bad.max_bytes = 9;
  }
  SECTION("a multiplexor of no bits") {
    bad.multiplexor = Multiplexor{.length = 0};
  }
  SECTION("a multiplexor that never has its value") {
    bad.multiplexor = Multiplexor{.length = 4, .value = 16};
  }
  CHECK_FALSE(valid(bad));
}

TEST_CASE("can signal: a multiplexed signal is there only while the multiplexor has its value") {
  Signal signal{.id = 1, .start_bit = 8, .length = 8, .is_signed = false};
  signal.multiplexor = Multiplexor{.start_bit = 4, .length = 4, .value = 3};
  CHECK(decode(signal, frame(1, false, {0x3F, 42})) == 42.0);
  CHECK(carries(signal, frame(1, false, {0x3F, 42})));
  CHECK_FALSE(decode(signal, frame(1, false, {0x2F, 42})));
  CHECK_FALSE(carries(signal, frame(1, false, {0x2F, 42})));
}

TEST_CASE("can signal: a frame cut before its signal or its multiplexor is one of the signal's, and damaged") {
  Signal signal{.id = 1, .start_bit = 8, .length = 8};
  signal.multiplexor = Multiplexor{.start_bit = 23, .length = 8, .order = ByteOrder::big, .value = 3};
  CHECK(bytes_needed(signal) == 3);
  CHECK(decode(signal, frame(1, false, {0, 7, 3})) == 7.0);
  for (const Frame& cut : {frame(1, false, {0, 7}), frame(1, false, {0}), frame(1, false, {})}) {
    CHECK(carries(signal, cut));
    CHECK_FALSE(decode(signal, cut));
  }
}

TEST_CASE("can signal: a frame longer than the signal's is another one, a shorter one damaged") {
  Signal signal{.id = 0x181, .length = 16};
  signal.min_bytes = 6;
  signal.max_bytes = 7;
  REQUIRE(valid(signal));
  CHECK(bytes_needed(signal) == 6);
  Frame frame;
  frame.id = 0x181;
  for (frame.length = 0; frame.length <= 8; ++frame.length) {
    CHECK(carries(signal, frame) == (frame.length <= 7));
    CHECK(decode(signal, frame).has_value() == (frame.length == 6 || frame.length == 7));
  }
  Frame written;
  encode(signal, 1.0, written);
  CHECK(written.length == 6);
  signal.max_bytes = 64;
  signal.min_bytes = 65;  // longer than any frame
  CHECK_FALSE(valid(signal));
  signal.min_bytes = 6;
  signal.max_bytes = 5;
  CHECK_FALSE(valid(signal));
}

TEST_CASE("can signal: writing a multiplexed signal sets the multiplexor") {
  Signal signal{.id = 1, .start_bit = 8, .length = 8};
  signal.multiplexor = Multiplexor{.start_bit = 31, .length = 12, .order = ByteOrder::big, .value = 0xABC};
  Frame f;
  encode(signal, -5.0, f);
  CHECK(f.length == 5);
  CHECK(f.data[3] == 0xAB);
  CHECK(f.data[4] == 0xC0);
  CHECK(decode(signal, f) == -5.0);
}

TEST_CASE("can frame: lengths of CAN FD are those of the standard") {
  CHECK(fd_length(0) == 0);
  CHECK(fd_length(8) == 8);
  CHECK(fd_length(9) == 12);
  CHECK(fd_length(33) == 48);
  CHECK(fd_length(64) == 64);
}

TEST_CASE("can frame: its id has 11 bits or 29, its length is one of its kind") {
  CHECK(valid(Frame{.id = 0x7FF, .length = 8}));
  CHECK_FALSE(valid(Frame{.id = 0x800, .length = 8}));
  CHECK(valid(Frame{.id = 0x1FFFFFFF, .extended = true}));
  CHECK_FALSE(valid(Frame{.id = 0x20000000, .extended = true}));
  CHECK(valid(Frame{.id = 0x800, .error = true, .length = 8}));  // a class of errors
  CHECK_FALSE(valid(Frame{.length = 9}));
  CHECK(valid(Frame{.remote = true, .length = 8}));
  CHECK_FALSE(valid(Frame{.remote = true, .fd = true}));
  CHECK(valid(Frame{.fd = true, .length = 12}));
  CHECK_FALSE(valid(Frame{.fd = true, .length = 13}));
  CHECK_FALSE(valid(Frame{.fd = true, .length = 65}));
}
