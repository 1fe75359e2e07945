// The driver against a software model of the controller that follows the manual's rules. Registers, bits and frames are
// numbers from UG1087, never the driver's names for them, so that a slip in registers.hpp shows. The emulated
// controller has its own tests: ctest -L board. This is one long file because only these tests use the model.
#include "xilinx_can/xilinx_can.hpp"

#include <catch2/catch.hpp>
#include <deque>
#include <utility>
#include <vector>

#include "curbline/can/servo_presets.hpp"

namespace {

using namespace curbline;
using namespace curbline::xilinx_can;
using Words = std::array<std::uint32_t, 4>;  // a frame: id, length, data

class Controller {
 public:
  bool dead = false;                ///< reads of all registers return zero
  bool muted = false;               ///< frames to send stay in the FIFO
  bool never_joins = false;         ///< the bus is never quiet: it stays between configuration and normal mode
  bool filters_stay_busy = false;   ///< the filters never become writable
  bool joins_amid_a_frame = false;  ///< it hears the rest of the frame, broken
  Words damage{};                   ///< bits that are flipped in echoed frames
  int echo_after = 0;               ///< number of looks at the interrupt flags until the echo arrives
  std::vector<Words> sent;
  std::uint32_t flags_after_look = 0;  ///< set as soon as the driver has read the interrupt flags
  int resets = 0, status_reads = 0;

  void arrive(const Words& frame) {
    if (core_.enabled) take(frame);
  }
  void break_frame() {
    core_.error_status |= 0x02;  // FMER
    core_.interrupts |= 0x100;   // ERROR
  }
  void flag_bus_off() { core_.interrupts |= 0x200; }  // BSOFF
  void become(std::uint32_t error_state) { core_.error_state = error_state; }

  bool line() const { return (core_.interrupts & core_.interrupt_enable) != 0; }
  bool in_reset() const { return !core_.enabled && core_.interrupt_enable == 0; }
  bool remembers_errors() const { return core_.error_status != 0; }
  std::uint32_t prescaler() const { return core_.prescaler; }
  std::uint32_t timing() const { return core_.timing; }

  std::uint32_t read(Register r) {
    if (dead) return 0;
    const auto offset = static_cast<std::uint32_t>(r);
    switch (offset) {
      case 0x14:
        return core_.error_status;
      case 0x18:
        return status();
      case 0x1C:
        if (echo_left_ > 0 && --echo_left_ == 0) take(echo_);
        return std::exchange(core_.interrupts, core_.interrupts | std::exchange(flags_after_look, 0u));
      case 0x50:
      case 0x54:
      case 0x58:
      case 0x5C:
        return read_word((offset - 0x50) / 4);
      default:
        FAIL("nothing to read at " << offset);
        return 0;
    }
  }

  void write(Register r, std::uint32_t value) {
    if (dead) return;
    const auto offset = static_cast<std::uint32_t>(r);
    switch (offset) {
      case 0x00:
        return reset_or_enable(value);
      case 0x04:
        return configure(core_.mode, value);
      case 0x08:
        return configure(core_.prescaler, value);
      case 0x0C:
        return configure(core_.timing, value);
      case 0x14:
        core_.error_status &= ~value;
        return;
      case 0x20:
        core_.interrupt_enable = value;
        return;
      case 0x24:
        core_.interrupts &= ~value;
        if (!core_.fifo.empty()) core_.interrupts |= 0x80;  // RXNEMP
        return;
      case 0x30:
      case 0x34:
      case 0x38:
      case 0x3C:
        return write_word((offset - 0x30) / 4, value);
      case 0x60:
        filters_on_ = value;
        busy_ = lag;
        return;
      default:
        return write_filter(offset, value);
    }
  }

 private:
  static constexpr std::size_t depth = 64;
  static constexpr int lag = 3;  // reads of the status before a change shows in it

