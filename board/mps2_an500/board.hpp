// What the board's own code offers its programs.
#pragma once

#include <cstddef>

namespace curbline::board {

/// Bytes of the stack that were ever written since reset.
std::size_t stack_used();

}  // namespace curbline::board
