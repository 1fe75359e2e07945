// The driver against a controller of software that keeps the manual's rules. The emulated controller has its own tests:
// ctest -L board.
#include "xilinx_can/xilinx_can.hpp"

#include <catch2/catch.hpp>
#include <deque>
#include <vector>

#include "can/servo_presets.hpp"

namespace {

using namespace curbline;
using namespace curbline::xilinx_can;
using Words = std::array<std::uint32_t, 4>;

class Controller {
 public:
  Controller() = default;

  bool dead = false;         ///< it answers nothing but zeros
  bool muted = false;        ///< what is sent stays in the FIFO
  std::uint32_t damage = 0;  ///< of data that comes back
  std::uint32_t prescaler = 0, timing = 0;
  std::vector<Words> sent;

  void arrive(const can::Frame& frame) {
    take({id_word(frame.id, frame.extended, frame.remote), static_cast<std::uint32_t>(frame.length) << 28,
          data_word(frame, 0), data_word(frame, 4)});
  }
  void go_bus_off() {
    error_state_ = bits::bus_off;
    interrupts_ |= bits::went_bus_off | bits::error;
  }
  void become(std::uint32_t state) { error_state_ = state; }
  int resets() const { return resets_; }

  std::uint32_t read(Register r) {
    if (dead) return 0;
    switch (r) {
      case Register::status:
        return status();
      case Register::interrupt_status:
        return interrupts_ | (fifo_.empty() ? 0 : bits::not_empty);
      case Register::rx_id:
        return fifo_.front()[0];
      case Register::rx_length:
        return fifo_.front()[1];
      case Register::rx_data1:
        return fifo_.front()[2];
      case Register::rx_data2:
        return pop();
      default:
        return 0;
    }
  }

  void write(Register r, std::uint32_t value) {
    switch (r) {
      case Register::software_reset:
        return reset(value);
      case Register::mode:
        mode_ = value;
        return;
      case Register::prescaler:
        REQUIRE(!enabled_);
        prescaler = value;
        return;
      case Register::bit_timing:
        REQUIRE(!enabled_);
        timing = value;
        return;
      case Register::interrupt_clear:
        interrupts_ &= ~value;
        return;
      case Register::tx_id:
        tx_[0] = value;
        return;
      case Register::tx_length:
        tx_[1] = value;
        return;
      case Register::tx_data1:
        tx_[2] = value;
        return;
      case Register::tx_data2:
        tx_[3] = value;
        return transmit();
      case Register::filter_enable:
        filters_on_ = value;
        return;
      default:
        return write_filter(static_cast<std::uint32_t>(r), value);
    }
  }

 private:
  static constexpr std::size_t depth = 64;

  std::uint32_t status() const {
    if (!enabled_) return bits::in_configuration;
    return (mode_ == bits::loopback ? bits::in_loopback : bits::in_normal) | error_state_ |
           (muted && sent.size() >= depth ? bits::tx_full : 0);
  }
  void reset(std::uint32_t value) {
    enabled_ = (value & bits::enable) != 0;
    if ((value & bits::reset) == 0) return;
    ++resets_;
    *this = Controller{*this, resets_};
  }
  Controller(const Controller& before, int resets)
      : dead(before.dead), muted(before.muted), damage(before.damage), sent(before.sent), resets_(resets) {}
  void transmit() {
    REQUIRE((enabled_ && error_state_ != bits::bus_off));
    sent.push_back(tx_);
    Words heard = tx_;
    heard[2] ^= damage;
    if (mode_ == bits::loopback && !muted) take(heard);
  }
  std::uint32_t pop() {
    const std::uint32_t last = fifo_.front()[3];
    fifo_.pop_front();
    return last;
  }
  void write_filter(std::uint32_t offset, std::uint32_t value) {
    if (offset < static_cast<std::uint32_t>(Register::filter_mask1)) return;
    const std::uint32_t at = offset - static_cast<std::uint32_t>(Register::filter_mask1);
    REQUIRE(at < 32);
    REQUIRE((filters_on_ >> at / 8 & 1) == 0);
    filters_[at / 4] = value;
  }
  void take(const Words& frame) {
    bool wanted = filters_on_ == 0;
    for (std::size_t f = 0; f < 4; ++f) {
      wanted = wanted || ((filters_on_ >> f & 1) != 0 && ((frame[0] ^ filters_[2 * f + 1]) & filters_[2 * f]) == 0);
    }
    if (!wanted) return;
    if (fifo_.size() == depth) {
      interrupts_ |= bits::overflow;
      return;
    }
    fifo_.push_back(frame);
  }

