// Helpers for file descriptors, used by the byte stream and by the simulated scanner at its other end.
#pragma once

#include <poll.h>
#include <termios.h>

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace curbline::port {

/// True if the descriptor is ready in time; false if not, or if a signal came.
inline bool wait_for(int fd, short events, std::chrono::milliseconds patience) {
  pollfd poll_fd{fd, events, 0};
  return ::poll(&poll_fd, 1, static_cast<int>(std::max<std::int64_t>(patience.count(), 0))) == 1;
}

/// The speed of a serial line; B0 if it is not one that ByteStream::set_baud() accepts.
constexpr speed_t speed_of(int baud) {
  switch (baud) {
    case 9'600:
      return B9600;
    case 19'200:
      return B19200;
    case 38'400:
      return B38400;
    case 57'600:
      return B57600;
    case 115'200:
      return B115200;
    case 500'000:
      return B500000;
    default:
      return B0;
  }
}

}  // namespace curbline::port