  /// State that a reset restores. TX FIFO empty is flagged from the start.
  struct Core {
    bool enabled = false;
    std::uint32_t mode = 0, prescaler = 0, timing = 0, error_status = 0, interrupts = 0x6000, interrupt_enable = 0;
    std::uint32_t error_state = 0x080;  // error active
    std::deque<Words> fifo;
    std::size_t next_read = 0, next_written = 0;
    Words tx{};
  };

  bool settled() const { return settling_ == 0 && !(core_.enabled && never_joins); }
  std::uint32_t status() {
    ++status_reads;
    if (settling_ > 0) --settling_;
    if (busy_ > 0) --busy_;
    const std::uint32_t busy = busy_ > 0 || filters_stay_busy ? 0x800 : 0;  // ACFBSY
    if (!settled()) return busy;
    if (!core_.enabled) return busy | 0x01;                       // CONFIG
    const std::uint32_t mode = core_.mode == 0x02 ? 0x02 : 0x08;  // LBACK, NORMAL
    const bool full = muted && sent.size() >= depth;
    return busy | mode | core_.error_state | (full ? 0x400 : 0);  // TXFLL
  }
  void reset_or_enable(std::uint32_t value) {
    REQUIRE(value <= 2);
    settling_ = lag;
    if (value == 1) {
      core_ = Core{};
      ++resets;
    }
    core_.enabled = value == 2;
    if (core_.enabled && joins_amid_a_frame) break_frame();
  }
  void configure(std::uint32_t& what, std::uint32_t value) {
    REQUIRE((!core_.enabled && settled()));
    what = value;
  }
  void write_word(std::size_t word, std::uint32_t value) {
    REQUIRE((core_.enabled && settled() && (core_.error_state & 0x180) != 0x100));
    REQUIRE(word == core_.next_written);
    core_.next_written = (word + 1) % 4;
    core_.tx[word] = value;
    if (word < 3) return;
    sent.push_back(core_.tx);
    if (muted) return;
    core_.interrupts |= 0x02;  // TXOK
    Words heard = core_.tx;
    for (std::size_t i = 0; i < 4; ++i) heard[i] ^= damage[i];
    if (core_.mode != 0x02) return;
    echo_ = heard;
    echo_left_ = echo_after;
    if (echo_after == 0) take(heard);
  }
  std::uint32_t read_word(std::size_t word) {
    REQUIRE(!core_.fifo.empty());
    REQUIRE(word == core_.next_read);
    core_.next_read = (word + 1) % 4;
    const std::uint32_t value = core_.fifo.front()[word];
    if (word == 3) core_.fifo.pop_front();
    return value;
  }
  /// Filters survive a reset, as in QEMU, so the driver must not rely on their being off.
  void write_filter(std::uint32_t offset, std::uint32_t value) {
    REQUIRE((offset >= 0x64 && offset <= 0x80));
    REQUIRE((busy_ == 0 && !filters_stay_busy));
    const std::uint32_t at = offset - 0x64;
    REQUIRE((filters_on_ >> at / 8 & 1) == 0);
    filters_[at / 4] = value;
  }
  void take(Words frame) {
    bool wanted = filters_on_ == 0;
    for (std::size_t f = 0; f < 4; ++f) {
      wanted = wanted || ((filters_on_ >> f & 1) != 0 && ((frame[0] ^ filters_[2 * f + 1]) & filters_[2 * f]) == 0);
    }
    if (!wanted) return;
    if (core_.fifo.size() == depth) {
      core_.interrupts |= 0x40;  // RXOFLW
      return;
    }
    frame[1] |= 0xBEEF;  // the controller's timestamp, beside the length
    core_.fifo.push_back(frame);
    core_.interrupts |= 0x90;  // RXNEMP, which stays until it is cleared; RXOK
  }

  Core core_;
  std::uint32_t filters_on_ = 0;
  std::array<std::uint32_t, 8> filters_{};  // mask and id of each
  int settling_ = 0, busy_ = 0;
  Words echo_{};
  int echo_left_ = 0;
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

