// A number inside a CAN frame: what a servo reports its angle as. Pure bytes to numbers and back: no I/O, no state, no
// heap, no libm, the same bits on every platform. The first step on the way: frame -> angle -> tilt track.
//
// A Signal bears the words of a DBC file, so that a servo that is not among the presets below is described, not coded:
//   SG_ position : 16|32@1- (5.99e-06,0) "rad"  ->  {.start_bit = 16, .length = 32, .scale = 5.99e-06}
#pragma once

#include <cstdint>
#include <optional>

#include "can/frame.hpp"

namespace curbline::can {

enum class ByteOrder : std::uint8_t { little, big };  ///< DBC @1 (Intel), @0 (Motorola)

/// Where the number lies and what it means: value = raw * scale + offset. Words and bit numbering as in a DBC file:
/// start_bit is the least significant bit for little endian, the most significant for big endian (sawtooth numbering:
/// bit 7 is the first bit sent of byte 0, bit 15 that of byte 1).
struct Signal {
  std::uint32_t id = 0;
  std::uint32_t id_mask = 0x1FFFFFFFu;  ///< bits of the id that must agree
  bool extended = false;
  std::uint8_t start_bit = 0;
  std::uint8_t length = 32;  ///< bits, 1 to 64 (32 if is_float)
  ByteOrder order = ByteOrder::little;
  bool is_signed = true;
  bool is_float = false;  ///< IEEE 754 binary32
  double scale = 1.0;     ///< radians a count for a tilt signal; below 0 if the servo turns the other way
  double offset = 0.0;
};

/// True if the length is possible, the id fits 11 or 29 bits, and scale and offset are finite, scale not 0. Any
/// start_bit is: it reaches the first 32 bytes of a frame. decode() and encode() want a valid signal: ask once, when it
/// comes in.
bool valid(const Signal& signal);

/// The value, or nothing if the frame is another one (id, extended, remote, error), too short, or the value not finite.
/// No state: may be called from an interrupt. A step a bit, 64 at most.
std::optional<double> decode(const Signal& signal, const Frame& frame);

/// Writes the value into the frame (id, length and bits; other bits stay, a longer frame keeps its length), rounded to
/// the nearest count, halves away from 0, and clamped to the field's range; NaN becomes the lowest count. A signal
/// beyond byte 8 makes the frame CAN FD. Bits of the id outside id_mask become those of signal.id. What simulators use.
void encode(const Signal& signal, double value, Frame& frame);

// The servos' position feedback, in radians. Sources in signal.cpp. Counts a turn, P_MAX and the sense of rotation
// depend on how the servo was set up: change scale and offset of what these give.
Signal cia402_position(std::uint8_t node);  ///< TPDO1 0x180 + node: statusword u16, position i32 of 2^20 counts a turn
Signal odrive_encoder_estimates(std::uint8_t node);  ///< node 0 to 63; position float32, turns
Signal vesc_status_4(std::uint8_t node);             ///< PID position i16, 1/50 degree
Signal cubemars_servo(std::uint8_t node);            ///< AK series in servo mode; i16, 0.1 degree
Signal robstride_feedback(std::uint8_t motor);       ///< RobStride, CyberGear type 2; u16 over +-4 pi
/// MIT mini-cheetah and its clones; u16 over +-p_max_rad. The reply's first byte names the motor and is not looked at:
/// give each motor a reply id of its own.
Signal mini_cheetah_reply(std::uint16_t id, double p_max_rad);

}  // namespace curbline::can
