// Driver for a CAN controller of a Zynq-7000 or Zynq UltraScale+ without an operating system: bus -> XilinxCan ->
// can::TiltDecoder -> TiltTrack.
//
//   XilinxCan bus{MemoryRegisters{0xFF060000}};                   // CAN0; the boot loader sets up its clock and pins
//   const std::array filters{filter_of(signal)};
//   if (bus.open({.clock_hz = 100'000'000}, filters) != Status::ok) ...
//   std::array<can::Frame, 8> frames;
//   const int n = bus.receive(frames, now_ns);
//
// Poll receive() faster than the servo reports. Or call it from the controller's interrupt, which is raised while a
// frame waits; then also call receive({}, now_ns) from the main loop a few times a second, which takes no frame and
// ends bus-off. A frame's time is the one passed to receive(), on the caller's clock; of several frames with the same
// time TiltTrack takes the first. The controller's own stamp is not used: 16 bits of a clock that no laser shares. The
// FIFO holds 64 frames, 3 ms of a full bus at 1 Mbit/s.
//
// No call may interrupt another on the same object. With receive() in the interrupt, the main loop makes all its calls
// on the same core and with that interrupt masked, in a way across which the compiler moves no memory access, such as
// CMSIS's __disable_irq(). With two cores or threads, the caller must provide a lock.
//
// Faults on a bus are counted and survived: an overflow, broken frames, bus-off (the controller is reset and set up
// again after Settings::restart_after_ns). open(), self_test() and a receive() that ends bus-off wait for the
// controller: for each of up to three modes, 100,000 reads of a register at most, some 10 ms. Nothing else waits. No
// heap. Registers is MemoryRegisters, or a test's replacement. Source: UG1085 and UG1087, see registers.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "curbline/can/filter.hpp"
#include "curbline/can/frame.hpp"
#include "xilinx_can/bit_timing.hpp"
#include "xilinx_can/registers.hpp"

namespace curbline::xilinx_can {

enum class Status : std::uint8_t {
  ok,
  bad_bit_rate,      ///< the clock cannot be divided down to it
  too_many_filters,  ///< more than max_filters
  no_answer,         ///< the controller does not change its mode: no clock, or another device
  self_test_failed,  ///< what came back is not what was sent
  queue_full,        ///< nothing can be sent yet: no other node acknowledges, or the bus is busy
  bad_frame,         ///< not a frame of a classic bus
  bus_off,           ///< nothing can be sent until the controller has been restarted
  not_open,
};

struct Settings {
  std::int64_t clock_hz = 0;  ///< of the controller, CAN_REF_CLK
  std::int64_t bits_s = 500'000;
  std::int64_t restart_after_ns = 100'000'000;  ///< duration of bus-off; 0 would disturb a broken bus without pause
};

using can::Filter, can::filter_of;

enum class BusState : std::uint8_t { closed, active, warning, passive, off };

/// These only grow, and wrap around at 2^32. On a healthy bus only `frames` and `sent` do.
struct Counters {
  std::uint32_t frames = 0, sent = 0, not_sent = 0;
  std::uint32_t overflows = 0;   ///< how often the FIFO was found to have lost frames
  std::uint32_t bus_errors = 0;  ///< how often broken or unacknowledged frames were found
  std::uint32_t times_bus_off = 0, restarts = 0;
};

template <typename Registers>
class XilinxCan {
 public:
  static constexpr std::size_t max_filters = 4;

  explicit XilinxCan(Registers registers) : registers_(registers) {}

  /// Sets the controller up and joins the bus. Without a filter every frame is received. May be called again. On
  /// failure the controller is closed: in reset, off the bus, its interrupt off.
  Status open(const Settings& settings, std::span<const Filter> filters);

  /// Sends frames of both kinds to itself, off the bus, and compares what comes back. Afterwards the controller is
  /// closed, as after a failed open().
  Status self_test(const Settings& settings);

  /// Fills `out` from its start with the received frames, oldest first, and returns their number; frames without room
  /// stay for the next call. Also follows the state of the bus: counts errors and ends bus-off.
  int receive(std::span<can::Frame> out, std::int64_t now_ns);

  /// Queues a frame; does not wait.
  Status send(const can::Frame& frame);

  BusState bus() const { return bus_; }
  Counters counters() const { return counters_; }  ///< a copy, so that it can be read after the interrupt is unmasked
  Registers& registers() { return registers_; }

 private:
  static constexpr int patience = 100'000;  ///< in reads of a register

