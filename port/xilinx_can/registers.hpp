// Registers of the CAN controller in Zynq-7000 and Zynq UltraScale+, and their contents. Source: AMD, Zynq UltraScale+
// Device Register Reference (UG1087), module CAN; the ids' layout: Technical Reference Manual (UG1085), CAN controller.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/can/frame.hpp"

namespace curbline::xilinx_can {

enum class Register : std::uint32_t {
  software_reset = 0x00,
  mode = 0x04,
  prescaler = 0x08,
  bit_timing = 0x0C,
  error_status = 0x14,  ///< cleared by writing ones
  status = 0x18,
  interrupt_status = 0x1C,
  interrupt_enable = 0x20,
  interrupt_clear = 0x24,
  tx_id = 0x30,  ///< writing tx_data2 after the three before it queues a frame
  tx_length = 0x34,
  tx_data1 = 0x38,
  tx_data2 = 0x3C,
  rx_id = 0x50,  ///< reading all four removes a frame from the FIFO
  rx_length = 0x54,
  rx_data1 = 0x58,
  rx_data2 = 0x5C,
  filter_enable = 0x60,
  filter_mask1 = 0x64,  ///< mask and id of filter n at 8 (n - 1) from here
  filter_id1 = 0x68,
};

namespace bits {
constexpr std::uint32_t reset = 1u << 0, enable = 1u << 1;  // software_reset
constexpr std::uint32_t loopback = 1u << 1;                 // mode
// status
constexpr std::uint32_t in_configuration = 1u << 0, in_loopback = 1u << 1, in_normal = 1u << 3, error_warning = 1u << 6,
                        tx_full = 1u << 10, filters_busy = 1u << 11;
constexpr std::uint32_t error_state = 3u << 7, bus_off = 2u << 7, error_passive = 3u << 7;
// interrupt_status, interrupt_clear
constexpr std::uint32_t overflow = 1u << 6, not_empty = 1u << 7, error = 1u << 8, went_bus_off = 1u << 9, all = 0x7FFF;
// ids, masks
constexpr std::uint32_t substitute_remote = 1u << 20, extended = 1u << 19, remote = 1u << 0;
}  // namespace bits

/// An id as in the registers: the upper 11 bits at the top, followed by the lower 18 of an id of 29 bits.
constexpr std::uint32_t id_word(std::uint32_t id, bool extended, bool remote) {
  if (!extended) return (id & 0x7FFu) << 21 | (remote ? bits::substitute_remote : 0u);
  return (id >> 18 & 0x7FFu) << 21 | bits::substitute_remote | bits::extended | (id & 0x3FFFFu) << 1 |
         (remote ? bits::remote : 0u);
}

/// Four bytes of a frame, the first in the most significant byte.
constexpr std::uint32_t data_word(const can::Frame& frame, std::size_t first) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word = word << 8 | frame.data[first + i];
  return word;
}

/// Converts the four words of a frame in the FIFO.
constexpr can::Frame frame_of(const std::array<std::uint32_t, 4>& words, std::int64_t time_ns) {
  can::Frame frame;
  frame.time_ns = time_ns;
  frame.extended = (words[0] & bits::extended) != 0;
  frame.remote = (words[0] & (frame.extended ? bits::remote : bits::substitute_remote)) != 0;
  frame.id = frame.extended ? (words[0] >> 21) << 18 | (words[0] >> 1 & 0x3FFFFu) : words[0] >> 21;
  const std::uint32_t length = words[1] >> 28;
  frame.length = static_cast<std::uint8_t>(length < 8 ? length : 8);  // 9 to 15 mean 8 (ISO 11898-1)
  if (frame.remote) return frame;
  for (std::size_t i = 0; i < frame.length; ++i)
    frame.data[i] = static_cast<std::uint8_t>(words[2 + i / 4] >> (24 - 8 * (i % 4)));
  return frame;
}

/// Registers in memory.
class MemoryRegisters {
 public:
  explicit MemoryRegisters(std::uintptr_t base) : base_(base) {}
  std::uint32_t read(Register r) const { return *at(static_cast<std::uint32_t>(r)); }
  void write(Register r, std::uint32_t value) { *at(static_cast<std::uint32_t>(r)) = value; }

 private:
  volatile std::uint32_t* at(std::uint32_t offset) const {
    return reinterpret_cast<volatile std::uint32_t*>(base_ + offset);
  }
  std::uintptr_t base_;
};

}  // namespace curbline::xilinx_can
