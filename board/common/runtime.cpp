#include "runtime.hpp"

#include <cstdint>

extern "C" {
using Word = std::uint32_t;
using Constructor = void (*)();
extern Word stack_begin[], stack_end[], data_begin[], data_end[], bss_begin[], bss_end[];  // from the linker script
extern const Word data_load[];
extern const Constructor init_array_begin[], init_array_end[];
}
int main();

namespace curbline::board {
namespace {
constexpr Word paint = 0xC0DEC0DEu;
}

// volatile, because the compiler would otherwise call memset and memcpy, whose own stack is part of what is painted.
void run_main() {
  constexpr std::size_t own_frames = 128;  // of this function and those that it calls
  const void* const below = static_cast<const std::byte*>(__builtin_frame_address(0)) - own_frames;
  for (volatile Word* p = stack_begin; p < below; ++p) *p = paint;
  const Word* from = data_load;
  for (volatile Word* to = data_begin; to < data_end; ++to, ++from) *to = *from;
  for (volatile Word* to = bss_begin; to < bss_end; ++to) *to = 0;
  for (const Constructor* constructor = init_array_begin; constructor < init_array_end; ++constructor) (*constructor)();
  leave(main());
}

std::size_t stack_used() {
  const volatile Word* p = stack_begin;
  while (p < stack_end && *p == paint) ++p;
  return reinterpret_cast<std::uintptr_t>(stack_end) - reinterpret_cast<std::uintptr_t>(p);
}

}  // namespace curbline::board