  std::uint32_t mode_ = 0, filters_on_ = 0, interrupts_ = 0, error_state_ = bits::error_active;
  bool enabled_ = false;
  Words tx_{};
  std::array<std::uint32_t, 8> filters_{};
  std::deque<Words> fifo_;
  int resets_ = 0;
};

struct Wire {
  Controller* controller;
  std::uint32_t read(Register r) const { return controller->read(r); }
  void write(Register r, std::uint32_t value) { controller->write(r, value); }
};

struct Bench {
  Controller controller;
  XilinxCan<Wire> bus{Wire{&controller}};
  Settings settings{.clock_hz = 100'000'000};
  std::array<can::Frame, 8> frames{};
};

can::Frame frame_of_id(std::uint32_t id, bool extended = false) {
  can::Frame frame;
  frame.id = id;
  frame.extended = extended;
  frame.length = 5;
  for (std::size_t i = 0; i < 5; ++i) frame.data[i] = static_cast<std::uint8_t>(0x10 * i + 1);
  return frame;
}

}  // namespace

TEST_CASE("xilinx_can: bit rates are exact and sampled near seven eighths") {
  for (const std::int64_t clock_hz : {24'000'000, 80'000'000, 100'000'000}) {
    for (const std::int64_t rate : {125'000, 250'000, 500'000, 1'000'000}) {
      const auto t = bit_timing(clock_hz, rate);
      REQUIRE(t);
      const int quanta = 1 + t->segment1 + t->segment2;
      CHECK(clock_hz == rate * t->prescaler * quanta);
      CHECK(static_cast<double>(1 + t->segment1) / quanta == Approx(0.875).margin(0.026));
      CHECK((t->segment1 >= 1 && t->segment1 <= 16 && t->segment2 >= 1 && t->segment2 <= 8 && t->jump <= t->segment2));
    }
  }
  CHECK_FALSE(bit_timing(100'000'000, 300'000));
  CHECK_FALSE(bit_timing(0, 500'000));
}

TEST_CASE("xilinx_can: the timing is written one less, as the registers want it") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  CHECK(b.controller.prescaler == 24);  // 100 MHz / 25 / 8 quanta
  CHECK(b.controller.timing == (0u << 7 | 0u << 4 | 5u));
}

TEST_CASE("xilinx_can: a frame comes out as it came in, of both kinds, with the time of the call") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  for (const can::Frame& frame : {frame_of_id(0x181), frame_of_id(0x12345678, true)}) {
    b.controller.arrive(frame);
    REQUIRE(b.bus.receive(b.frames, 42) == 1);
    CHECK(b.frames[0].time_ns == 42);
    CHECK(b.frames[0].id == frame.id);
    CHECK(b.frames[0].extended == frame.extended);
    CHECK(b.frames[0].length == frame.length);
    CHECK(b.frames[0].data == frame.data);
  }
  CHECK(b.bus.receive(b.frames, 43) == 0);
}

TEST_CASE("xilinx_can: what is sent has the register's layout") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  REQUIRE(b.bus.send(frame_of_id(0x181)) == Status::ok);
  CHECK(b.controller.sent.back() == Words{0x181u << 21, 5u << 28, 0x01112131, 0x41000000});
  REQUIRE(b.bus.send(frame_of_id(0x1FFFFFFF, true)) == Status::ok);
  CHECK(b.controller.sent.back()[0] == 0xFFFFFFFE);
  CHECK(b.bus.send(frame_of_id(0x800)) == Status::bad_frame);
  can::Frame fd = frame_of_id(1);
  fd.fd = true;
  CHECK(b.bus.send(fd) == Status::bad_frame);
  CHECK(b.bus.counters().not_sent == 2);
}

TEST_CASE("xilinx_can: filters let through their ids of their kind, and no remote request") {
  Bench b;
  const std::array filters{filter_of(can::cia402_position(1)), Filter{0x100, 0x700, false},
                           Filter{0x1ABCDE00, 0x1FFFFF00, true}};
  REQUIRE(b.bus.open(b.settings, filters) == Status::ok);
  can::Frame remote = frame_of_id(0x181);
  remote.remote = true;
  can::Frame remote_extended = frame_of_id(0x1ABCDE01, true);
  remote_extended.remote = true;
  for (const can::Frame& f : {frame_of_id(0x181), frame_of_id(0x1FF), frame_of_id(0x1ABCDE42, true), frame_of_id(0x281),
                              frame_of_id(0x181, true), frame_of_id(0x1ABCDF42, true), remote, remote_extended}) {
    b.controller.arrive(f);
  }
  REQUIRE(b.bus.receive(b.frames, 0) == 3);
  CHECK(b.frames[0].id == 0x181);
  CHECK(b.frames[1].id == 0x1FF);
  CHECK(b.frames[2].id == 0x1ABCDE42);
  const std::array<Filter, 5> too_many{};
  CHECK(b.bus.open(b.settings, too_many) == Status::too_many_filters);
}

TEST_CASE("xilinx_can: what has no room in the caller's span stays for the next call") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  for (std::uint32_t id = 0; id < 20; ++id) b.controller.arrive(frame_of_id(id));
  std::uint32_t next = 0;
  for (const int expected : {8, 8, 4, 0}) {
    REQUIRE(b.bus.receive(b.frames, 0) == expected);
    for (int i = 0; i < expected; ++i) CHECK(b.frames[static_cast<std::size_t>(i)].id == next++);
  }
}

TEST_CASE("xilinx_can: an overflow is counted, and the frames that were kept still come") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  for (std::uint32_t id = 0; id < 70; ++id) b.controller.arrive(frame_of_id(id));
  int got = 0;
  while (const int n = b.bus.receive(b.frames, 0)) got += n;
  CHECK(got == 64);
  CHECK(b.bus.counters().overflows == 1);
  b.controller.arrive(frame_of_id(1));
  CHECK(b.bus.receive(b.frames, 0) == 1);
}

