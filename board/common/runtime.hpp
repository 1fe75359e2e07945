// From a board's own first instructions to main(): what is the same on every core without an operating system. The
// linker script gives the symbols in runtime.cpp.
#pragma once

#include <cstddef>

namespace curbline::board {

/// Fills the stack from its low end to `below` with a pattern, for stack_used().
void paint_stack(const void* below);

/// Copies initial values, clears the rest, runs constructors, then main(), and leaves with its status. The FPU must be
/// on.
[[noreturn]] void run_main();

/// What a board has of its own: where main() goes when it returns, and an exception that nobody handles.
/// leave_to_host.cpp tells the host.
[[noreturn]] void leave(int status);
inline constexpr int unexpected_exception = 3;

/// Bytes of the stack that were ever written since it was painted.
std::size_t stack_used();

}  // namespace curbline::board