  /// Joins the bus and goes bus-off at time 0.
  void go_off() {
    REQUIRE(bus.open(settings, {}) == Status::ok);
    controller.become(0x100);
    bus.receive(frames, 0);
  }
};

constexpr std::uint32_t standard_request = 1u << 20, extended_request = 1u << 0;  // in the first word

/// Five bytes: 01 11 21 31 41.
Words standard(std::uint32_t id) {
  return {id << 21, 0x50000000, 0x01112131, 0x41000000};
}
Words extended(std::uint32_t id) {
  return {(id >> 18) << 21 | 0x00180000 | (id & 0x3FFFF) << 1, 0x50000000, 0x01112131, 0x41000000};
}
Words request(Words frame, std::uint32_t bit) {
  frame[0] |= bit;
  return frame;
}

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
  CHECK(b.controller.prescaler() == 24);  // 100 MHz / 25 / (1 + 6 + 1 quanta), jump 1
  CHECK(b.controller.timing() == (0u << 7 | 0u << 4 | 5u));
  b.settings.clock_hz = 80'000'000;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  CHECK(b.controller.prescaler() == 9);  // 80 MHz / 10 / (1 + 13 + 2 quanta), jump 2
  CHECK(b.controller.timing() == (1u << 7 | 1u << 4 | 12u));
  REQUIRE(b.bus.open({.clock_hz = 25'000'000, .bits_s = 1'000'000}, {}) == Status::ok);
  CHECK(b.controller.prescaler() == 0);  // 25 MHz / 1 / (1 + 16 + 8 quanta), jump 4, the most that there is
  CHECK(b.controller.timing() == (3u << 7 | 7u << 4 | 15u));
}

TEST_CASE("xilinx_can: a frame comes out as it came in, of both kinds, with the time of the call") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.arrive({0x30200000, 0x50000000, 0x01112131, 0x41000000});
  b.controller.arrive({0x91B8ACF0, 0x50000000, 0x01112131, 0x41000000});
  REQUIRE(b.bus.receive(b.frames, 42) == 2);
  CHECK(b.frames[0].id == 0x181);
  CHECK(b.frames[1].id == 0x12345678);
  for (const std::size_t i : {0u, 1u}) {
    CHECK(b.frames[i].time_ns == 42);
    CHECK(b.frames[i].extended == (i == 1));
    CHECK_FALSE(b.frames[i].remote);
    CHECK(b.frames[i].length == 5);
    CHECK(b.frames[i].data == frame_of_id(0).data);
  }
  CHECK(b.bus.receive(b.frames, 43) == 0);
  CHECK(b.bus.counters().frames == 2);
}

TEST_CASE("xilinx_can: a remote request comes out as one, without data") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.arrive(request(standard(0x181), standard_request));
  b.controller.arrive(request(extended(0x12345678), extended_request));
  REQUIRE(b.bus.receive(b.frames, 0) == 2);
  for (const std::size_t i : {0u, 1u}) {
    CHECK(b.frames[i].remote);
    CHECK(b.frames[i].length == 5);
    CHECK(b.frames[i].data == can::Frame{}.data);
  }
}

TEST_CASE("xilinx_can: a length code beyond 8 is eight bytes") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  for (const std::uint32_t code : {8u, 9u, 15u}) {
    b.controller.arrive({0x30200000, code << 28, 0x01020304, 0x05060708});
    REQUIRE(b.bus.receive(b.frames, 0) == 1);
    CHECK(b.frames[0].length == 8);
    for (std::size_t i = 0; i < b.frames[0].data.size(); ++i) CHECK(b.frames[0].data[i] == (i < 8 ? i + 1 : 0));
  }
}

