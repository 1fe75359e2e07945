// Functions that startup.S calls, on the stack of the supervisor mode.
#include "runtime.hpp"

extern "C" {
[[noreturn]] void start();
[[noreturn]] void unexpected_exception();
}

void start() {
  curbline::board::run_main();
}

void unexpected_exception() {
  curbline::board::leave(curbline::board::unexpected_exception);
}
