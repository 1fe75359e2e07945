// Functions that startup.S calls, on the stack of the supervisor mode.
#include <cstddef>

#include "runtime.hpp"

extern "C" {
[[noreturn]] void start();
[[noreturn]] void unexpected_exception();
}

void start() {
  constexpr std::size_t own_frames = 128;  // of this function and those that it calls
  curbline::board::paint_stack(static_cast<const std::byte*>(__builtin_frame_address(0)) - own_frames);
  curbline::board::run_main();
}

void unexpected_exception() {
  curbline::board::leave(curbline::board::unexpected_exception);
}
