#include "port.hpp"

bool Port::open(const curbline::can::Signal&) {
  return true;  // yours: such as xilinx_can::XilinxCan::open(), a timer, a serial line at the scanner's rate
}

std::int64_t Port::now_ns() {
  return 0;  // yours: a free-running timer, widened to 64 bits
}

int Port::receive(std::span<curbline::can::Frame>) {
  return 0;  // yours
}

std::optional<curbline::ScanLine> Port::scan_line() {
  return std::nullopt;  // yours: such as port/scip2 fed with the bytes of the scanner
}

std::optional<curbline::Pose> Port::pose() {
  return std::nullopt;  // yours: odometry, in the map frame
}

bool Port::send(const curbline::can::Frame&) {
  return false;  // yours
}

void Port::rest() {
  // yours: wfi, the watchdog
}

void Port::stop(const char*) {
  for (;;) {
    // yours: a light, a line on a console
  }
}
