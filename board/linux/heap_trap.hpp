// Counts the process's heap allocations: malloc and its relatives are replaced (heap_trap.cpp); operator new and the C
// library call them too. The daemon notes the count after its start and reports how much it has grown since: 0, unless
// something allocates in the loop. The count at start-up, which is never 0, shows that the trap works. Costs one atomic
// addition a call. Any thread. glibc only; with AddressSanitizer, which has its own malloc, nothing is counted and
// heap_trapped() is false.
#pragma once

#include <cstdint>

namespace curbline::daemon {

bool heap_trapped();
std::uint64_t heap_calls();

}  // namespace curbline::daemon
