// From reset to main() on a Cortex-M with an FPU, and what every exception does that nobody handles. Source: Armv7-M
// Architecture Reference Manual, B1.5 (vectors, reset), B3.2.20 (CPACR).
#include <cstddef>
#include <cstdint>

#include "board.hpp"
#include "semihosting/semihosting.hpp"

extern "C" {
using Word = std::uint32_t;
using Function = void (*)();
extern Word stack_begin[], stack_end[], data_begin[], data_end[], data_load[], bss_begin[], bss_end[];  // of the linker script
extern const Function init_array_begin[], init_array_end[];
int main();
[[noreturn]] void reset();
[[noreturn]] void unexpected();
void on_timer();
}

namespace {

constexpr Word paint = 0xC0DEC0DEu;
constexpr std::size_t timer0_irq = 8;

struct Vectors {
  Word* stack;
  Function exceptions[15];
  Function interrupts[16];
};

constexpr Vectors make_vectors() {
  Vectors vectors{stack_end, {reset}, {}};
  for (std::size_t i = 1; i < 15; ++i) vectors.exceptions[i] = unexpected;
  for (Function& handler : vectors.interrupts) handler = unexpected;
  vectors.interrupts[timer0_irq] = on_timer;
  return vectors;
}

[[gnu::section(".vectors"), gnu::used]] constinit const Vectors vectors = make_vectors();

}  // namespace

/// A board without a servo timer leaves it so.
extern "C" [[gnu::weak]] void on_timer() {
  unexpected();
}

extern "C" void unexpected() {
  curbline::semihosting::print("unexpected exception\n");
  curbline::semihosting::exit(3);
}

/// Naked of calls until the stack is painted and the FPU is on.
extern "C" void reset() {
  *reinterpret_cast<volatile Word*>(0xE000ED88) |= 0xFu << 20;  // CPACR: full access to CP10 and CP11, the FPU
  asm volatile("dsb\n isb" ::: "memory");
  Word* const here = static_cast<Word*>(__builtin_frame_address(0)) - 16;
  for (volatile Word* p = stack_begin; p < here; ++p) *p = paint;
  const volatile Word* from = data_load;
  for (volatile Word* to = data_begin; to < data_end; ++to, ++from) *to = *from;
  for (volatile Word* to = bss_begin; to < bss_end; ++to) *to = 0;
  for (const Function* f = init_array_begin; f < init_array_end; ++f) (*f)();
  curbline::semihosting::exit(main());
}

std::size_t curbline::board::stack_used() {
  const volatile Word* p = stack_begin;
  while (p < stack_end && *p == paint) ++p;
  return static_cast<std::size_t>(reinterpret_cast<std::uintptr_t>(stack_end) - reinterpret_cast<std::uintptr_t>(p));
}
