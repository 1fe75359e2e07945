// The servo presets against frames from manuals and from real buses.
#include "curbline/can/servo_presets.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/can_frame.hpp"

using namespace curbline::can;
using curbline::test::frame;

namespace {

constexpr double pi = std::numbers::pi, degree = pi / 180;

}  // namespace

TEST_CASE("servo presets: a CiA 402 position is read behind the statusword") {
  // 0xFFFD17CC counts of 2^20 a turn, statusword 0x0637: operation enabled.
  const auto angle = decode(cia402_position(1), frame(0x181, false, {0x37, 0x06, 0xCC, 0x17, 0xFD, 0xFF}));
  REQUIRE(angle);
  CHECK(*angle == Approx(-190516.0 * 2.0 * pi / 1048576.0).epsilon(1e-15));
  // Whatever else is mapped after it.
  CHECK(decode(cia402_position(1), frame(0x181, false, {0x37, 0x06, 0xCC, 0x17, 0xFD, 0xFF, 8, 0})) == angle);
}

TEST_CASE("servo presets: TPDO2, where Faulhaber drives have the same layout, is another id") {
  Signal signal = cia402_position(5);
  signal.id = 0x285;
  CHECK(decode(signal, frame(0x285, false, {0x37, 0x06, 0x00, 0x00, 0x08, 0x00})) == Approx(pi).epsilon(1e-15));
}

TEST_CASE("servo presets: an ODrive's id is node << 5 | 9 and its position a float of turns") {
  CHECK(odrive_encoder_estimates(1).id == 0x29);  // in the manual's example, node 1 and command 0x0C give 0x2C
  const auto angle = decode(odrive_encoder_estimates(3), frame(0x69, false, {0, 0, 0x80, 0xBE, 1, 2, 3, 4}));
  REQUIRE(angle);
  CHECK(*angle == Approx(-pi / 2).epsilon(1e-15));
}

TEST_CASE("servo presets: an ODrive's position is not read from the request for it, of the same id") {
  Frame request = frame(0x69, false, {0, 0, 0, 0, 0, 0, 0, 0});
  request.remote = true;
  CHECK_FALSE(decode(odrive_encoder_estimates(3), request));
}

TEST_CASE("servo presets: a VESC position is the last two bytes, big-endian fiftieths of a degree") {
  // A user's log (vesc-project.com, node 3345): 25.3 degrees C, no motor sensor, 0 A, 190.04 degrees.
  const auto angle = decode(vesc_status_4(4), frame(0x1004, true, {0x00, 0xFD, 0xFE, 0x84, 0x00, 0x00, 0x25, 0x1E}));
  REQUIRE(angle);
  CHECK(*angle == Approx(190.04 * degree).epsilon(1e-15));
  CHECK(*decode(vesc_status_4(10), frame(0x100A, true, {0, 0, 0, 0, 0, 0, 0xEE, 0x6C})) == Approx(-pi / 2));
  CHECK_FALSE(decode(vesc_status_4(4), frame(0x0F04, true, {0, 0, 0, 0, 0, 0, 0, 0})));  // STATUS_3
}

TEST_CASE("servo presets: a CubeMars position spans -3200 to 3200 degrees") {
  const Signal signal = cubemars_servo(0x68);
  CHECK(*decode(signal, frame(0x2968, true, {0x7D, 0x00, 0, 0, 0, 0, 25, 0})) == Approx(3200 * degree));
  CHECK(*decode(signal, frame(0x2968, true, {0x83, 0x00, 0, 0, 0, 0, 25, 0})) == Approx(-3200 * degree));
}

TEST_CASE("servo presets: a CubeMars position is not read from the host's commands to the same motor") {
  const Signal signal = cubemars_servo(0x68);
  CHECK(carries(signal, frame(0x2968, true, {0x03, 0x84, 0, 0, 0, 0, 0, 0})));
  // Duty, current, brake, speed and position commands are four bytes, the origin is one, position with speed is eight.
  for (const std::uint32_t mode : {0u, 1u, 2u, 3u, 4u}) {
    CHECK_FALSE(carries(signal, frame(mode << 8 | 0x68, true, {0x00, 0x03, 0x84, 0x00})));
  }
  CHECK_FALSE(carries(signal, frame(0x568, true, {0x01})));
  CHECK_FALSE(carries(signal, frame(0x668, true, {0x00, 0x03, 0x84, 0x00, 0x03, 0xE8, 0x03, 0xE8})));
  CHECK_FALSE(carries(signal, frame(0x2969, true, {0x03, 0x84, 0, 0, 0, 0, 0, 0})));
}

