// Frames through the kernel: filters, times, CAN FD, error messages, overflow. A virtual interface has no controller,
// so the tests write its error messages themselves, bit for bit as a driver does (linux/can/error.h).
#include <ctime>
#include <memory>

#include "bus.hpp"
#include "curbline/can/servo_presets.hpp"
#include "support/heap_count.hpp"

namespace curbline::socketcan::testing {
namespace {

std::int64_t system_time_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

struct Pair {
  explicit Pair(std::span<const Filter> filters = everything) {
    REQUIRE(receiver.open(interface.name(), filters) == Status::ok);
    REQUIRE(sender.open(interface.name(), {}) == Status::ok);
  }
  Interface interface;
  SocketCan receiver, sender;
};

TEST_CASE("socketcan: the filter of a signal lets its id through and no other, 11 bits or 29", "[frames]") {
  for (const bool extended : {false, true}) {
    can::Signal signal;
    signal.id = 0x181;
    signal.id_mask = 0x1FFFFFFF;
    signal.extended = extended;
    const std::array filters{filter_of(signal)};
    Pair bus(filters);
    for (const can::Frame& frame : {frame_of(0x181, !extended), frame_of(0x180, extended), frame_of(0x581, extended),
                                    frame_of(0x181, extended), frame_of(0x10000181, true)}) {
      REQUIRE(bus.sender.send(frame) == Status::ok);
    }
    can::Frame request = frame_of(0x181, extended);
    request.remote = true;
    REQUIRE(bus.sender.send(request) == Status::ok);
    const auto got = receive_all(bus.receiver);
    REQUIRE(got.size() == 1);
    CHECK(got[0].id == 0x181);
    CHECK(got[0].extended == extended);
    CHECK_FALSE(got[0].remote);
  }
}

TEST_CASE("socketcan: a mask leaves bits of the id open", "[frames]") {
  can::Signal signal = can::robstride_feedback(5);
  const std::array filters{filter_of(signal)};
  Pair bus(filters);
  const std::uint32_t faults = 0x00A50000;
  REQUIRE(bus.sender.send(frame_of(signal.id | (faults & ~signal.id_mask), true)) == Status::ok);
  REQUIRE(bus.sender.send(frame_of(signal.id ^ 0x100, true)) == Status::ok);
  CHECK(receive_all(bus.receiver).size() == 1);
}

TEST_CASE("socketcan: without a filter no frame comes in", "[frames]") {
  Pair bus(std::span<const Filter>{});
  REQUIRE(bus.sender.send(frame_of(1)) == Status::ok);
  CHECK(receive_all(bus.receiver).empty());
}

TEST_CASE("socketcan: a frame's time is the kernel's, between before and after it was sent, and does not go back",
          "[frames]") {
  Pair bus;
  std::int64_t last_ns = 0;
  for (int i = 0; i < 200; ++i) {
    const std::int64_t before_ns = system_time_ns();
    REQUIRE(bus.sender.send(frame_of(0x181)) == Status::ok);
    const std::int64_t after_ns = system_time_ns();
    ::usleep(500);  // so that the time of reading differs from the frame's
    std::array<can::Frame, 2> got{};
    REQUIRE(bus.receiver.receive(got, 1000) == 1);
    REQUIRE(got[0].time_ns >= before_ns);
    REQUIRE(got[0].time_ns <= after_ns);
    REQUIRE(got[0].time_ns >= last_ns);
    last_ns = got[0].time_ns;
  }
}

TEST_CASE("socketcan: bytes, lengths and order of classic and FD frames arrive as sent", "[frames]") {
  Pair bus;
  std::vector<can::Frame> sent;
  for (const std::uint8_t length : std::array<std::uint8_t, 11>{0, 1, 8, 12, 16, 20, 24, 32, 48, 64, 8}) {
    can::Frame frame = frame_of(0x100u + length, length % 16 == 0, std::vector<std::uint8_t>(length, length));
    frame.fd = length > 8;
    frame.fd_flags = length == 64 ? 3 : 0;
    REQUIRE(bus.sender.send(frame) == Status::ok);
    sent.push_back(frame);
  }
  const auto got = receive_all(bus.receiver);
  REQUIRE(got.size() == sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    CHECK(got[i].id == sent[i].id);
    CHECK(got[i].extended == sent[i].extended);
    CHECK(got[i].fd == sent[i].fd);
    CHECK(got[i].fd_flags == sent[i].fd_flags);
    CHECK(got[i].length == sent[i].length);
    CHECK(got[i].data == sent[i].data);
  }
}

TEST_CASE("socketcan: what a bus does not carry is not sent, and counted", "[frames]") {
  const Interface classic("vcan8", vcan::mtu_classic);
  SocketCan bus;
  REQUIRE(bus.open(classic.name(), everything) == Status::ok);
  can::Frame fd = frame_of(1, false, std::vector<std::uint8_t>(12));
  fd.fd = true;
  CHECK(bus.send(fd) == Status::bad_frame);
  CHECK(bus.send(frame_of(0x800)) == Status::bad_frame);
  CHECK(bus.send(frame_of(1, false, std::vector<std::uint8_t>(9))) == Status::bad_frame);
  CHECK(bus.send(frame_of(1)) == Status::ok);
  CHECK(bus.counters().sent == 1);
  CHECK(bus.counters().not_sent == 3);
}

TEST_CASE("socketcan: what cannot be opened is said", "[frames]") {
  SocketCan bus;
  CHECK(bus.open("vcan77", everything) == Status::no_interface);
  CHECK(bus.open("", everything) == Status::no_interface);
  CHECK(bus.open("a-name-that-is-too-long", everything) == Status::no_interface);
  CHECK(bus.open("lo", everything) == Status::not_can);
  CHECK(bus.open("vcan0", std::vector<Filter>(SocketCan::max_filters + 1)) == Status::too_many_filters);
  CHECK(bus.descriptor() == -1);
  CHECK(bus.link() == LinkState::closed);
  CHECK(bus.send(frame_of(1)) == Status::not_open);
  std::array<can::Frame, 2> frames{};
  CHECK(bus.receive(frames, 0) == 0);
}

TEST_CASE("socketcan: error messages are counted by kind and are no frames", "[frames]") {
  Pair bus;
  say_error(bus.sender, CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING);
  CHECK(receive_all(bus.receiver).empty());
  CHECK(bus.receiver.bus() == BusState::warning);
  say_error(bus.sender, CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
  say_error(bus.sender, CAN_ERR_PROT | CAN_ERR_BUSERROR);
  say_error(bus.sender, CAN_ERR_ACK);
  say_error(bus.sender, CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW);
  REQUIRE(bus.sender.send(frame_of(0x181)) == Status::ok);
  CHECK(receive_all(bus.receiver).size() == 1);
  CHECK(bus.receiver.bus() == BusState::passive);
  say_error(bus.sender, CAN_ERR_BUSOFF);
  CHECK(receive_all(bus.receiver).empty());
  CHECK(bus.receiver.bus() == BusState::off);
  say_error(bus.sender, CAN_ERR_RESTARTED);
  CHECK(receive_all(bus.receiver).empty());
  CHECK(bus.receiver.bus() == BusState::active);
  const Counters& counters = bus.receiver.counters();
  CHECK(counters.error_messages == 7);
  CHECK(counters.bus_errors == 2);
  CHECK(counters.controller_overruns == 1);
  CHECK(counters.times_passive == 1);
  CHECK(counters.times_bus_off == 1);
  CHECK(counters.restarts == 1);
  CHECK(counters.frames == 1);
}

TEST_CASE("socketcan: the bus's state follows what the controller reports of either of its error counters",
          "[frames]") {
  Pair bus;
  const std::pair<std::uint8_t, BusState> reports[] = {
      {CAN_ERR_CRTL_TX_WARNING, BusState::warning},  {CAN_ERR_CRTL_ACTIVE, BusState::active},
      {CAN_ERR_CRTL_RX_WARNING, BusState::warning},  {CAN_ERR_CRTL_RX_PASSIVE, BusState::passive},
      {CAN_ERR_CRTL_RX_WARNING, BusState::warning},  {CAN_ERR_CRTL_TX_PASSIVE, BusState::passive},
      {CAN_ERR_CRTL_TX_OVERFLOW, BusState::passive}, {CAN_ERR_CRTL_ACTIVE, BusState::active}};
  for (const auto& [report, state] : reports) {
    INFO(int{report});
    say_error(bus.sender, CAN_ERR_CRTL, report);
    CHECK(receive_all(bus.receiver).empty());
    CHECK(bus.receiver.bus() == state);
  }
  CHECK(bus.receiver.counters().times_passive == 2);
  CHECK(bus.receiver.counters().controller_overruns == 1);
}

TEST_CASE("socketcan: a flood of error messages hides no frame and delays no call", "[frames]") {
  Pair bus;
  for (int i = 0; i < 2000; ++i) {
    say_error(bus.sender, CAN_ERR_PROT | CAN_ERR_BUSERROR);
    if (i % 100 == 50) REQUIRE(bus.sender.send(frame_of(0x181)) == Status::ok);
  }
  CHECK(receive_all(bus.receiver).size() == 20);
  CHECK(bus.receiver.counters().error_messages == 2000);
  CHECK(bus.receiver.counters().frames_lost == 0);
}

TEST_CASE("socketcan: frames that nobody read in time are counted as lost", "[frames]") {
  Pair bus;
  const int small = 0;  // the kernel raises it to its minimum
  REQUIRE(::setsockopt(bus.receiver.descriptor(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small) == 0);
  std::size_t lost = 0;
  for (const bool again : {false, true}) {
    INFO(again);
    for (int i = 0; i < 200; ++i) REQUIRE(bus.sender.send(frame_of(0x181)) == Status::ok);
    const auto kept = receive_all(bus.receiver);
    REQUIRE(bus.sender.send(frame_of(0x182)) == Status::ok);  // the kernel reports the loss with the next frame
    REQUIRE(receive_all(bus.receiver).size() == 1);
    CHECK(kept.size() < 200);
    lost += 200 - kept.size();
    CHECK(bus.receiver.counters().frames_lost == lost);
  }
}

TEST_CASE("socketcan: a wait ends when its time is over, and a call without waiting at once", "[frames]") {
  Pair bus;
  std::array<can::Frame, 2> frames{};
  const auto seconds_for = [&](int timeout_ms) {
    const auto before = std::chrono::steady_clock::now();
    CHECK(bus.receiver.receive(frames, timeout_ms) == 0);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  };
  CHECK(seconds_for(0) < 0.1);
  const double waited = seconds_for(200);
  CHECK(waited >= 0.199);
  CHECK(waited < 1.0);
}

TEST_CASE("socketcan: after open() nothing asks the heap for memory", "[frames]") {
  Pair bus;
  std::array<can::Frame, 64> frames{};
  const long before = test::heap_count();
  int got = 0;
  for (int i = 0; i < 100; ++i) {
    bus.sender.send(can::Frame{});
    got += bus.receiver.receive(frames, 100);
  }
  const long asked = test::heap_count() - before;
  CHECK(asked == 0);
  CHECK(got == 100);
  const auto counted = std::make_unique<int>(1);
  CHECK(test::heap_count() > before);  // the counter works
}

}  // namespace
}  // namespace curbline::socketcan::testing
