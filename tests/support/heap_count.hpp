// How often the program has asked the heap for memory: operator new is replaced in heap_count.cpp, malloc and its like
// are wrapped by the linker. Link the library heap_count.
#pragma once

namespace curbline::test {

/// Calls of operator new, malloc and the like since the program began, by all threads.
long heap_count();

}  // namespace curbline::test
