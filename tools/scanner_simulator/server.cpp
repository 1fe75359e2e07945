#include "scanner_simulator/server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <thread>

#include "byte_stream/descriptor.hpp"
#include "formats/bad_input.hpp"

namespace curbline::tools {
namespace {

using namespace std::chrono_literals;
using port::wait_for;

constexpr auto tick = 20ms, send_patience = 1'000ms;
constexpr std::int64_t lead_ns = 300'000'000;  // the scanner is switched on this long before its first line
constexpr auto last_words = 5s;

std::unique_ptr<Device> make_device(Protocol protocol, const ScanFeed& feed, const std::string& source, int baud) {
  if (feed.front() == nullptr) throw BadInput(source + ": no scan line; expected at least one");
  switch (protocol) {
    case Protocol::scip2:
      return make_scip2_device(*feed.front(), source);
    case Protocol::cola:
      return make_cola_device(*feed.front(), source);
    case Protocol::lms200:
      break;
  }
  return make_lms200_device(*feed.front(), source, baud);
}

}  // namespace

ScannerServer::ScannerServer(Protocol protocol, ScanFeed feed, const std::string& source, ServerOptions options)
    : protocol_(protocol),
      feed_(std::move(feed)),
      options_(std::move(options)),
      device_(make_device(protocol, feed_, source, options_.baud)),
      first_ns_(feed_.front()->time_ns) {
  if (protocol == Protocol::lms200) {
    open_pty();
  } else {
    listen_tcp();
  }
  device_->power_on();
}

ScannerServer::~ScannerServer() {
  drop_reader();
  for (const int fd : {listener_, pty_}) {
    if (fd >= 0) ::close(fd);
  }
}

void ScannerServer::listen_tcp() {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(options_.port);
  socklen_t size = sizeof address;
  auto* any = reinterpret_cast<sockaddr*>(&address);
  if (::bind(listener_, any, size) != 0 || ::listen(listener_, 1) != 0 || ::getsockname(listener_, any, &size) != 0) {
    throw BadInput("port " + std::to_string(options_.port) + ": " + std::strerror(errno) +
                   "; expected a TCP port that is free");
  }
  port_ = ntohs(address.sin_port);
}

/// The server holds both ends open, so that readers may connect and disconnect.
void ScannerServer::open_pty() {
  std::array<char, 64> name{};
  termios raw{};
  ::cfmakeraw(&raw);
  raw.c_cflag |= CREAD | CLOCAL;
  ::cfsetspeed(&raw, B9600);
  if (::openpty(&reader_, &pty_, name.data(), &raw, nullptr) != 0)
    throw BadInput(std::string("pty: ") + std::strerror(errno) + "; expected one to be had");
  ::fcntl(reader_, F_SETFL, O_NONBLOCK);
  for (const int fd : {reader_, pty_}) ::fcntl(fd, F_SETFD, FD_CLOEXEC);
  path_ = name.data();
}

std::string ScannerServer::address() const {
  if (protocol_ == Protocol::lms200) return "lms200:" + path_;
  return std::string(protocol_ == Protocol::scip2 ? "scip2" : "cola") + ":127.0.0.1:" + std::to_string(port_);
}

void ScannerServer::run(const std::atomic<bool>& stop) {
  while (!stop && feed_.front() != nullptr) {
    if (reader_ < 0) accept_reader();
    if (reader_ >= 0) serve();
    while (!stop && feed_.front() != nullptr && line_is_due()) play_line();
  }
  if (!stop) finish();
}

void ScannerServer::accept_reader() {
  if (!wait_for(listener_, POLLIN, tick)) return;
  reader_ = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
}

/// Waits for commands and answers them: for one tick at most, or not at all if a line is due.
void ScannerServer::serve() {
  if (!wait_for(reader_, POLLIN, line_is_due() ? 0ms : clock_runs_ ? 1ms : tick)) return;
  std::array<std::uint8_t, 512> bytes{};
  const ssize_t got = ::read(reader_, bytes.data(), bytes.size());
  if (got <= 0) {
    if (got == 0 || (errno != EAGAIN && errno != EINTR)) drop_reader();
    return;
  }
  if (!clock_runs_) {
    clock_runs_ = true;
    started_ = Clock::now();
  }
  if (same_speed()) send(device_->take(std::span(bytes).first(static_cast<std::size_t>(got)), clock_ns()));
}

/// At different speeds, both sides of a serial line receive noise.
bool ScannerServer::same_speed() const {
  if (pty_ < 0) return true;
  termios line{};
  return ::tcgetattr(pty_, &line) == 0 && ::cfgetospeed(&line) == port::speed_of(device_->baud());
}

std::int64_t ScannerServer::clock_ns() const {
  const double passed_ns = static_cast<double>(std::chrono::nanoseconds(Clock::now() - started_).count());
  return first_ns_ - lead_ns + static_cast<std::int64_t>(passed_ns * (options_.speed > 0 ? options_.speed : 1.0));
}

bool ScannerServer::line_is_due() const {
  if (!played_ && !device_->measuring()) return false;
  if (options_.speed <= 0) return device_->measuring() && reader_ >= 0;
  return clock_ns() >= feed_.front()->time_ns + device_->line_duration_ns();
}

void ScannerServer::play_line() {
  played_ = true;
  const auto scan = feed_.next();
  const long index = next_line_++;
  if (options_.restart_before.contains(index)) restart_device();
  if (reader_ < 0 || !device_->measuring()) return;  // the line is lost
  const std::int64_t measured_ns = scan->time_ns + device_->line_duration_ns();
  if (measured_ns < wire_free_ns_) return;  // a slow serial line is still busy
  Bytes telegram = device_->telegram(*scan);
  if (device_->baud() > 0)
    wire_free_ns_ =
        measured_ns + std::int64_t{10'000'000'000} * static_cast<std::int64_t>(telegram.size()) / device_->baud();
  if (options_.damage) options_.damage(telegram, index);
  send(telegram);
}

void ScannerServer::restart_device() {
  if (pty_ < 0) drop_reader();
  const Bytes hello = device_->power_on();
  if (pty_ >= 0 && same_speed()) send(hello);
}

void ScannerServer::send(const Bytes& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size() && reader_ >= 0) {
    const ssize_t put = pty_ >= 0 ? ::write(reader_, bytes.data() + sent, bytes.size() - sent)
                                  : ::send(reader_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (put > 0) {
      sent += static_cast<std::size_t>(put);
    } else if (put < 0 && (errno == EAGAIN || errno == EINTR)) {
      if (!wait_for(reader_, POLLOUT, send_patience)) return;  // nobody reads: the rest is lost
    } else {
      drop_reader();
    }
  }
}

void ScannerServer::drop_reader() {
  if (reader_ >= 0) ::close(reader_);
  reader_ = -1;
}

/// Closes after the reader has received everything.
void ScannerServer::finish() {
  const auto give_up = Clock::now() + last_words;
  if (pty_ >= 0) {
    int waiting = 1;
    while (Clock::now() < give_up && ::ioctl(pty_, FIONREAD, &waiting) == 0 && waiting > 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    ::close(pty_);
    pty_ = -1;
  } else if (reader_ >= 0) {
    ::shutdown(reader_, SHUT_WR);
    std::array<std::uint8_t, 64> bytes{};
    while (Clock::now() < give_up &&
           (!wait_for(reader_, POLLIN, tick) || ::read(reader_, bytes.data(), bytes.size()) > 0)) {
    }
  }
  drop_reader();
}

}  // namespace curbline::tools
