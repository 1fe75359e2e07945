// A TCP port of this machine that is open and sends nothing.
#pragma once

#include <cstdint>

namespace curbline::test {

/// Listens on an address of this machine. Nobody accepts, but the kernel still connects as many clients as `queue`.
class Listener {
 public:
  explicit Listener(const char* host = "127.0.0.1", std::uint16_t at_port = 0, int queue = 4);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  std::uint16_t port() const { return port_; }
  int fd() const { return fd_; }

 private:
  int fd_;
  std::uint16_t port_ = 0;
};

}  // namespace curbline::test