TEST_CASE("servo presets: a CubeMars status that was cut is damaged, though its position is there") {
  const Frame cut = frame(0x2968, true, {0x03, 0x84, 0, 0, 0, 0, 25});
  CHECK(carries(cubemars_servo(0x68), cut));
  CHECK_FALSE(decode(cubemars_servo(0x68), cut));
}

TEST_CASE("servo presets: a RobStride position matches on type and motor, whatever its mode, faults and host") {
  const Signal signal = robstride_feedback(0x7F);
  CHECK(*decode(signal, frame(0x02807F00, true, {0xFF, 0xFF, 0, 0, 0, 0, 0, 0})) == Approx(4 * pi).epsilon(1e-14));
  CHECK(*decode(signal, frame(0x02BF7FFD, true, {0, 0, 0, 0, 0, 0, 0, 0})) == Approx(-4 * pi).epsilon(1e-15));
  CHECK_FALSE(decode(signal, frame(0x02807E00, true, {0, 0, 0, 0, 0, 0, 0, 0})));
  CHECK_FALSE(decode(signal, frame(0x03807F00, true, {0, 0, 0, 0, 0, 0, 0, 0})));
  CHECK_FALSE(decode(signal, frame(0x15807F00, true, {0, 0, 0, 0, 0, 0, 0, 0})));  // type 21, faults
}

TEST_CASE("servo presets: a mini-cheetah position spans P_MIN to P_MAX behind the motor's number") {
  const Signal signal = mini_cheetah_reply(0, 12.5);
  CHECK(*decode(signal, frame(0, false, {1, 0, 0, 0, 0, 0})) == -12.5);
  CHECK(*decode(signal, frame(0, false, {1, 0xFF, 0xFF, 0, 0, 0})) == Approx(12.5).epsilon(1e-14));
  CHECK(std::abs(*decode(signal, frame(0, false, {1, 0x80, 0, 0, 0, 0}))) < 25.0 / 65535);
}

TEST_CASE(
    "servo presets: a mini-cheetah position is not read from a command, which has eight bytes and may have its id") {
  const Signal signal = mini_cheetah_reply(1, 12.5);
  const Frame command = frame(1, false, {0x7F, 0xFF, 0x7F, 0xF0, 0x33, 0x33, 0x37, 0xFF});
  CHECK_FALSE(carries(signal, command));
  const Frame cut = frame(1, false, {1, 0x80, 0, 0, 0});
  CHECK(carries(signal, cut));
  CHECK_FALSE(decode(signal, cut));
  Signal clone = signal;  // its reply also has temperature and error; at best the motor's number identifies it
  clone.max_bytes = 8;
  CHECK(carries(clone, command));
}

TEST_CASE("servo presets: mini-cheetahs that share a reply id are told apart by a multiplexor") {
  Signal signal = mini_cheetah_reply(0, 12.5);
  signal.multiplexor = Multiplexor{.value = 2};
  CHECK(decode(signal, frame(0, false, {2, 0, 0, 0, 0, 0})) == -12.5);
  CHECK_FALSE(decode(signal, frame(0, false, {1, 0, 0, 0, 0, 0})));
}

TEST_CASE("servo presets: every preset is valid and gives back what was written, to half a count") {
  for (const Signal& signal : {cia402_position(127), odrive_encoder_estimates(63), vesc_status_4(255),
                               cubemars_servo(1), robstride_feedback(127), mini_cheetah_reply(0x7FF, 95.5)}) {
    REQUIRE(valid(signal));
    for (const double angle : {0.0, 0.7, -1.1345, 3.0}) {
      Frame f;
      encode(signal, angle, f);
      const auto back = decode(signal, f);
      REQUIRE(back);
      const double half_count =
          signal.is_float ? 3.0 * double{std::numeric_limits<float>::epsilon()} : std::abs(signal.scale) / 2;
      CHECK(std::abs(*back - angle) <= half_count * (1 + 1e-9));
    }
  }
}

TEST_CASE("servo presets: a node that an ODrive's standard id has no room for is not valid") {
  CHECK(valid(odrive_encoder_estimates(63)));
  CHECK_FALSE(valid(odrive_encoder_estimates(64)));
}
