// The trap sees every way to the heap, so a daemon that reports 0 calls makes none.
#include "heap_trap.hpp"

#include <malloc.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <sstream>
#include <utility>
#include <vector>

namespace curbline::daemon {
namespace {

void* volatile kept;

/// Keeps the compiler from removing an allocation whose result is unused.
void give_back(void* memory) {
  kept = memory;
  std::free(kept);
}

TEST_CASE("heap trap: every kind of allocation is counted, whoever makes it") {
  if (!heap_trapped()) {
    WARN("SKIPPED: a sanitizer has a malloc of its own");
    return;
  }
  const std::vector<std::pair<const char*, std::function<void()>>> ways{
      {"malloc", [] { give_back(std::malloc(8)); }},
      {"calloc", [] { give_back(std::calloc(2, 8)); }},
      {"realloc", [] { give_back(std::realloc(nullptr, 8)); }},
      {"aligned_alloc", [] { give_back(std::aligned_alloc(64, 64)); }},
      {"memalign", [] { give_back(::memalign(64, 64)); }},
      {"posix_memalign",
       [] {
         void* memory = nullptr;
         CHECK(::posix_memalign(&memory, 64, 64) == 0);
         give_back(memory);
       }},
      {"operator new", [] { ::operator delete(::operator new(8)); }},
      {"the C library itself", [] { give_back(::strdup("text")); }},
      {"the C++ library itself", [] { std::stringbuf().sputn(std::array<char, 600>{}.data(), 600); }},
  };
  for (const auto& [name, ask] : ways) {
    const std::uint64_t before = heap_calls();
    ask();
    const std::uint64_t counted = heap_calls() - before;
    INFO(name);
    CHECK(counted >= 1);
  }
}

TEST_CASE("heap trap: what asks for nothing is not counted") {
  const std::uint64_t before = heap_calls();
  std::free(nullptr);
  CHECK(heap_calls() == before);
}

}  // namespace
}  // namespace curbline::daemon
