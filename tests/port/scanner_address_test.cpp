// A scanner whose name has several addresses, as "localhost" has ::1 and 127.0.0.1.
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstring>

#include "byte_stream/byte_stream.hpp"
#include "scanner_listener.hpp"
#include "scanner_support.hpp"

extern "C" {
int __real_getaddrinfo(const char* host, const char* service, const addrinfo* wanted, addrinfo** found);

/// The linker replaces getaddrinfo by this. Whatever this machine resolves, two.test is first 127.0.0.2, then
/// 127.0.0.1.
int __wrap_getaddrinfo(const char* host, const char* service, const addrinfo* wanted, addrinfo** found) {
  if (std::strcmp(host, "two.test") != 0) return __real_getaddrinfo(host, service, wanted, found);
  const int failed = __real_getaddrinfo("127.0.0.2", service, wanted, found);
  return failed != 0 ? failed : __real_getaddrinfo("127.0.0.1", service, wanted, &(*found)->ai_next);
}
}

namespace curbline::test {
namespace {

using namespace std::chrono_literals;

/// Does not answer, because its queue of connections is full.
class SilentListener {
 public:
  SilentListener(const char* host, std::uint16_t at_port) : listener_(host, at_port, 0) {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    auto* any = reinterpret_cast<sockaddr*>(&address);
    REQUIRE(::getsockname(listener_.fd(), any, &size) == 0);
    for (int& waiting : waiting_) {
      waiting = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
      ::connect(waiting, any, size);
    }
  }
  ~SilentListener() {
    for (const int waiting : waiting_) ::close(waiting);
  }
  SilentListener(const SilentListener&) = delete;
  SilentListener& operator=(const SilentListener&) = delete;

 private:
  Listener listener_;
  std::array<int, 4> waiting_{};
};

port::ByteStream two_addresses(std::uint16_t port) {
  std::string error;
  auto stream = port::ByteStream::tcp("two.test", port, error);
  REQUIRE(stream);
  return std::move(*stream);
}

TEST_CASE("address: a scanner that listens on the second address of its name is found there, each time anew") {
  const Listener listener;
  port::ByteStream stream = two_addresses(listener.port());
  CHECK(stream.connect(2s) == 0);
  CHECK(stream.connect(2s) == 0);
  CHECK(stream.is_open());
}

TEST_CASE("address: one that does not answer leaves time for the next") {
  const Listener listener;
  const SilentListener silent("127.0.0.2", listener.port());
  port::ByteStream stream = two_addresses(listener.port());
  CHECK(stream.connect(200ms) == 0);
}

TEST_CASE("address: where none answers the last error is told, within the time given") {
  std::uint16_t free_port = 0;
  {
    const Listener gone;
    free_port = gone.port();
  }
  const SilentListener first("127.0.0.2", free_port);
  port::ByteStream stream = two_addresses(free_port);
  CHECK(stream.connect(200ms) == ECONNREFUSED);
  CHECK_FALSE(stream.is_open());
  const SilentListener second("127.0.0.1", free_port);
  const auto before = std::chrono::steady_clock::now();
  CHECK(stream.connect(200ms) == ETIMEDOUT);
  const auto took = std::chrono::steady_clock::now() - before;
  CHECK(took > 190ms);
  CHECK(took < 400ms);
}

}  // namespace
}  // namespace curbline::test