TEST_CASE("xilinx_can: what is sent has the register's layout") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  REQUIRE(b.bus.send(frame_of_id(0x181)) == Status::ok);
  CHECK(b.controller.sent.back() == Words{0x30200000, 0x50000000, 0x01112131, 0x41000000});
  REQUIRE(b.bus.send(frame_of_id(0x12345678, true)) == Status::ok);
  CHECK(b.controller.sent.back() == Words{0x91B8ACF0, 0x50000000, 0x01112131, 0x41000000});
  for (const bool is_extended : {false, true}) {
    can::Frame remote = frame_of_id(0x181, is_extended);
    remote.remote = true;
    REQUIRE(b.bus.send(remote) == Status::ok);
    CHECK(b.controller.sent.back()[0] == (is_extended ? 0x00180303 : 0x30300000));
  }
  CHECK(b.bus.counters().sent == 4);
}

TEST_CASE("xilinx_can: what no classic bus carries is refused and counted") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  std::array<can::Frame, 5> bad;
  bad[0] = frame_of_id(0x800);
  bad[1] = frame_of_id(0x20000000, true);
  bad[2].length = 9;
  bad[3].fd = true;
  bad[4].error = true;
  for (const can::Frame& frame : bad) CHECK(b.bus.send(frame) == Status::bad_frame);
  CHECK(b.controller.sent.empty());
  CHECK(b.bus.counters().not_sent == 5);
  CHECK(b.bus.counters().sent == 0);
}

TEST_CASE("xilinx_can: the interrupt's line is up while a frame waits, and falls when all are taken") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  CHECK_FALSE(b.controller.line());
  for (std::uint32_t id = 0; id < 20; ++id) b.controller.arrive(standard(id));
  int calls = 0;
  while (b.controller.line() && ++calls < 10) b.bus.receive(b.frames, 0);
  CHECK(calls == 3);  // 8, 8 and 4 frames
  CHECK(b.bus.counters().frames == 20);
}

TEST_CASE("xilinx_can: errors of the bus and bus-off do not interrupt, receive() finds them") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.break_frame();
  b.controller.flag_bus_off();
  REQUIRE(b.bus.send(frame_of_id(0x181)) == Status::ok);
  CHECK_FALSE(b.controller.line());
}

TEST_CASE("xilinx_can: beside an interrupt that takes the frames, the main loop ends bus-off and takes none") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  const Counters& before = b.bus.counters();
  b.controller.arrive(standard(1));
  CHECK(b.bus.receive({}, 0) == 0);
  CHECK(b.controller.line());
  CHECK(b.bus.receive(b.frames, 0) == 1);
  CHECK(before.frames == 0);  // what main reads no longer changes during its access
  b.controller.become(0x100);
  b.bus.receive({}, 0);
  b.bus.receive({}, 100'000'000);
  CHECK(b.bus.bus() == BusState::active);
}

TEST_CASE("xilinx_can: filters let through their ids of their kind, and no remote request") {
  Bench b;
  const std::array filters{filter_of(can::cia402_position(1)), Filter{0x100, 0x700, false},
                           Filter{0x1ABCDE00, 0x1FFFFF00, true}};
  REQUIRE(b.bus.open(b.settings, filters) == Status::ok);
  for (const Words& frame :
       {standard(0x181), standard(0x1FF), extended(0x1ABCDE42), standard(0x281), extended(0x181), extended(0x1ABCDF42),
        request(standard(0x181), standard_request), request(extended(0x1ABCDE01), extended_request)}) {
    b.controller.arrive(frame);
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
  for (std::uint32_t id = 0; id < 20; ++id) b.controller.arrive(standard(id));
  std::uint32_t next = 0;
  for (const int expected : {8, 8, 4, 0}) {
    REQUIRE(b.bus.receive(b.frames, 0) == expected);
    for (int i = 0; i < expected; ++i) CHECK(b.frames[static_cast<std::size_t>(i)].id == next++);
  }
}

TEST_CASE("xilinx_can: an overflow is counted, and the frames that were kept still come") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  for (std::uint32_t id = 0; id < 70; ++id) b.controller.arrive(standard(id));
  int got = 0;
  while (const int n = b.bus.receive(b.frames, 0)) got += n;
  CHECK(got == 64);
  CHECK(b.bus.counters().overflows == 1);
  b.controller.arrive(standard(1));
  CHECK(b.bus.receive(b.frames, 0) == 1);
}

