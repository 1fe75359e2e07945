// Clients come, go and stall; the server waits for none of them.
#include "curb_server.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

#include "heap_trap.hpp"
#include "tools/formats_support.hpp"

extern "C" {
int __real_getaddrinfo(const char* host, const char* service, const addrinfo* wanted, addrinfo** found);

/// The linker replaces getaddrinfo by this. Whatever this machine resolves, two.test is first 192.0.2.1, which no
/// machine has (RFC 5737), then 127.0.0.1: as localhost is ::1 first, where IPv6 is off.
int __wrap_getaddrinfo(const char* host, const char* service, const addrinfo* wanted, addrinfo** found) {
  if (std::strcmp(host, "two.test") != 0) return __real_getaddrinfo(host, service, wanted, found);
  const int failed = __real_getaddrinfo("192.0.2.1", service, wanted, found);
  return failed != 0 ? failed : __real_getaddrinfo("127.0.0.1", service, wanted, &(*found)->ai_next);
}
}

namespace curbline::daemon {
namespace {

using tools::testing::TemporaryDirectory;

int connect_unix(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address.sun_path);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  REQUIRE(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  return socket;
}

std::string read_some(int socket) {
  std::array<char, 256> text{};
  const ssize_t got = ::recv(socket, text.data(), text.size(), 0);
  return {text.data(), got > 0 ? static_cast<std::size_t>(got) : 0};
}

/// To the port at the end of `server`, on 127.0.0.1.
int connect_tcp(const std::string& server) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(server.substr(server.rfind(':') + 1))));
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  REQUIRE(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  return socket;
}

TEST_CASE("curb server: every client reads every line, over TCP as over a Unix socket") {
  CurbServer server;
  server.open("tcp:127.0.0.1:0");
  const int client = connect_tcp(server.address());
  int number = -1;
  for (int i = 0; i < 1000 && number < 0; ++i) number = server.accept_client();
  REQUIRE(number >= 0);
  server.send_to(number, "hello\n");
  CHECK(read_some(client) == "hello\n");
  server.send("line\n");
  CHECK(read_some(client) == "line\n");
  ::close(client);
}

TEST_CASE("curb server: of a name with several addresses the first that this machine has is listened at") {
  CurbServer server;
  server.open("tcp:two.test:0");
  const int client = connect_tcp(server.address());
  int number = -1;
  for (int i = 0; i < 1000 && number < 0; ++i) number = server.accept_client();
  CHECK(number >= 0);
  ::close(client);
}

TEST_CASE("curb server: a daemon that is started again has its port at once, though connections to it linger") {
  std::string address;
  int client = -1;
  {
    CurbServer first;
    first.open("tcp:127.0.0.1:0");
    address = first.address();
    client = connect_tcp(address);
    for (int i = 0; i < 1000 && first.accept_client() < 0; ++i) continue;
    REQUIRE(first.clients() == 1);
  }
  CHECK(read_some(client).empty());
  ::close(client);
  CurbServer second;
  CHECK_NOTHROW(second.open(address));
}

TEST_CASE("curb server: a client that does not read is dropped, without a wait, and the others read on") {
  const TemporaryDirectory directory;
  CurbServer server;
  server.open("unix:" + directory.path("s"));
  const int sleeper = connect_unix(directory.path("s")), reader = connect_unix(directory.path("s"));
  REQUIRE(server.accept_client() >= 0);
  REQUIRE(server.accept_client() >= 0);
  CHECK(server.accept_client() == -1);
  const std::string line(200, 'x');
  const std::uint64_t heap_before = heap_calls();
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 20'000 && server.clients() == 2; ++i) {
    server.send(line);
    std::array<char, 200> text{};
    if (::recv(reader, text.data(), text.size(), MSG_WAITALL) != 200) break;
  }
  const bool at_once = std::chrono::steady_clock::now() - start < std::chrono::seconds(5);
  const std::uint64_t heap_asked = heap_calls() - heap_before;
  CHECK(at_once);
  CHECK(heap_asked == 0);
  CHECK(server.clients() == 1);
  CHECK(server.counters().too_slow == 1);
  server.send("on\n");
  CHECK(read_some(reader) == "on\n");
  ::close(sleeper);
  ::close(reader);
}

