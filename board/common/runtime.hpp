// From a board's first instructions to main(): what is the same on every core without an operating system. The linker
// script defines the symbols that runtime.cpp uses.
#pragma once

#include <cstddef>
#include <cstdint>

/// A program that enables interrupts of a Cortex-M defines it: called for each, with its number.
extern "C" void on_interrupt(std::uint32_t irq);

namespace curbline::board {

/// Fills the free stack with a pattern, for stack_used(), copies initial values, clears the other data, runs
/// constructors, then main(), and leaves with its status. The FPU must be on.
[[noreturn]] void run_main();

/// Each board defines this: called when main() returns, and for unhandled exceptions. leave_to_host.cpp reports the
/// status to the host.
[[noreturn]] void leave(int status);
inline constexpr int unexpected_exception = 3;

/// Bytes of the stack that were written at any time since it was painted.
std::size_t stack_used();

}  // namespace curbline::board
