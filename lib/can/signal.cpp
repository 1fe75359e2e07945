#include "can/signal.hpp"

#include <bit>
#include <cmath>
#include <numbers>

namespace curbline::can {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// The bit below in significance, in the numbering of Signal::start_bit.
constexpr int next_lower(ByteOrder order, int bit) {
  if (order == ByteOrder::little) return bit - 1;
  return bit % 8 == 0 ? bit + 15 : bit - 1;
}

constexpr int most_significant(const Signal& s) {
  return s.order == ByteOrder::little ? s.start_bit + s.length - 1 : s.start_bit;
}

/// Bytes that a frame must have.
constexpr int bytes_needed(const Signal& s) {
  if (s.order == ByteOrder::little) return most_significant(s) / 8 + 1;
  const int before_start = s.start_bit / 8 * 8 + (7 - s.start_bit % 8);  // bits sent before the first of the signal
  return (before_start + s.length - 1) / 8 + 1;
}

std::uint64_t read_bits(const Signal& s, const Frame& frame) {
  std::uint64_t raw = 0;
  int bit = most_significant(s);
  for (int i = 0; i < s.length; ++i, bit = next_lower(s.order, bit)) {
    const unsigned byte = frame.data[static_cast<std::size_t>(bit / 8)];
    raw = raw << 1 | (byte >> (bit % 8) & 1u);
  }
  return raw;
}

void write_bits(const Signal& s, std::uint64_t raw, Frame& frame) {
  int bit = most_significant(s);
  for (int i = s.length - 1; i >= 0; --i, bit = next_lower(s.order, bit)) {
    std::uint8_t& byte = frame.data[static_cast<std::size_t>(bit / 8)];
    const unsigned mask = 1u << (bit % 8);
    byte = static_cast<std::uint8_t>((raw >> i & 1u) != 0 ? byte | mask : byte & ~mask);
  }
}

double raw_to_number(const Signal& s, std::uint64_t raw) {
  if (s.is_float) return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
  if (!s.is_signed) return static_cast<double>(raw);
  const int unused = 64 - s.length;
  return static_cast<double>(static_cast<std::int64_t>(raw << unused) >> unused);  // C++20: >> keeps the sign
}

/// Nearest integer, halves away from 0. |x| < 2^63 or 0 <= x < 2^64 by the type.
template <typename Integer>
Integer round_to(double x) {
  const auto whole = static_cast<Integer>(x);
  const double rest = x - static_cast<double>(whole);
  if (rest >= 0.5) return whole + 1;
  if (rest <= -0.5) return whole - 1;
  return whole;
}

/// 2^n without libm.
constexpr double power_of_2(int n) {
  return n == 64 ? 0x1p64 : static_cast<double>(std::uint64_t{1} << n);
}

std::uint64_t number_to_raw(const Signal& s, double count) {
  if (s.is_float) return std::bit_cast<std::uint32_t>(static_cast<float>(count));
  const int magnitude_bits = s.is_signed ? s.length - 1 : s.length;
  const std::uint64_t all_ones = ~std::uint64_t{0} >> (64 - s.length);
  const std::uint64_t highest = s.is_signed ? all_ones >> 1 : all_ones;
  const std::uint64_t lowest = s.is_signed ? highest + 1 : 0;  // two's complement
  const double end = power_of_2(magnitude_bits);
  if (!(count > (s.is_signed ? -end : 0.0))) return lowest;
  if (count >= end - 0.5) return highest;
  return s.is_signed ? static_cast<std::uint64_t>(round_to<std::int64_t>(count)) : round_to<std::uint64_t>(count);
}

}  // namespace

bool valid(const Signal& s) {
  if (s.length < 1 || s.length > 64 || (s.is_float && s.length != 32)) return false;
  if (s.id > (s.extended ? 0x1FFFFFFFu : 0x7FFu)) return false;
  return std::isfinite(s.scale) && s.scale != 0.0 && std::isfinite(s.offset);
}

std::optional<double> decode(const Signal& signal, const Frame& frame) {
  if (frame.extended != signal.extended || frame.remote || frame.error) return std::nullopt;
  if (((frame.id ^ signal.id) & signal.id_mask) != 0) return std::nullopt;
  if (frame.length < bytes_needed(signal)) return std::nullopt;
  const double value = raw_to_number(signal, read_bits(signal, frame)) * signal.scale + signal.offset;
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

void encode(const Signal& signal, double value, Frame& frame) {
  frame.id = signal.id;
  frame.extended = signal.extended;
  frame.remote = frame.error = false;
  const auto needed = static_cast<std::uint8_t>(bytes_needed(signal));
  if (needed > 8) frame.fd = true;
  if (needed > frame.length) frame.length = fd_length(needed);
  write_bits(signal, number_to_raw(signal, (value - signal.offset) / signal.scale), frame);
}

// CANopen CiA 402: statusword 0x6041 (u16), then position actual value 0x6064 (i32), a common mapping of the first
// transmit PDO. Counts a turn are the encoder's; 2^20 is that of a 20-bit absolute encoder.
Signal cia402_position(std::uint8_t node) {
  return {.id = 0x180u + node, .start_bit = 16, .scale = 2.0 * std::numbers::pi / 1048576.0};
}

// ODrive documentation, CAN protocol: Get_Encoder_Estimates, command 0x09; bytes 0-3 position in turns.
Signal odrive_encoder_estimates(std::uint8_t node) {
  return {.id = (static_cast<std::uint32_t>(node) << 5) | 0x09u, .is_float = true, .scale = 2.0 * std::numbers::pi};
}

// VESC documentation, comm_can: CAN_PACKET_STATUS_4 = 16; bytes 6-7 position in degrees x 50.
Signal vesc_status_4(std::uint8_t node) {
  return {.id = (16u << 8) | node,
          .extended = true,
          .start_bit = 55,
          .length = 16,
          .order = ByteOrder::big,
          .scale = degree / 50.0};
}

// CubeMars AK series manual, servo mode upload: bytes 0-1 position in 0.1 degree; what stands above the low byte of the
// id differs between firmware versions.
Signal cubemars_servo(std::uint8_t node) {
  return {.id = node,
          .id_mask = 0xFFu,
          .extended = true,
          .start_bit = 7,
          .length = 16,
          .order = ByteOrder::big,
          .scale = degree / 10.0};
}

// RobStride and CyberGear manuals, communication type 2: id bits 28-24 type, 15-8 motor, the rest mode and faults.
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

// Mini-cheetah motor controller, CAN_com: pack_reply(), bytes 1-2; P_MAX is 12.5 or 95.5 rad by firmware.
Signal mini_cheetah_reply(std::uint16_t id, double p_max_rad) {
  return {.id = id,
          .start_bit = 15,
          .length = 16,
          .order = ByteOrder::big,
          .is_signed = false,
          .scale = 2.0 * p_max_rad / 65535.0,
          .offset = -p_max_rad};
}

}  // namespace curbline::can
