// TIMER0 of the MPS2, whose interrupt on_interrupt() takes. Source: Arm, Cortex-M System Design Kit TRM (DDI 0479), APB
// timer; Armv7-M Architecture Reference Manual, B3.4 (NVIC).
#pragma once

#include <cstdint>

namespace curbline::board::timer {

inline constexpr std::uintptr_t base = 0x40000000;  // AN500's memory map
inline constexpr std::uint32_t irq = 8;

inline volatile std::uint32_t& word(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

/// From now on, and after each call of on_interrupt(), in so many ticks of 40 ns.
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

/// What on_interrupt() does first.
inline void acknowledge() {
  word(base + 12) = 1;
}

}  // namespace curbline::board::timer