TEST_CASE("xilinx_can: a broken frame is counted once") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.break_frame();
  b.bus.receive(b.frames, 0);
  b.bus.receive(b.frames, 0);
  CHECK(b.bus.counters().bus_errors == 1);
  CHECK_FALSE(b.controller.remembers_errors());
}

TEST_CASE("xilinx_can: what happens while the driver looks is counted at its next look") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.break_frame();
  b.controller.flags_after_look = 0x40;  // RXOFLW
  b.bus.receive({}, 0);
  CHECK(b.bus.counters().overflows == 0);
  b.bus.receive({}, 0);
  CHECK(b.bus.counters().overflows == 1);
}

TEST_CASE("xilinx_can: a frame that was under way when the bus was joined is no error of the bus") {
  Bench b;
  b.controller.joins_amid_a_frame = true;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.bus.receive(b.frames, 0);
  CHECK(b.bus.counters().bus_errors == 0);
}

TEST_CASE(
    "xilinx_can: after bus-off the controller is set up anew, not before its time, and hears again through its "
    "filters") {
  Bench b;
  const std::array filters{Filter{0x181, 0x7FF, false}};
  const std::int64_t off_ns = 7'000'000'000;
  REQUIRE(b.bus.open(b.settings, filters) == Status::ok);
  b.controller.become(0x100);
  b.bus.receive(b.frames, off_ns);
  CHECK(b.bus.bus() == BusState::off);
  CHECK(b.bus.send(frame_of_id(0x181)) == Status::bus_off);
  b.bus.receive(b.frames, off_ns + 99'000'000);
  CHECK(b.bus.bus() == BusState::off);
  CHECK(b.controller.resets == 1);
  b.bus.receive(b.frames, off_ns + 100'000'000);
  CHECK(b.bus.bus() == BusState::active);
  CHECK(b.bus.counters().times_bus_off == 1);
  CHECK(b.bus.counters().restarts == 1);
  b.controller.arrive(standard(0x182));
  b.controller.arrive(standard(0x181));
  CHECK(b.bus.receive(b.frames, off_ns + 100'001'000) == 1);
}

TEST_CASE("xilinx_can: a bus-off counts even if the controller has recovered by itself") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.flag_bus_off();
  b.bus.receive(b.frames, 0);
  b.bus.receive(b.frames, 1);
  CHECK(b.bus.bus() == BusState::off);
  CHECK(b.bus.counters().times_bus_off == 1);
}

TEST_CASE("xilinx_can: a controller that is dead at bus-off is tried again and again, once each time") {
  Bench b;
  b.go_off();
  b.controller.dead = true;
  b.bus.receive(b.frames, 100'000'000);
  CHECK(b.bus.bus() == BusState::off);
  b.controller.dead = false;
  b.bus.receive(b.frames, 150'000'000);
  CHECK(b.bus.bus() == BusState::off);
  b.bus.receive(b.frames, 200'000'000);
  CHECK(b.bus.bus() == BusState::active);
}

