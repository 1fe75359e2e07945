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

/// Bytes of the stack that were ever written since it was painted.
std::size_t stack_used();

}  // namespace curbline::board
