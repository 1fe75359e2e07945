#include "fuzz/run.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  curbline::fuzz::Numbers numbers(bytes, size);
  curbline::fuzz::run(numbers);
  return 0;
}
