// How often the program has asked the heap for memory: operator new is replaced in heap_count.cpp.
#pragma once

namespace curbline::test {

/// Calls of operator new since the program began, by all threads.
long heap_count();

}  // namespace curbline::test
