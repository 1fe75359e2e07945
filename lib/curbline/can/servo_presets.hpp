// The servos' position feedback as signals, in radians: what a robot file names by `servo = "..."`. Each was read from
// the maker's manual or firmware, named at its function in servo_presets.cpp; tests/unit/can_servo_presets_test.cpp
// holds frames to each. Constant data, no state: may be called from anywhere.
//
// Counts a turn, P_MAX and the sense of rotation depend on the servo's configuration: adapt scale and offset of the
// result. Tilt above 0 looks down.
#pragma once

#include <cstdint>

#include "curbline/can/signal.hpp"

namespace curbline::can {

/// TPDO1 of a CANopen drive, id 0x180 + node (1 to 127): statusword u16, position i32 of 2^20 counts a turn. For TPDO2
/// the id is 0x280 + node. A drive that sends it on SYNC wants a TiltDecoder with the SYNC's id.
Signal cia402_position(std::uint8_t node);

/// ODrive CANSimple, node 0 to 63: position float32, turns. With extended ids it is the same of 29 bits: set
/// `extended`.
Signal odrive_encoder_estimates(std::uint8_t node);

/// VESC STATUS_4: PID position i16, 1/50 degree. The rate of the message is 50 Hz unless it is set otherwise.
Signal vesc_status_4(std::uint8_t node);

/// CubeMars (T-Motor) AK series in servo mode, id 0x2900 + node of 29 bits: i16, 0.1 degree, +-3200 degrees. Firmware
/// that puts something else above the node's byte wants another id; an id_mask of 0xFF would take the host's commands
/// to the motor for positions.
Signal cubemars_servo(std::uint8_t node);

/// RobStride, CyberGear type 2: u16 over +-4 pi.
Signal robstride_feedback(std::uint8_t motor);

/// MIT mini-cheetah and its clones, AK series in MIT mode: u16 over +-p_max_rad, in a reply of 6 bytes. The host's
/// commands may have the same id and have 8 bytes: they are passed over. The reply's first byte names the motor: where
/// several share a reply id, add the multiplexor {.start_bit = 0, .length = 8, .value = motor}. Clones that reply with
/// 8 bytes want max_bytes = 8, that multiplexor, and a reply id that is not the commands'.
Signal mini_cheetah_reply(std::uint16_t id, double p_max_rad);

}  // namespace curbline::can
