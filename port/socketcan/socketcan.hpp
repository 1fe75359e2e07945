// Raw CAN and CAN FD on Linux: one socket on one interface, which delivers frames in batches with the kernel's time
// stamps. The input of tilt frames: bus -> SocketCan -> can::decode() -> TiltTrack.
//
//   SocketCan bus;
//   const std::array filters{filter_of(signal)};
//   if (bus.open("can0", filters) != Status::ok) ...
//   std::array<can::Frame, 64> frames;
//   const int n = bus.receive(frames, 100);   // waits 100 ms at most
//
// Times are those of reception by the kernel (SO_TIMESTAMPNS) on the system's clock (CLOCK_REALTIME): the clock of
// candump's logs, and of scan lines whose driver uses the same clock. SO_TIMESTAMPING would give the same software
// stamp, or that of the controller, whose clock no laser shares. A time may be slightly earlier than the previous one
// when the kernel's clock is stepped; the tilt track drops and counts such a reading.
//
// Faults on a bus are counted and survived: an interface that is taken down and up, or removed and recreated (the
// socket rebinds itself), bus-off and restarts, frames lost because they were not read in time. Nothing is thrown, the
// heap is not used. Only one thread at a time may call; descriptor() is for poll(2). Cost: two system calls a batch of
// 32 frames. Source: Documentation/networking/can.rst of the kernel, socket(7).
#pragma once

#include <linux/can.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <array>
#include <cstdint>
#include <span>

#include "curbline/can/filter.hpp"
#include "curbline/can/frame.hpp"

namespace curbline::socketcan {

enum class Status : std::uint8_t {
  ok,
  no_can,            ///< this kernel has no CAN
  no_interface,      ///< no interface of that name, or it was removed
  not_can,           ///< the interface is not on a CAN bus
  not_permitted,     ///< the process lacks the permission
  too_many_filters,  ///< more than max_filters
  interface_down,    ///< nothing can be sent
  queue_full,        ///< nothing can be sent yet: the interface's queue is full, or no other node acknowledges
  bad_frame,         ///< this interface cannot carry the frame (CAN FD on a classic one)
  not_open,
  system_error,  ///< none of the above: see errno
};
const char* to_string(Status status);

using can::Filter, can::filter_of;

enum class LinkState : std::uint8_t { closed, up, down, gone };
/// The last state that the controller reported (CAN's fault confinement). A bus without a report is active.
enum class BusState : std::uint8_t { active, warning, passive, off };

/// These only grow, from open() on. On a healthy bus only the first does.
struct Counters {
  std::uint64_t frames = 0;
  std::uint64_t frames_lost = 0;  ///< due to a full receive buffer, as counted by the kernel (SO_RXQ_OVFL)
  std::uint64_t sent = 0, not_sent = 0;
  std::uint32_t error_messages = 0;       ///< error messages of the controller, including:
  std::uint32_t bus_errors = 0;           ///< broken frames, lost arbitration, no acknowledgement
  std::uint32_t controller_overruns = 0;  ///< frames lost in the controller
  std::uint32_t times_passive = 0, times_bus_off = 0, restarts = 0;
  std::uint32_t times_down = 0;  ///< the interface was taken down
  std::uint32_t times_gone = 0;  ///< the interface was removed
  std::uint32_t times_back = 0;  ///< up again after either
};

class SocketCan {
 public:
  static constexpr std::size_t max_filters = 32;
  static constexpr std::size_t batch = 32;

  SocketCan() = default;
  ~SocketCan() { close(); }
  SocketCan(const SocketCan&) = delete;
  SocketCan& operator=(const SocketCan&) = delete;

  /// Opens the interface, which may still be down. Without a filter no frames are received, but the controller's error
  /// messages are. Requests 4 MiB of receive buffer, half a second of a full bus; without CAP_NET_ADMIN the system's
  /// rmem_max may limit it.
  Status open(const char* interface_name, std::span<const Filter> filters);
  void close();

  /// Fills `out` from its start with the received frames, oldest first, and returns their number. Waits for the first
  /// until `timeout_ms` (0: not at all) or until the link's state changes; an interrupted wait (EINTR) is resumed.
  /// Frames sent by this socket are not received. Error messages are counted, not returned. While the interface is
  /// gone, each call looks for it 20 times a second.
  int receive(std::span<can::Frame> out, int timeout_ms);

  /// Passes the frame to the kernel; does not wait.
  Status send(const can::Frame& frame);

  /// For poll(2), POLLIN; then call receive(out, 0). Unchanged until close(). While link() is not `up`, also call
  /// receive() now and then: the descriptor does not become ready when an interface comes back.
  int descriptor() const { return socket_; }
  LinkState link() const { return link_; }
  BusState bus() const { return bus_; }
  const Counters& counters() const { return counters_; }

 private:
  struct Message {  ///< one message of a batch, as recvmmsg(2) requires
    canfd_frame frame;
    iovec data;
    alignas(cmsghdr) std::array<std::byte, 64> control;
  };

  bool set_options();
  bool bind_to_interface();
  bool interface_up() const;
  void prepare_batch();
  int drain(std::span<can::Frame> out);
  bool take(const mmsghdr& header, const Message& message, can::Frame& out);
  void take_error_message(const canfd_frame& frame);
  void follow_link();
  void set_link(LinkState state);

  int socket_ = -1;
  int index_ = 0;                     ///< the interface's index, 0 while it has none
  std::array<char, 16> interface_{};  ///< the interface's name, terminated by 0
  std::array<can_filter, max_filters> filters_{};
  std::size_t filter_count_ = 0;
  LinkState link_ = LinkState::closed;
  BusState bus_ = BusState::active;
  Counters counters_{};
  std::uint32_t dropped_ = 0;  ///< as last reported by the socket
  std::array<mmsghdr, batch> headers_{};
  std::array<Message, batch> messages_{};
};

}  // namespace curbline::socketcan
