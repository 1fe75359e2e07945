#include "port.hpp"

bool Port::open(const curbline::can::Signal&) {
  return true;  // for you to write, for example with xilinx_can::XilinxCan::open(), a timer, a serial line at the
                // scanner's rate
}

std::int64_t Port::now_ns() {
  return 0;  // for you to write: a free-running timer, extended to 64 bits
}

int Port::receive(std::span<curbline::can::Frame>) {
  return 0;  // for you to write
}

std::optional<curbline::ScanLine> Port::scan_line() {
  return std::nullopt;  // for you to write, for example port/scip2 fed with the scanner's bytes
}

std::optional<curbline::Pose> Port::pose() {
  return std::nullopt;  // for you to write: odometry, in the map frame
}

bool Port::send(const curbline::can::Frame&) {
  return false;  // for you to write
}

void Port::rest() {
  // for you to write: wfi, the watchdog
}

void Port::stop(const char*) {
  for (;;) {
    // for you to write: a light, a line on a console
  }
}
