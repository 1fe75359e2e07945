// Ends a program that runs in an emulator or debugger.
#include "runtime.hpp"
#include "semihosting/semihosting.hpp"

void curbline::board::leave(int status) {
  if (status == unexpected_exception) semihosting::print("unexpected exception\n");
  semihosting::exit(status);
}
