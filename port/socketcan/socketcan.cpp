#include "socketcan/socketcan.hpp"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "socketcan/raw_frame.hpp"

namespace curbline::socketcan {
namespace {

constexpr int receive_buffer_bytes = 4 << 20;
constexpr std::int64_t look_again_ms = 50;

std::int64_t now_ms() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
}

std::int64_t ns_of(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

template <typename T>
bool set_option(int fd, int level, int name, const T& value) {
  return ::setsockopt(fd, level, name, &value, sizeof value) == 0;
}

ifreq request_for(const std::array<char, 16>& interface_name) {
  static_assert(IFNAMSIZ == 16);
  ifreq request{};
  std::copy(interface_name.begin(), interface_name.end(), request.ifr_name);
  return request;
}

Status status_of(int error) {
  switch (error) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
      return Status::no_can;
    case ENODEV:
    case ENXIO:
      return Status::no_interface;
    case EACCES:
    case EPERM:
      return Status::not_permitted;
    case ENETDOWN:
      return Status::interface_down;
    case ENOBUFS:
    case EAGAIN:
      return Status::queue_full;
    case EINVAL:
    case EMSGSIZE:
      return Status::bad_frame;
    default:
      return Status::system_error;
  }
}

}  // namespace

const char* to_string(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::no_can:
      return "this kernel has no CAN";
    case Status::no_interface:
      return "no such interface";
    case Status::not_can:
      return "not a CAN interface";
    case Status::not_permitted:
      return "not permitted";
    case Status::too_many_filters:
      return "too many filters";
    case Status::interface_down:
      return "the interface is down";
    case Status::queue_full:
      return "the send queue is full";
    case Status::bad_frame:
      return "no frame that the interface carries";
    case Status::not_open:
      return "not open";
    case Status::system_error:
      return "system error";
  }
  return "?";
}

Status SocketCan::open(const char* interface_name, std::span<const Filter> filters) {
  close();
  if (filters.size() > max_filters) return Status::too_many_filters;
  const std::size_t length = std::strlen(interface_name);
  if (length == 0 || length >= interface_.size()) return Status::no_interface;
  interface_.fill(0);
  std::copy_n(interface_name, length, interface_.begin());
  filter_count_ = filters.size();
  std::transform(filters.begin(), filters.end(), filters_.begin(), [](const Filter& f) {
    const canid_t format = f.extended ? CAN_EFF_FLAG : 0, bits = f.extended ? CAN_EFF_MASK : CAN_SFF_MASK;
    return can_filter{(f.id & bits) | format, (f.mask & bits) | CAN_EFF_FLAG | CAN_RTR_FLAG};
  });
  counters_ = {};
  bus_ = BusState::active;
  dropped_ = 0;
  prepare_batch();
  socket_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (socket_ < 0 || !set_options() || !bind_to_interface()) {
    const int error = errno;
    const bool found = index_ != 0;
    close();
    errno = error;
    return error == ENODEV && found ? Status::not_can : status_of(error);
  }
  link_ = interface_up() ? LinkState::up : LinkState::down;
  return Status::ok;
}

void SocketCan::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  link_ = LinkState::closed;
}

bool SocketCan::set_options() {
  // A classic interface, or a kernel older than CAN FD, refuses frames with more than 8 bytes on sending.
  set_option(socket_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1);
  if (!set_option(socket_, SOL_SOCKET, SO_RCVBUFFORCE, receive_buffer_bytes)) {
    set_option(socket_, SOL_SOCKET, SO_RCVBUF, receive_buffer_bytes);
  }
  const can_err_mask_t all_errors = CAN_ERR_MASK;
  return set_option(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, all_errors) &&
         set_option(socket_, SOL_SOCKET, SO_TIMESTAMPNS, 1) && set_option(socket_, SOL_SOCKET, SO_RXQ_OVFL, 1);
}

/// Also called for a rebind: an interface that is removed takes the socket's filters with it.
bool SocketCan::bind_to_interface() {
  const auto bytes = static_cast<socklen_t>(filter_count_ * sizeof(can_filter));
  if (::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, filters_.data(), bytes) != 0) return false;
  ifreq request = request_for(interface_);
  index_ = 0;
  if (::ioctl(socket_, SIOCGIFINDEX, &request) != 0) return false;
  index_ = request.ifr_ifindex;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index_;
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return false;
  if (interface_up()) return true;
  int notice = 0;  // binding leaves an error if the interface is down; it is known already, so it is cleared
  socklen_t size = sizeof notice;
  return ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &notice, &size) == 0 && (notice == 0 || notice == ENETDOWN);
}

