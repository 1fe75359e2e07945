// What a fuzzer of numbers does with each input.
#pragma once

#include "fuzz/numbers.hpp"

namespace curbline::fuzz {

void run(Numbers& numbers);

}  // namespace curbline::fuzz
