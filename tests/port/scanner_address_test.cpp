// A scanner by a name that has several addresses, as "localhost" has ::1 and 127.0.0.1.
#include <arpa/inet.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstring>

#include "byte_stream/byte_stream.hpp"

extern "C" {
int __real_getaddrinfo(const char* host, const char* service, const addrinfo* wanted, addrinfo** found);

/// The linker puts it in getaddrinfo's place: whatever this machine calls its addresses, two.test is 127.0.0.2 first,
/// then 127.0.0.1.
int __wrap_getaddrinfo(const char* host, const char* service, const addrinfo* wanted, addrinfo** found) {
  if (std::strcmp(host, "two.test") != 0) return __real_getaddrinfo(host, service, wanted, found);
  const int failed = __real_getaddrinfo("127.0.0.2", service, wanted, found);
  return failed != 0 ? failed : __real_getaddrinfo("127.0.0.1", service, wanted, &(*found)->ai_next);
}
}

namespace curbline::test {
namespace {

using namespace std::chrono_literals;

/// Listens on an address of this machine. A silent one answers no more: its queue of connections is full.
class Listener {
 public:
  enum class Kind { answers, silent };

  Listener(const char* host, std::uint16_t at_port, Kind kind) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(at_port);
    REQUIRE(::inet_pton(AF_INET, host, &address.sin_addr) == 1);
    socklen_t size = sizeof address;
    auto* any = reinterpret_cast<sockaddr*>(&address);
    REQUIRE(::bind(socket_, any, size) == 0);
    REQUIRE(::listen(socket_, kind == Kind::silent ? 0 : 4) == 0);
    REQUIRE(::getsockname(socket_, any, &size) == 0);
    port = ntohs(address.sin_port);
    for (int& waiting : waiting_) {
      if (kind == Kind::answers) break;
      waiting = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
      ::connect(waiting, any, size);
    }
  }
  ~Listener() {
    for (const int waiting : waiting_) {
      if (waiting >= 0) ::close(waiting);
    }
    ::close(socket_);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  std::uint16_t port = 0;

 private:
  int socket_;
  std::array<int, 4> waiting_{-1, -1, -1, -1};
};

port::ByteStream two_addresses(std::uint16_t port) {
  std::string error;
  auto stream = port::ByteStream::tcp("two.test", port, error);
  REQUIRE(stream);
  return std::move(*stream);
}

TEST_CASE("address: a scanner that listens on the second address of its name is found there, each time anew") {
  const Listener listener("127.0.0.1", 0, Listener::Kind::answers);
  port::ByteStream stream = two_addresses(listener.port);
  CHECK(stream.connect(2s) == 0);
  CHECK(stream.connect(2s) == 0);
  CHECK(stream.is_open());
}

TEST_CASE("address: one that does not answer leaves time for the next") {
  const Listener listener("127.0.0.1", 0, Listener::Kind::answers);
  const Listener silent("127.0.0.2", listener.port, Listener::Kind::silent);
  port::ByteStream stream = two_addresses(listener.port);
  CHECK(stream.connect(200ms) == 0);
}

TEST_CASE("address: where none answers the last error is told, within the time given") {
  std::uint16_t free_port = 0;
  {
    const Listener gone("127.0.0.1", 0, Listener::Kind::answers);
    free_port = gone.port;
  }
  const Listener first("127.0.0.2", free_port, Listener::Kind::silent);
  port::ByteStream stream = two_addresses(free_port);
  CHECK(stream.connect(200ms) == ECONNREFUSED);
  CHECK_FALSE(stream.is_open());
  const Listener second("127.0.0.1", free_port, Listener::Kind::silent);
  const auto before = std::chrono::steady_clock::now();
  CHECK(stream.connect(200ms) == ETIMEDOUT);
  const auto took = std::chrono::steady_clock::now() - before;
  CHECK(took > 190ms);
  CHECK(took < 400ms);
}

}  // namespace
}  // namespace curbline::test
