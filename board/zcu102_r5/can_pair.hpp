// The two CAN controllers of the Zynq UltraScale+. Source: UG1085, address map. The boot loader has set up their clock
// of 100 MHz and their pins.
#pragma once

#include "xilinx_can/xilinx_can.hpp"

namespace curbline::board {

using Can = xilinx_can::XilinxCan<xilinx_can::MemoryRegisters>;
inline constexpr std::uintptr_t can0_base = 0xFF060000, can1_base = 0xFF070000;
inline constexpr xilinx_can::Settings can_settings{.clock_hz = 100'000'000, .bits_s = 500'000};

}  // namespace curbline::board