TEST_CASE(
    "xilinx_can: after bus-off the controller is set up anew, not before its time, and hears again through its "
    "filters") {
  Bench b;
  const std::array filters{Filter{0x181, 0x7FF, false}};
  REQUIRE(b.bus.open(b.settings, filters) == Status::ok);
  b.controller.go_bus_off();
  b.bus.receive(b.frames, 1'000);
  CHECK(b.bus.bus() == BusState::off);
  CHECK(b.bus.send(frame_of_id(0x181)) == Status::bus_off);
  b.bus.receive(b.frames, 99'000'000);
  CHECK(b.bus.bus() == BusState::off);
  CHECK(b.controller.resets() == 1);
  b.bus.receive(b.frames, 100'001'000);
  CHECK(b.bus.bus() == BusState::active);
  CHECK(b.bus.counters().times_bus_off == 1);
  CHECK(b.bus.counters().restarts == 1);
  b.controller.arrive(frame_of_id(0x182));
  b.controller.arrive(frame_of_id(0x181));
  CHECK(b.bus.receive(b.frames, 100'002'000) == 1);
}

TEST_CASE("xilinx_can: a controller that is dead at bus-off is tried again and again, once each time") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.go_bus_off();
  b.bus.receive(b.frames, 0);
  b.controller.dead = true;
  b.bus.receive(b.frames, 100'000'000);
  CHECK(b.bus.bus() == BusState::off);
  b.controller.dead = false;
  b.bus.receive(b.frames, 150'000'000);
  CHECK(b.bus.bus() == BusState::off);
  b.bus.receive(b.frames, 200'000'000);
  CHECK(b.bus.bus() == BusState::active);
}

TEST_CASE("xilinx_can: the bus's state follows the controller's") {
  Bench b;
  CHECK(b.bus.bus() == BusState::closed);
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.become(bits::error_active | bits::error_warning);
  b.bus.receive(b.frames, 0);
  CHECK(b.bus.bus() == BusState::warning);
  b.controller.become(bits::error_passive);
  b.bus.receive(b.frames, 0);
  CHECK(b.bus.bus() == BusState::passive);
}

TEST_CASE("xilinx_can: the self-test passes in order, and fails for damage, for silence and for no controller") {
  Bench b;
  CHECK(b.bus.self_test(b.settings) == Status::ok);
  CHECK(b.bus.bus() == BusState::closed);
  b.controller.damage = 0x00010000;
  CHECK(b.bus.self_test(b.settings) == Status::self_test_failed);
  b.controller.damage = 0;
  b.controller.muted = true;
  CHECK(b.bus.self_test(b.settings) == Status::self_test_failed);
  b.controller.dead = true;
  CHECK(b.bus.self_test(b.settings) == Status::no_answer);
  CHECK(b.bus.open(b.settings, {}) == Status::no_answer);
  CHECK(b.bus.send(frame_of_id(1)) == Status::not_open);
}

TEST_CASE("xilinx_can: a full queue refuses, and says so") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.muted = true;
  for (int i = 0; i < 64; ++i) REQUIRE(b.bus.send(frame_of_id(1)) == Status::ok);
  CHECK(b.bus.send(frame_of_id(1)) == Status::queue_full);
}
