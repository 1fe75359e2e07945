#include "scanner_listener.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>

namespace curbline::test {

Listener::Listener(const char* host, std::uint16_t at_port, int queue) : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(at_port);
  REQUIRE(::inet_pton(AF_INET, host, &address.sin_addr) == 1);
  socklen_t size = sizeof address;
  auto* any = reinterpret_cast<sockaddr*>(&address);
  REQUIRE(::bind(fd_, any, size) == 0);
  REQUIRE(::listen(fd_, queue) == 0);
  REQUIRE(::getsockname(fd_, any, &size) == 0);
  port_ = ntohs(address.sin_port);
}

Listener::~Listener() {
  ::close(fd_);
}

}  // namespace curbline::test