  void reset() { registers_.write(Register::software_reset, bits::reset); }
  void close();
  Status start(std::uint32_t mode);
  bool set_up(std::uint32_t mode);
  bool wait(std::uint32_t status_mask, std::uint32_t wanted) const;
  bool set_filters();
  bool take(can::Frame& frame, std::int64_t now_ns);
  void follow_bus(std::int64_t now_ns);
  Status may_send(const can::Frame& frame) const;
  Status echo(const can::Frame& frame);

  Registers registers_;
  BitTiming timing_{};
  std::int64_t restart_after_ns_ = 0;
  std::array<Filter, max_filters> filters_{};
  std::size_t filter_count_ = 0;
  BusState bus_ = BusState::closed;
  std::int64_t off_since_ns_ = 0;
  Counters counters_{};
};

template <typename Registers>
Status XilinxCan<Registers>::open(const Settings& settings, std::span<const Filter> filters) {
  close();
  if (filters.size() > max_filters) return Status::too_many_filters;
  const std::optional<BitTiming> timing = bit_timing(settings.clock_hz, settings.bits_s);
  if (!timing) return Status::bad_bit_rate;
  timing_ = *timing;
  restart_after_ns_ = settings.restart_after_ns;
  filter_count_ = filters.size();
  std::copy(filters.begin(), filters.end(), filters_.begin());
  return start(0);
}

/// In reset no interrupt is enabled. The interrupt of a closed bus would never end, because receive() no longer removes
/// its cause.
template <typename Registers>
void XilinxCan<Registers>::close() {
  bus_ = BusState::closed;
  reset();
}

/// Enters `mode` from reset; on failure, returns to reset.
template <typename Registers>
Status XilinxCan<Registers>::start(std::uint32_t mode) {
  if (!set_up(mode)) {
    reset();
    return Status::no_answer;
  }
  registers_.write(Register::interrupt_clear, bits::all);
  bus_ = BusState::active;
  return Status::ok;
}

template <typename Registers>
bool XilinxCan<Registers>::set_up(std::uint32_t mode) {
  if (!wait(bits::in_configuration, bits::in_configuration)) return false;
  const BitTiming& t = timing_;
  registers_.write(Register::prescaler, static_cast<std::uint32_t>(t.prescaler - 1));
  registers_.write(Register::bit_timing,
                   static_cast<std::uint32_t>((t.jump - 1) << 7 | (t.segment2 - 1) << 4 | (t.segment1 - 1)));
  registers_.write(Register::mode, mode);
  registers_.write(Register::interrupt_enable, bits::not_empty);
  if (!set_filters()) return false;
  registers_.write(Register::software_reset, bits::enable);
  const std::uint32_t wanted = mode == bits::loopback ? bits::in_loopback : bits::in_normal;
  return wait(wanted, wanted);
}

template <typename Registers>
bool XilinxCan<Registers>::wait(std::uint32_t status_mask, std::uint32_t wanted) const {
  for (int i = 0; i < patience; ++i) {
    if ((registers_.read(Register::status) & status_mask) == wanted) return true;
  }
  return false;
}

/// A filter may be written only while it is off and not in use by the controller.
template <typename Registers>
bool XilinxCan<Registers>::set_filters() {
  registers_.write(Register::filter_enable, 0);
  if (!wait(bits::filters_busy, 0)) return false;
  for (std::size_t i = 0; i < filter_count_; ++i) {
    const Filter& f = filters_[i];
    const std::uint32_t kind =
        bits::extended | (f.extended ? bits::remote : bits::substitute_remote);  // compared in addition to the id
    const std::uint32_t mask = (id_word(f.mask, f.extended, false) & ~bits::substitute_remote) | kind;
    const auto offset = static_cast<std::uint32_t>(8 * i);
    registers_.write(Register{static_cast<std::uint32_t>(Register::filter_mask1) + offset}, mask);
    registers_.write(Register{static_cast<std::uint32_t>(Register::filter_id1) + offset},
                     id_word(f.id, f.extended, false));
  }
  registers_.write(Register::filter_enable, (1u << filter_count_) - 1u);
  return true;
}

template <typename Registers>
int XilinxCan<Registers>::receive(std::span<can::Frame> out, std::int64_t now_ns) {
  if (bus_ == BusState::closed) return 0;
  int n = 0;
  for (can::Frame& frame : out) {
    if (!take(frame, now_ns)) break;
    ++n;
  }
  counters_.frames += static_cast<std::uint32_t>(n);
  follow_bus(now_ns);
  return n;
}

template <typename Registers>
bool XilinxCan<Registers>::take(can::Frame& frame, std::int64_t now_ns) {
  // The flag stays set after the last frame; if cleared, it is set again while the FIFO holds a frame.
  registers_.write(Register::interrupt_clear, bits::not_empty);
  if ((registers_.read(Register::interrupt_status) & bits::not_empty) == 0) return false;
  std::array<std::uint32_t, 4> words;
  constexpr std::array order{Register::rx_id, Register::rx_length, Register::rx_data1, Register::rx_data2};
  for (std::size_t i = 0; i < order.size(); ++i) words[i] = registers_.read(order[i]);
  frame = frame_of(words, now_ns);
  return true;
}

template <typename Registers>
void XilinxCan<Registers>::follow_bus(std::int64_t now_ns) {
  const std::uint32_t happened =
      registers_.read(Register::interrupt_status) & (bits::overflow | bits::error | bits::went_bus_off);
  if (happened != 0) registers_.write(Register::interrupt_clear, happened);
  if ((happened & bits::overflow) != 0) ++counters_.overflows;
  if ((happened & bits::error) != 0) {
    ++counters_.bus_errors;
    registers_.write(Register::error_status, registers_.read(Register::error_status));
  }
  const std::uint32_t status = registers_.read(Register::status);
  const bool off = (status & bits::error_state) == bits::bus_off || (happened & bits::went_bus_off) != 0;
  if (off && bus_ != BusState::off) {
    ++counters_.times_bus_off;
    bus_ = BusState::off;
    off_since_ns_ = now_ns;
  }
  if (bus_ == BusState::off) {
    if (now_ns - off_since_ns_ < restart_after_ns_) return;
    reset();
    if (start(0) == Status::ok) ++counters_.restarts;
    off_since_ns_ = now_ns;
    return;
  }
  const bool passive = (status & bits::error_state) == bits::error_passive;
  bus_ = passive ? BusState::passive : (status & bits::error_warning) != 0 ? BusState::warning : BusState::active;
}

template <typename Registers>
Status XilinxCan<Registers>::may_send(const can::Frame& frame) const {
  if (bus_ == BusState::closed) return Status::not_open;
  if (!can::valid(frame) || frame.error || frame.fd) return Status::bad_frame;
  if (bus_ == BusState::off) return Status::bus_off;
  return (registers_.read(Register::status) & bits::tx_full) != 0 ? Status::queue_full : Status::ok;
}

template <typename Registers>
Status XilinxCan<Registers>::send(const can::Frame& frame) {
  if (const Status status = may_send(frame); status != Status::ok) {
    ++counters_.not_sent;
    return status;
  }
  registers_.write(Register::tx_id, id_word(frame.id, frame.extended, frame.remote));
  registers_.write(Register::tx_length, static_cast<std::uint32_t>(frame.length) << 28);
  registers_.write(Register::tx_data1, data_word(frame, 0));
  registers_.write(Register::tx_data2, data_word(frame, 4));
  ++counters_.sent;
  return Status::ok;
}

template <typename Registers>
Status XilinxCan<Registers>::self_test(const Settings& settings) {
  close();
  const std::optional<BitTiming> timing = bit_timing(settings.clock_hz, settings.bits_s);
  if (!timing) return Status::bad_bit_rate;
  timing_ = *timing;
  filter_count_ = 0;
  Status status = start(bits::loopback);
  for (const bool extended : {false, true}) {
    can::Frame frame;
    frame.id = extended ? 0x15555555u : 0x2AAu;
    frame.extended = extended;
    frame.length = 8;
    for (std::size_t i = 0; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(extended ? 0xA5 + i : 0x5A - i);
    if (status == Status::ok) status = echo(frame);
  }
  close();
  return status;
}

/// Whether the controller receives what it sends.
template <typename Registers>
Status XilinxCan<Registers>::echo(const can::Frame& frame) {
  if (const Status status = send(frame); status != Status::ok) return status;
  can::Frame heard;
  for (int i = 0; i < patience; ++i) {
    if (!take(heard, 0)) continue;
    const bool same = heard.id == frame.id && heard.extended == frame.extended && heard.length == frame.length &&
                      heard.data == frame.data;
    return same ? Status::ok : Status::self_test_failed;
  }
  return Status::self_test_failed;
}

}  // namespace curbline::xilinx_can
