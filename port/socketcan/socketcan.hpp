// Raw CAN and CAN FD on Linux: one socket on one interface, from which frames come in batches with the kernel's own
// time. The way in of tilt frames: bus -> SocketCan -> can::decode() -> TiltTrack.
//
//   SocketCan bus;
//   const std::array filters{filter_of(signal)};
//   if (bus.open("can0", filters) != Status::ok) ...
//   std::array<can::Frame, 64> frames;
//   const int n = bus.receive(frames, 100);   // waits 100 ms at most
//
// Times are those at which the kernel took the frame in (SO_TIMESTAMPNS), on the system's clock (CLOCK_REALTIME): the
// clock of candump's logs, and of scan lines whose driver asks the same clock. SO_TIMESTAMPING would give the same
// software stamp, or the controller's, which counts on a clock of its own that no laser shares. A time may be a little
// earlier than the one before where the kernel's clock is stepped; the tilt track drops such a reading and counts it.
//
// What goes wrong on a bus is counted and survived: an interface that is taken down and up, or removed and made anew
// (the socket binds itself again), bus-off and its restarts, frames that were lost because nobody read them. Nothing is
// thrown, the heap is not used. One thread at a time calls; descriptor() is for poll(2). Cost: two system calls a batch
// of 32 frames. Source: Documentation/networking/can.rst of the kernel, socket(7).
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
  no_interface,      ///< none of that name, or it went away
  not_can,           ///< the interface is none of a CAN bus
  not_permitted,     ///< the process may not
  too_many_filters,  ///< more than max_filters
  interface_down,    ///< nothing can be sent
  queue_full,        ///< nothing can be sent yet: the interface's queue, or no other node acknowledges
  bad_frame,         ///< no frame that this interface carries (CAN FD on a classic one)
  not_open,
  system_error,  ///< none of the above: see errno
};
const char* to_string(Status status);

using can::Filter, can::filter_of;

enum class LinkState : std::uint8_t { closed, up, down, gone };
/// What the controller last said of itself (CAN's fault confinement). A bus that never complained is active.
enum class BusState : std::uint8_t { active, warning, passive, off };

/// Everything only grows, from open() on. A healthy bus sees nothing but the first.
struct Counters {
  std::uint64_t frames = 0;
  std::uint64_t frames_lost = 0;  ///< by a full receive buffer, as the kernel counts them (SO_RXQ_OVFL)
  std::uint64_t sent = 0, not_sent = 0;
  std::uint32_t error_messages = 0;       ///< of the controller, these among them:
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

  /// Opens the interface; it may be down yet. Without a filter no frame comes in, but the controller's error messages
  /// do. Asks for 4 MiB of receive buffer, half a second of a full bus; without CAP_NET_ADMIN the system's rmem_max may
  /// give less.
  Status open(const char* interface_name, std::span<const Filter> filters);
  void close();

  /// Fills `out` from its start with the frames that have come, oldest first, and returns how many. Waits for the first
  /// until `timeout_ms` (0: not at all) or until the link's state changes; an interrupted wait (EINTR) goes on. Frames
  /// sent by this socket do not come back. Error messages are counted, not given out. While the interface is gone, each
  /// call looks for it 20 times a second.
  int receive(std::span<can::Frame> out, int timeout_ms);

  /// Hands the frame to the kernel; does not wait.
  Status send(const can::Frame& frame);

  /// For poll(2), POLLIN; then receive(out, 0). The same until close(). While link() is not `up`, call receive() now
  /// and then all the same: a descriptor says nothing of an interface that comes back.
  int descriptor() const { return socket_; }
  LinkState link() const { return link_; }
  BusState bus() const { return bus_; }
  const Counters& counters() const { return counters_; }

 private:
  struct Message {  ///< one of a batch, as recvmmsg(2) wants it
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
  int index_ = 0;                     ///< the interface's, 0 while it has none
  std::array<char, 16> interface_{};  ///< its name, ended by 0
  std::array<can_filter, max_filters> filters_{};
  std::size_t filter_count_ = 0;
  LinkState link_ = LinkState::closed;
  BusState bus_ = BusState::active;
  Counters counters_{};
  std::uint32_t dropped_ = 0;  ///< as the socket last said
  std::array<mmsghdr, batch> headers_{};
  std::array<Message, batch> messages_{};
};

}  // namespace curbline::socketcan
