// What must hold for every input. Otherwise the fuzzer stops and keeps the input.
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
