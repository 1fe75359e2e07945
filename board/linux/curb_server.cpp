#include "curb_server.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "formats/bad_input.hpp"
#include "streams/endpoint.hpp"

namespace curbline::daemon {
namespace {

using tools::BadInput;

constexpr std::string_view unix_scheme = "unix:", tcp_scheme = "tcp:";

sockaddr_un unix_address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address.sun_path);
  return address;
}

/// The number of a file, which no other has as long as a socket is bound to it; 0 if there is none.
ino_t number_of(const std::string& path) {
  struct stat file {};
  return ::lstat(path.c_str(), &file) == 0 ? file.st_ino : 0;
}

/// Whether this is a socket file left over from a process that has ended.
bool is_left_over(const std::string& path) {
  struct stat file {};
  if (::lstat(path.c_str(), &file) != 0 || !S_ISSOCK(file.st_mode)) return false;
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const sockaddr_un address = unix_address(path);
  const bool refused =
      ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 && errno == ECONNREFUSED;
  ::close(probe);
  return refused;
}

/// -1 on failure, with the reason in errno.
int listen_at(const addrinfo& address, int most_waiting) {
  const int socket = ::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return -1;
  const int on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(socket, address.ai_addr, address.ai_addrlen) == 0 && ::listen(socket, most_waiting) == 0) return socket;
  const int error = errno;
  ::close(socket);
  errno = error;
  return -1;
}

std::uint16_t port_of(int socket) {
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&bound), &size);
  return ntohs(bound.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(bound).sin6_port
                                           : reinterpret_cast<const sockaddr_in&>(bound).sin_port);
}

}  // namespace

CurbServer::~CurbServer() {
  for (int i = 0; i < max_clients; ++i) drop(i);
  // While it still listens: later another server may take the file for left over, and make its own.
  if (file_number_ != 0 && number_of(path_) == file_number_) ::unlink(path_.c_str());
  if (listener_ >= 0) ::close(listener_);
}

void CurbServer::open(const std::string& address) {
  address_ = address;
  if (address.starts_with(unix_scheme) && address.size() > unix_scheme.size()) {
    listen_unix(address.substr(unix_scheme.size()));
    return;
  }
  if (address.starts_with(tcp_scheme)) {
    const tools::Endpoint endpoint = tools::parse_endpoint(address, tcp_scheme.size(), 0);
    if (!endpoint.host.empty() && endpoint.port) return listen_tcp(endpoint.host, *endpoint.port);
  }
  throw BadInput(address + ": no address; expected unix:PATH or tcp:HOST:PORT");
}

void CurbServer::listen_unix(const std::string& path) {
  if (path.size() >= sizeof(sockaddr_un::sun_path)) throw BadInput(address_ + ": too long; expected 107 bytes at most");
  if (is_left_over(path)) ::unlink(path.c_str());
  const sockaddr_un address = unix_address(path);
  listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (listener_ < 0 || ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw BadInput(address_ + ": " + std::strerror(errno) + "; expected a path that can be made and is not in use");
  }
  path_ = path;
  file_number_ = number_of(path);
  if (::listen(listener_, max_clients) != 0) throw BadInput(address_ + ": " + std::strerror(errno));
}

void CurbServer::listen_tcp(const std::string& host, std::uint16_t port) {
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  if (const int failed = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found); failed != 0) {
    throw BadInput(address_ + ": " + ::gai_strerror(failed) + "; expected tcp:HOST:PORT of this machine");
  }
  for (const addrinfo* address = found; address != nullptr && listener_ < 0; address = address->ai_next)
    listener_ = listen_at(*address, max_clients);
  const int error = errno;
  ::freeaddrinfo(found);
  if (listener_ < 0) throw BadInput(address_ + ": " + std::strerror(error) + "; expected a free port of this machine");
  address_ = address_.substr(0, address_.rfind(':') + 1) + std::to_string(port_of(listener_));
}

int CurbServer::accept_client() {
  const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (socket < 0) return -1;
  if (connected_ == max_clients) drop_hung_up();
  const auto place = std::find(clients_.begin(), clients_.end(), -1);
  if (place == clients_.end()) {
    ::close(socket);
    ++counters_.refused;
    return -1;
  }
  const int size = send_buffer_bytes, on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &size, sizeof size);
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);  // fails on a Unix socket, which does not need it
  *place = socket;
  ++connected_;
  ++counters_.accepted;
  return static_cast<int>(place - clients_.begin());
}

void CurbServer::send_to(int client, std::string_view line) {
  const int socket = clients_[static_cast<std::size_t>(client)];
  if (socket < 0) return;
  const ssize_t sent = ::send(socket, line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent == static_cast<ssize_t>(line.size())) return;
  if (sent >= 0 || errno == EAGAIN) ++counters_.too_slow;  // otherwise the client has closed the connection
  drop(client);
}

void CurbServer::send(std::string_view line) {
  for (int i = 0; i < max_clients; ++i) send_to(i, line);
}

void CurbServer::drop_hung_up() {
  std::array<pollfd, max_clients> looked{};
  for (std::size_t i = 0; i < looked.size(); ++i) looked[i] = {clients_[i], POLLRDHUP, 0};
  if (::poll(looked.data(), looked.size(), 0) <= 0) return;
  for (const short signs : {short{POLLHUP | POLLERR}, short{POLLRDHUP}}) {
    for (int i = 0; i < max_clients; ++i) {
      if ((looked[static_cast<std::size_t>(i)].revents & signs) != 0) drop(i);
    }
    if (connected_ < max_clients) return;
  }
}

void CurbServer::drop(int client) {
  int& socket = clients_[static_cast<std::size_t>(client)];
  if (socket < 0) return;
  ::close(socket);
  socket = -1;
  --connected_;
}

}  // namespace curbline::daemon
