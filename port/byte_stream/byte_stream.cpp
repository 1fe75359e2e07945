#include "byte_stream/byte_stream.hpp"

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "byte_stream/descriptor.hpp"

namespace curbline::port {
namespace {

/// Negative when the time is over.
Milliseconds left_until(std::chrono::steady_clock::time_point give_up) {
  return std::chrono::duration_cast<Milliseconds>(give_up - std::chrono::steady_clock::now());
}

}  // namespace

std::optional<ByteStream> ByteStream::tcp(const std::string& host, std::uint16_t port, std::string& error) {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int failed = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found); failed != 0) {
    error = ::gai_strerror(failed);
    return std::nullopt;
  }
  ByteStream stream;
  stream.addresses_.reset(found);
  return stream;
}

ByteStream ByteStream::serial(const std::string& path) {
  ByteStream stream;
  stream.path_ = path;
  return stream;
}

ByteStream::ByteStream(ByteStream&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)), addresses_(std::move(other.addresses_)) {}

ByteStream& ByteStream::operator=(ByteStream&& other) noexcept {
  std::swap(fd_, other.fd_);
  path_.swap(other.path_);
  addresses_.swap(other.addresses_);
  return *this;
}

void ByteStream::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

int ByteStream::connect(Milliseconds patience) {
  close();
  const int failed = path_.empty() ? connect_tcp(patience) : connect_serial();
  if (failed != 0) close();
  return failed;
}

int ByteStream::connect_tcp(Milliseconds patience) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  int untried = 0, failed = 0;
  for (const addrinfo* address = addresses_.get(); address != nullptr; address = address->ai_next) ++untried;
  for (const addrinfo* address = addresses_.get(); address != nullptr; address = address->ai_next, --untried) {
    const Milliseconds left = left_until(give_up);
    failed = connect_tcp(*address, left / untried);
    if (failed == 0) break;
    close();
  }
  return failed;
}

int ByteStream::connect_tcp(const addrinfo& address, Milliseconds patience) {
  fd_ = ::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd_ < 0) return errno;
  const int on = 1;
  ::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (::connect(fd_, address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  if (!wait_for(fd_, POLLOUT, patience)) return ETIMEDOUT;
  int failed = 0;
  socklen_t size = sizeof failed;
  return ::getsockopt(fd_, SOL_SOCKET, SO_ERROR, &failed, &size) == 0 ? failed : errno;
}

int ByteStream::connect_serial() {
  fd_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) return errno;
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) return errno == EWOULDBLOCK ? EBUSY : errno;
  termios line{};
  if (::tcgetattr(fd_, &line) != 0) return errno;
  ::cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  if (::tcsetattr(fd_, TCSANOW, &line) != 0) return errno;
  return ::tcflush(fd_, TCIOFLUSH) == 0 ? 0 : errno;
}

int ByteStream::set_baud(int baud) {
  if (path_.empty() || fd_ < 0) return 0;
  const speed_t speed = speed_of(baud);
  if (speed == B0) return EINVAL;
  termios line{};
  if (::tcgetattr(fd_, &line) != 0) return errno;
  ::cfsetispeed(&line, speed);
  ::cfsetospeed(&line, speed);
  return ::tcsetattr(fd_, TCSANOW, &line) == 0 ? 0 : errno;  // TCSADRAIN waits without a bound
}

ByteStream::Read ByteStream::read(std::span<std::uint8_t> bytes, std::size_t& count, Milliseconds patience) {
  count = 0;
  if (fd_ < 0) return Read::closed;
  if (!wait_for(fd_, POLLIN, patience)) return Read::nothing;
  const ssize_t got = ::read(fd_, bytes.data(), bytes.size());
  if (got > 0) {
    count = static_cast<std::size_t>(got);
    return Read::bytes;
  }
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return Read::nothing;
  return Read::closed;  // 0 is the end of a TCP stream; EIO that of a pty whose other side has closed
}

bool ByteStream::write(std::span<const std::uint8_t> bytes, Milliseconds patience) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  while (!bytes.empty() && fd_ >= 0) {
    const ssize_t put = path_.empty() ? ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                      : ::write(fd_, bytes.data(), bytes.size());
    if (put > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(put));
      continue;
    }
    const Milliseconds left = left_until(give_up);
    const bool try_again = put < 0 && (errno == EAGAIN || errno == EINTR) && left.count() > 0;
    if (!try_again) break;
    wait_for(fd_, POLLOUT, left);
  }
  if (!bytes.empty()) close();
  return bytes.empty();
}

}  // namespace curbline::port
