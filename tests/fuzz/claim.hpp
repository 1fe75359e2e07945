// What must hold, whatever comes. A fuzzer stops where it does not, and keeps the input.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace curbline::fuzz {

inline void claim(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

}  // namespace curbline::fuzz
