// TIMER0 of the MPS2, whose interrupt on_interrupt() handles. Source: Arm, Cortex-M System Design Kit TRM (DDI 0479),
// APB timer; Armv7-M Architecture Reference Manual, B3.4 (NVIC).
#pragma once

#include <cstdint>

namespace curbline::board::timer {

inline constexpr std::uintptr_t base = 0x40000000;  // AN500's memory map
inline constexpr std::uint32_t irq = 8;

inline volatile std::uint32_t& word(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

/// The next interrupt comes after this many ticks of 40 ns, and the following ones with this period: a write of the
/// reload value also sets the current one.
inline void set_period(std::uint32_t ticks) {
  word(base + 8) = ticks;
}

inline void start(std::uint32_t ticks) {
  word(base + 4) = ticks;
  set_period(ticks);
  word(0xE000E100) = 1u << irq;  // NVIC_ISER0
  constexpr std::uint32_t enable = 1u << 0, interrupt = 1u << 3;
  word(base) = enable | interrupt;
}

inline void stop() {
  word(base) = 0;
}

/// To be called first in on_interrupt().
inline void acknowledge() {
  word(base + 12) = 1;
}

}  // namespace curbline::board::timer
