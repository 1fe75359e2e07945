// The number in a CAN frame by which a servo reports its angle. Bytes to numbers and back: no I/O, no state, no
// heap, no libm, the same bits on every platform. The first step on the way: frame -> angle -> tilt track.
//
// A Signal has the terms of a DBC file, so that a servo that is not among the presets (servo_presets.hpp) needs a
// description, not code:
//   SG_ position : 16|32@1- (5.99e-06,0) "rad"  ->  {.start_bit = 16, .length = 32, .scale = 5.99e-06}
#pragma once

#include <cstdint>
#include <optional>

#include "curbline/can/frame.hpp"

namespace curbline::can {

enum class ByteOrder : std::uint8_t { little, big };  ///< DBC @1 (Intel), @0 (Motorola)

/// Several signals may use the same bits of a frame in turn; another number in it, the multiplexor, says which one is
/// present (DBC: `M` marks that number, `m3` a signal that is present while it is 3). Bits are numbered as in Signal.
struct Multiplexor {
  std::uint16_t start_bit = 0;
  std::uint8_t length = 8;  ///< bits, 1 to 64
  ByteOrder order = ByteOrder::little;
  std::uint64_t value = 0;  ///< raw, unsigned
};

/// Where the number lies and what it means: value = raw * scale + offset. Words and bit numbering as in a DBC file:
/// start_bit is the least significant bit for little endian, the most significant for big endian (sawtooth numbering:
/// bit 7 is the first bit sent of byte 0, bit 15 that of byte 1).
struct Signal {
  std::uint32_t id = 0;
  std::uint32_t id_mask = highest_id(true);  ///< bits of the id that must agree
  bool extended = false;
  std::uint16_t start_bit = 0;
  std::uint8_t length = 32;  ///< bits, 1 to 64 (32 if is_float)
  ByteOrder order = ByteOrder::little;
  bool is_signed = true;
  bool is_float = false;  ///< IEEE 754 binary32
  double scale = 1.0;     ///< radians a count for a tilt signal; below 0 if the servo turns the other way
  double offset = 0.0;
  std::optional<Multiplexor> multiplexor{};  ///< nothing: the signal is in every frame of its id
  std::uint8_t min_bytes = 0;   ///< a shorter frame is damaged, even where the bits are there; see bytes_needed()
  std::uint8_t max_bytes = 64;  ///< a longer frame of the id is another one: a command to the servo, say
};

/// True if the bits lie within a frame of 64 bytes, and of max_bytes, the id fits 11 or 29 bits, scale and offset are
/// finite, scale is not 0, and the multiplexor can have its value. The functions below need a valid signal: check it
/// once, when it comes in.
bool valid(const Signal& signal);

/// Least number of bytes of a frame with the signal, 1 to 64; above 8 a length of CAN FD.
int bytes_needed(const Signal& signal);

/// Whether the frame carries the signal: a data frame of its id, at most max_bytes long, whose multiplexor, if the
/// frame is long enough for it, has the signal's value. A frame for which this is true but decode() gives nothing is
/// damaged. May be called from an interrupt.
bool carries(const Signal& signal, const Frame& frame);

/// The value, or nothing if the frame is another one (see carries()), too short, or the value not finite. No state: may
/// be called from an interrupt. A step a bit, 128 at most.
std::optional<double> decode(const Signal& signal, const Frame& frame);

/// Writes the value into the frame (id, length, multiplexor and bits; other bits stay, a longer frame keeps its
/// length), rounded to the nearest count, halves away from 0, and clamped to the field's range; NaN becomes the lowest
/// count, of a float as of an integer. A signal beyond byte 8 makes the frame CAN FD. Bits of the id outside id_mask
/// become those of signal.id. For simulators.
void encode(const Signal& signal, double value, Frame& frame);

}  // namespace curbline::can
