// From reset to main() on a Cortex-M with an FPU. Source: Armv7-M Architecture Reference Manual, B1.5 (vectors, reset),
// B3.2.20 (CPACR).
#include <cstddef>
#include <cstdint>

#include "runtime.hpp"

extern "C" {
extern std::uint32_t stack_end[];
[[noreturn]] void reset();
void unexpected();  // does not return
[[noreturn]] void stop();
void dispatch();
[[gnu::weak]] void on_interrupt(std::uint32_t irq);
}

namespace {

using Handler = void (*)();
constexpr std::size_t interrupt_count = 240;  // as many as a Cortex-M7 may have, and a Cortex-M4

struct Vectors {
  std::uint32_t* stack;
  Handler exceptions[15];
  Handler interrupts[interrupt_count];
};

constexpr Vectors make_vectors() {
  Vectors vectors{stack_end, {reset}, {}};
  for (std::size_t i = 1; i < 15; ++i) vectors.exceptions[i] = unexpected;
  for (Handler& handler : vectors.interrupts) handler = dispatch;
  return vectors;
}

[[gnu::section(".vectors"), gnu::used]] constinit const Vectors vectors = make_vectors();

}  // namespace

void dispatch() {
  std::uint32_t exception;
  asm volatile("mrs %0, ipsr" : "=r"(exception));
  on_interrupt(exception - 16);
}

void on_interrupt(std::uint32_t) {
  unexpected();
}

/// Reuses the whole stack, since nothing returns: it may be its overflow that has led here.
[[gnu::naked]] void unexpected() {
  asm volatile("ldr r0, =stack_end\n mov sp, r0\n bl stop");
}

void stop() {
  curbline::board::leave(curbline::board::unexpected_exception);
}

void reset() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFu << 20;  // CPACR: full access to CP10 and CP11, the FPU
  asm volatile("dsb\n isb" ::: "memory");
  curbline::board::run_main();
}