TEST_CASE("xilinx_can: a controller that never answers is left in reset, its interrupt off") {
  Bench b;
  SECTION("it does not join the bus") {
    b.controller.never_joins = true;
  }
  SECTION("it does not let go of its filters") {
    b.controller.filters_stay_busy = true;
  }
  CHECK(b.bus.open(b.settings, {}) == Status::no_answer);
  CHECK(b.controller.status_reads < 100'100);  // as the header says
  CHECK(b.controller.in_reset());
  CHECK(b.bus.bus() == BusState::closed);
  b.controller.never_joins = false;
  b.controller.arrive(standard(1));
  CHECK_FALSE(b.controller.line());  // no handler could clear it: receive() of a closed bus does nothing
}

TEST_CASE("xilinx_can: a call that is refused leaves an open controller in reset") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  SECTION("no such bit rate") {
    b.settings.bits_s = 300'001;
    CHECK(b.bus.open(b.settings, {}) == Status::bad_bit_rate);
  }
  SECTION("too many filters") {
    CHECK(b.bus.open(b.settings, std::array<Filter, 5>{}) == Status::too_many_filters);
  }
  SECTION("a self-test at no such bit rate") {
    b.settings.bits_s = 300'001;
    CHECK(b.bus.self_test(b.settings) == Status::bad_bit_rate);
  }
  CHECK(b.controller.in_reset());
  CHECK(b.bus.receive(b.frames, 0) == 0);
  CHECK(b.bus.bus() == BusState::closed);
}

TEST_CASE("xilinx_can: a restart that fails leaves the controller in reset until the next") {
  Bench b;
  b.go_off();
  b.controller.never_joins = true;
  b.bus.receive(b.frames, 100'000'000);
  CHECK(b.controller.in_reset());
  CHECK(b.bus.bus() == BusState::off);
  b.controller.never_joins = false;
  b.bus.receive(b.frames, 200'000'000);
  CHECK(b.bus.bus() == BusState::active);
  CHECK(b.bus.counters().restarts == 1);
}

TEST_CASE("xilinx_can: the bus's state follows the controller's") {
  Bench b;
  CHECK(b.bus.bus() == BusState::closed);
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.become(0x080 | 0x040);
  b.bus.receive(b.frames, 0);
  CHECK(b.bus.bus() == BusState::warning);
  b.controller.become(0x180 | 0x040);
  b.bus.receive(b.frames, 0);
  CHECK(b.bus.bus() == BusState::passive);
}

TEST_CASE("xilinx_can: the self-test passes in order, and fails for damage, for silence and for no controller") {
  Bench b;
  CHECK(b.bus.self_test(b.settings) == Status::ok);
  CHECK(b.controller.in_reset());
  CHECK(b.bus.bus() == BusState::closed);
  for (const Words& damage :
       {Words{0x00200000}, Words{0x00080000}, Words{0, 0x80000000}, Words{0, 0, 0x00010000}, Words{0, 0, 0, 1}}) {
    b.controller.damage = damage;
    CHECK(b.bus.self_test(b.settings) == Status::self_test_failed);
    CHECK(b.controller.in_reset());
  }
  b.controller.damage = {};
  b.controller.muted = true;
  CHECK(b.bus.self_test(b.settings) == Status::self_test_failed);
  CHECK(b.controller.in_reset());
  b.controller.never_joins = true;
  CHECK(b.bus.self_test(b.settings) == Status::no_answer);
  CHECK(b.controller.in_reset());
  b.controller.dead = true;
  CHECK(b.bus.self_test(b.settings) == Status::no_answer);
  CHECK(b.bus.open(b.settings, {}) == Status::no_answer);
  CHECK(b.bus.send(frame_of_id(1)) == Status::not_open);
}

TEST_CASE("xilinx_can: the self-test waits for its frames, which take their time to be sent") {
  Bench b;
  b.controller.echo_after = 1000;
  CHECK(b.bus.self_test(b.settings) == Status::ok);
}

TEST_CASE("xilinx_can: the self-test is off the bus, and hears itself whatever filters were set") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, std::array{Filter{0x181, 0x7FF, false}}) == Status::ok);
  CHECK(b.bus.self_test(b.settings) == Status::ok);
}

TEST_CASE("xilinx_can: a full queue refuses, and says so") {
  Bench b;
  REQUIRE(b.bus.open(b.settings, {}) == Status::ok);
  b.controller.muted = true;
  for (int i = 0; i < 64; ++i) REQUIRE(b.bus.send(frame_of_id(1)) == Status::ok);
  CHECK(b.bus.send(frame_of_id(1)) == Status::queue_full);
}
