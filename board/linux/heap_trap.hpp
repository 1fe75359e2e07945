// How often the process has asked the heap for memory: malloc and its kin are replaced (heap_trap.cpp), operator new
// and the C library call them too. The daemon notes the count when it has started, and gives out how much it has grown
// since: 0, or something allocates in the loop. The count of the start itself, which is never 0, shows that the trap
// sees. Costs one atomic addition a call. Any thread. glibc only; with AddressSanitizer, which has a malloc of its own,
// nothing is counted and heap_trapped() is false.
#pragma once

#include <cstdint>

namespace curbline::daemon {

bool heap_trapped();
std::uint64_t heap_calls();

}  // namespace curbline::daemon
