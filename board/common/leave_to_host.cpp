// The end of a program that an emulator or a debugger runs.
#include "runtime.hpp"
#include "semihosting/semihosting.hpp"

void curbline::board::leave(int status) {
  if (status == unexpected_exception) semihosting::print("unexpected exception\n");
  semihosting::exit(status);
}
