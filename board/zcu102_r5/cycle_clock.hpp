// A clock based on the core's cycle counter. Source: Armv7-A and -R Architecture Reference Manual, B4.1.112 (PMCCNTR
// and related registers).
#pragma once

#include <cstdint>

namespace curbline::board {

/// Must be read at least every 4 s, the period at which the counter wraps.
class CycleClock {
 public:
  void start(std::int64_t now_ns) {
    constexpr std::uint32_t enable = 1u << 0, reset_cycles = 1u << 2, cycle_counter = 1u << 31;
    asm volatile("mcr p15, 0, %0, c9, c12, 0" ::"r"(enable | reset_cycles));  // PMCR
    asm volatile("mcr p15, 0, %0, c9, c12, 1" ::"r"(cycle_counter));          // PMCNTENSET
    now_ns_ = now_ns;
    last_ = cycles();
  }

  std::int64_t now_ns() {
    const std::uint32_t c = cycles();
    now_ns_ += static_cast<std::int64_t>(c - last_) * ns_a_cycle;
    last_ = c;
    return now_ns_;
  }

  /// Ignores the time since the clock was last read.
  void skip() { last_ = cycles(); }

 private:
  static constexpr std::int64_t ns_a_cycle = 1;  // QEMU's counter runs at 1 GHz

  static std::uint32_t cycles() {
    std::uint32_t c;
    asm volatile("mrc p15, 0, %0, c9, c13, 0" : "=r"(c));
    return c;
  }

  std::int64_t now_ns_ = 0;
  std::uint32_t last_ = 0;
};

}  // namespace curbline::board
