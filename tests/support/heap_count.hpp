// Counts how often the program has requested memory from the heap: heap_count.cpp replaces operator new, the linker
// wraps malloc and its relatives. Link the library heap_count.
#pragma once

namespace curbline::test {

/// Calls of operator new, malloc and their relatives since the start of the program, by all threads.
long heap_count();

}  // namespace curbline::test