bool SocketCan::interface_up() const {
  ifreq request = request_for(interface_);
  return ::ioctl(socket_, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

void SocketCan::prepare_batch() {
  for (std::size_t i = 0; i < batch; ++i) {
    messages_[i].data = {&messages_[i].frame, sizeof messages_[i].frame};
    headers_[i].msg_hdr.msg_iov = &messages_[i].data;
    headers_[i].msg_hdr.msg_iovlen = 1;
    headers_[i].msg_hdr.msg_control = messages_[i].control.data();
  }
}

int SocketCan::receive(std::span<can::Frame> out, int timeout_ms) {
  if (socket_ < 0 || out.empty()) return 0;
  const std::int64_t deadline_ms = now_ms() + timeout_ms;
  for (;;) {
    const LinkState before = link_;
    if (link_ != LinkState::up) follow_link();
    const int taken = drain(out);
    const std::int64_t left_ms = deadline_ms - now_ms();
    if (taken > 0 || link_ != before || left_ms <= 0) return taken;
    const std::int64_t wait_ms = link_ == LinkState::up ? left_ms : std::min(left_ms, look_again_ms);
    pollfd ready{socket_, POLLIN, 0};
    ::poll(&ready, link_ == LinkState::gone ? 0u : 1u, static_cast<int>(wait_ms));
  }
}

/// Reads in batches until nothing is left or `out` is full. Error messages take no place, so the number of batches is
/// bounded.
int SocketCan::drain(std::span<can::Frame> out) {
  std::size_t taken = 0;
  for (std::size_t reads = 0; taken < out.size() && reads <= out.size() / batch; ++reads) {
    const std::size_t wanted = std::min(out.size() - taken, batch);
    for (std::size_t i = 0; i < wanted; ++i) headers_[i].msg_hdr.msg_controllen = messages_[i].control.size();
    const int got = ::recvmmsg(socket_, headers_.data(), static_cast<unsigned>(wanted), 0, nullptr);
    if (got < 0 && (errno == ENETDOWN || errno == ENODEV)) {
      set_link(errno == ENODEV ? LinkState::gone : LinkState::down);
    }
    for (int i = 0; i < got; ++i) {
      const auto k = static_cast<std::size_t>(i);
      taken += take(headers_[k], messages_[k], out[taken]);
    }
    if (got < static_cast<int>(wanted)) break;
  }
  counters_.frames += taken;
  return static_cast<int>(taken);
}

bool SocketCan::take(const mmsghdr& header, const Message& message, can::Frame& out) {
  std::int64_t time_ns = 0;
  auto* const control = const_cast<msghdr*>(&header.msg_hdr);  // required by CMSG_NXTHDR
  for (cmsghdr* c = CMSG_FIRSTHDR(control); c != nullptr; c = CMSG_NXTHDR(control, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SO_TIMESTAMPNS) {
      timespec time{};
      std::memcpy(&time, CMSG_DATA(c), sizeof time);
      time_ns = ns_of(time);
    } else if (c->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t dropped = 0;
      std::memcpy(&dropped, CMSG_DATA(c), sizeof dropped);
      counters_.frames_lost += dropped - dropped_;  // modulo 2^32
      dropped_ = dropped;
    }
  }
  if ((message.frame.can_id & CAN_ERR_FLAG) != 0) {
    take_error_message(message.frame);
    return false;
  }
  out = to_frame(message.frame, header.msg_len == CANFD_MTU, time_ns);
  return true;
}

void SocketCan::take_error_message(const canfd_frame& frame) {
  ++counters_.error_messages;
  const canid_t what = frame.can_id;
  if ((what & (CAN_ERR_PROT | CAN_ERR_BUSERROR | CAN_ERR_LOSTARB | CAN_ERR_ACK | CAN_ERR_TRX)) != 0)
    ++counters_.bus_errors;
  if ((what & CAN_ERR_CRTL) != 0) {
    const std::uint8_t controller = frame.data[1];
    if ((controller & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) != 0) ++counters_.controller_overruns;
    if ((controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
      ++counters_.times_passive;
      bus_ = BusState::passive;
    } else if ((controller & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
      bus_ = BusState::warning;
    } else if ((controller & CAN_ERR_CRTL_ACTIVE) != 0) {
      bus_ = BusState::active;
    }
  }
  if ((what & CAN_ERR_BUSOFF) != 0) {
    ++counters_.times_bus_off;
    bus_ = BusState::off;
  }
  if ((what & CAN_ERR_RESTARTED) != 0) {
    ++counters_.restarts;
    bus_ = BusState::active;
  }
}

/// The kernel reports when an interface goes, not when it comes.
void SocketCan::follow_link() {
  if (link_ == LinkState::gone && !bind_to_interface()) return;
  if (interface_up()) {
    set_link(LinkState::up);
  } else if (link_ == LinkState::gone) {
    set_link(LinkState::down);
  }
}

void SocketCan::set_link(LinkState state) {
  if (state == link_) return;
  if (state == LinkState::up) {
    ++counters_.times_back;
    bus_ = BusState::active;  // setting an interface up restarts its controller
  }
  if (state == LinkState::down && link_ == LinkState::up) ++counters_.times_down;
  if (state == LinkState::gone) ++counters_.times_gone;
  link_ = state;
}

Status SocketCan::send(const can::Frame& frame) {
  if (socket_ < 0) return Status::not_open;
  Status status = Status::bad_frame;
  if (can::valid(frame) && !frame.error) {
    const canfd_frame out = from_frame(frame);
    status = ::write(socket_, &out, frame.fd ? CANFD_MTU : CAN_MTU) > 0 ? Status::ok : status_of(errno);
  }
  ++(status == Status::ok ? counters_.sent : counters_.not_sent);
  return status;
}

}  // namespace curbline::socketcan