TEST_CASE("curb server: a client that has gone is forgotten, one too many refused") {
  const TemporaryDirectory directory;
  CurbServer server;
  server.open("unix:" + directory.path("s"));
  std::vector<int> clients;
  for (int i = 0; i < CurbServer::max_clients; ++i) {
    clients.push_back(connect_unix(directory.path("s")));
    REQUIRE(server.accept_client() == i);
  }
  const int one_more = connect_unix(directory.path("s"));
  CHECK(server.accept_client() == -1);
  CHECK(server.counters().refused == 1);
  CHECK(read_some(one_more).empty());
  for (const int client : clients) ::close(client);
  server.send("line\n");
  CHECK(server.clients() == 0);
  CHECK(server.counters().too_slow == 0);
  ::close(one_more);
}

TEST_CASE("curb server: clients that have hung up make room for new ones before the next line is sent") {
  const TemporaryDirectory directory;
  for (const std::string address : {"unix:" + directory.path("s"), std::string("tcp:127.0.0.1:0")}) {
    CurbServer server;
    server.open(address);
    const auto connect = [&] {
      return address.starts_with("unix:") ? connect_unix(directory.path("s")) : connect_tcp(server.address());
    };
    const auto accepted = [&server] {
      int number = -1;
      for (int i = 0; i < 1000 && number < 0; ++i) number = server.accept_client();
      return number;
    };
    const int reader = connect();
    REQUIRE(accepted() == 0);
    for (int i = 0; i < 3 * CurbServer::max_clients; ++i) {
      const int client = connect();
      CHECK(accepted() > 0);
      ::close(client);
    }
    CHECK(server.counters().refused == 0);
    server.send("line\n");
    CHECK(read_some(reader) == "line\n");
    ::close(reader);
  }
}

TEST_CASE("curb server: a client that sends no more, but reads, keeps its place before those that are gone") {
  const TemporaryDirectory directory;
  CurbServer server;
  server.open("unix:" + directory.path("s"));
  const int reader = connect_unix(directory.path("s"));
  REQUIRE(server.accept_client() == 0);
  ::shutdown(reader, SHUT_WR);
  for (int i = 0; i < CurbServer::max_clients; ++i) {
    const int client = connect_unix(directory.path("s"));
    CHECK(server.accept_client() > 0);
    ::close(client);
  }
  server.send("line\n");
  CHECK(read_some(reader) == "line\n");
  ::close(reader);
}

TEST_CASE("curb server: a socket file that was left over is replaced, one in use or another file is not") {
  const TemporaryDirectory directory;
  const std::string path = directory.path("s"), address = "unix:" + path;
  {
    CurbServer first;
    first.open(address);
    CurbServer second;
    CHECK_THROWS_WITH(second.open(address), Catch::Contains("not in use"));
  }
  CHECK_FALSE(std::filesystem::exists(path));
  const int left_over = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), name.sun_path);
  REQUIRE(::bind(left_over, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0);
  ::close(left_over);
  CurbServer third;
  third.open(address);
  CurbServer fourth;
  CHECK_THROWS_WITH(fourth.open("unix:" + directory.write("file", "text")), Catch::Contains("expected a path"));
  CHECK(std::filesystem::exists(directory.path("file")));
}

TEST_CASE("curb server: the socket file of another server, made where its own was removed, is left when it ends") {
  const TemporaryDirectory directory;
  const std::string path = directory.path("s"), address = "unix:" + path;
  CurbServer second;
  {
    CurbServer first;
    first.open(address);
    std::filesystem::remove(path);
    second.open(address);
  }
  REQUIRE(std::filesystem::exists(path));
  ::close(connect_unix(path));
  CHECK(second.accept_client() == 0);
}

TEST_CASE("curb server: an address that makes no sense is refused with what was expected") {
  for (const char* address : {"", "unix:", "tcp:", "tcp:7000", "tcp:127.0.0.1", "tcp::7000", "udp:127.0.0.1:7000"}) {
    CurbServer server;
    CHECK_THROWS_WITH(server.open(address), Catch::Contains("expected unix:PATH or tcp:HOST:PORT"));
  }
  CurbServer server;
  CHECK_THROWS_WITH(server.open("tcp:192.0.2.1:7000"), Catch::Contains("expected a free port"));
}

}  // namespace
}  // namespace curbline::daemon
