#include "curbline/can/servo_presets.hpp"

#include <numbers>

namespace curbline::can {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

}  // namespace

// CANopen CiA 402: statusword 0x6041 (u16), then position actual value 0x6064 (i32), a common mapping of a transmit
// PDO: Faulhaber Motion Control 3.0 CANopen manual 7000.05050 has it as TPDO2; Maxon EPOS takes it by mapping. Counts a
// turn are the encoder's; 2^20 is that of a 20-bit absolute encoder.
Signal cia402_position(std::uint8_t node) {
  return {.id = 0x180u + node, .start_bit = 16, .scale = 2.0 * std::numbers::pi / 1048576.0};
}

// ODrive documentation, CAN protocol: id = node << 5 | command, command 0x09 Get_Encoder_Estimates; all values little
// endian, bytes 0-3 position in turns. A request for it is a remote frame of the same id.
Signal odrive_encoder_estimates(std::uint8_t node) {
  return {.id = (static_cast<std::uint32_t>(node) << 5) | 0x09u, .is_float = true, .scale = 2.0 * std::numbers::pi};
}

// VESC documentation, comm_can: id = command << 8 | node, CAN_PACKET_STATUS_4 = 16; bytes 6-7 PID position, degrees
// x 50.
Signal vesc_status_4(std::uint8_t node) {
  return {.id = (16u << 8) | node,
          .extended = true,
          .start_bit = 55,
          .length = 16,
          .order = ByteOrder::big,
          .scale = degree / 50.0};
}

// CubeMars AK Series Actuator Driver Manual, servo mode, 5.1 and 5.2: status 0x29 << 8 | motor, 8 bytes, bytes 0-1
// position, -32000 to 32000 for -3200 to 3200 degrees. The host's commands are mode << 8 | motor, modes 0 to 6, the
// last of 8 bytes too: so the whole id must agree.
Signal cubemars_servo(std::uint8_t node) {
  return {.id = (0x29u << 8) | node,
          .extended = true,
          .start_bit = 7,
          .length = 16,
          .order = ByteOrder::big,
          .scale = degree / 10.0,
          .min_bytes = 8};
}

// CyberGear instruction manual, 4.1.3, and RobStride manuals: communication type 2; id bits 28-24 type, 23-22 mode,
// 21-16 faults, 15-8 motor, 7-0 host. (The manual's sample code has +-12.5 rad for commands; its tables say +-4 pi.)
Signal robstride_feedback(std::uint8_t motor) {
  return {.id = (2u << 24) | (static_cast<std::uint32_t>(motor) << 8),
          .id_mask = 0x1F00FF00u,
          .extended = true,
          .start_bit = 7,
          .length = 16,
          .order = ByteOrder::big,
          .is_signed = false,
          .scale = 8.0 * std::numbers::pi / 65535.0,
          .offset = -4.0 * std::numbers::pi};
}

// Mini-cheetah motor controller, CAN_com: pack_reply(), byte 0 the motor, bytes 1-2 the position; P_MAX is 12.5 or 95.5
// rad by firmware; 6 bytes, while a command has 8. CubeMars manual, 5.3: the same reply, under the motor's own id.
Signal mini_cheetah_reply(std::uint16_t id, double p_max_rad) {
  return {.id = id,
          .start_bit = 15,
          .length = 16,
          .order = ByteOrder::big,
          .is_signed = false,
          .scale = 2.0 * p_max_rad / 65535.0,
          .offset = -p_max_rad,
          .min_bytes = 6,
          .max_bytes = 6};
}

}  // namespace curbline::can
