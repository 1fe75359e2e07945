// The interface goes down or away, and comes back.
#include <poll.h>

#include <thread>

#include "bus.hpp"

namespace curbline::socketcan::testing {
namespace {

constexpr std::array<Filter, 1> tilt{Filter{0x181, 0x7FF, false}};

/// Sends a frame with another id and a tilt frame, and expects only the tilt frame.
void check_carries(SocketCan& bus, const char* interface_name) {
  SocketCan sender;
  REQUIRE(sender.open(interface_name, {}) == Status::ok);
  REQUIRE(sender.send(frame_of(0x182)) == Status::ok);
  REQUIRE(sender.send(frame_of(0x181)) == Status::ok);
  const auto got = receive_all(bus);
  REQUIRE(got.size() == 1);
  CHECK(got[0].id == 0x181);
}

TEST_CASE("socketcan: an interface that is taken down and up is seen, counted and read again", "[link]") {
  const Interface interface;
  SocketCan bus;
  REQUIRE(bus.open(interface.name(), tilt) == Status::ok);
  const int descriptor = bus.descriptor();
  for (unsigned times = 1; times <= 3; ++times) {
    check_carries(bus, interface.name());
    REQUIRE(vcan::set_link(interface.name(), false) == 0);
    REQUIRE(reaches(bus, LinkState::down));
    CHECK(bus.send(frame_of(1)) == Status::interface_down);
    CHECK(bus.counters().times_down == times);
    REQUIRE(vcan::set_link(interface.name(), true) == 0);
    REQUIRE(reaches(bus, LinkState::up));
    CHECK(bus.counters().times_back == times);
  }
  check_carries(bus, interface.name());
  CHECK(bus.descriptor() == descriptor);
  CHECK(bus.counters().times_gone == 0);
}

TEST_CASE("socketcan: a bus that was off is not when its interface is up again", "[link]") {
  const Interface interface;
  SocketCan bus, other;
  REQUIRE(bus.open(interface.name(), tilt) == Status::ok);
  REQUIRE(other.open(interface.name(), {}) == Status::ok);
  say_error(other, CAN_ERR_BUSOFF);
  receive_all(bus);
  REQUIRE(bus.bus() == BusState::off);
  REQUIRE(vcan::set_link(interface.name(), false) == 0);
  REQUIRE(reaches(bus, LinkState::down));
  CHECK(bus.bus() == BusState::off);
  REQUIRE(vcan::set_link(interface.name(), true) == 0);
  REQUIRE(reaches(bus, LinkState::up));
  CHECK(bus.bus() == BusState::active);
}

TEST_CASE("socketcan: an interface that is removed and made anew is read again, through the same filters", "[link]") {
  SocketCan bus;
  {
    const Interface interface;
    REQUIRE(bus.open(interface.name(), tilt) == Status::ok);
  }
  const int descriptor = bus.descriptor();
  for (unsigned times = 1; times <= 3; ++times) {
    REQUIRE(reaches(bus, LinkState::gone));
    CHECK(bus.send(frame_of(1)) == Status::no_interface);
    CHECK(bus.counters().times_gone == times);
    const Interface anew;
    REQUIRE(reaches(bus, LinkState::up));
    CHECK(bus.counters().times_back == times);
    check_carries(bus, anew.name());
  }
  CHECK(bus.descriptor() == descriptor);
}

TEST_CASE("socketcan: a wait ends soon after an interface that was gone or down is back", "[link]") {
  using Clock = std::chrono::steady_clock;
  SocketCan bus;
  std::array<can::Frame, 2> frames{};
  const auto seconds_of_wait = [&] {
    const auto before = Clock::now();
    CHECK(bus.receive(frames, 5000) == 0);
    CHECK(bus.link() == LinkState::up);
    return std::chrono::duration<double>(Clock::now() - before).count();
  };
  {
    const Interface interface;
    REQUIRE(bus.open(interface.name(), tilt) == Status::ok);
  }
  REQUIRE(reaches(bus, LinkState::gone));
  const Interface anew;
  CHECK(seconds_of_wait() < 1.0);
  REQUIRE(vcan::set_link(anew.name(), false) == 0);
  REQUIRE(reaches(bus, LinkState::down));
  std::thread up([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    vcan::set_link(anew.name(), true);
  });
  CHECK(seconds_of_wait() < 2.0);
  up.join();
}

TEST_CASE("socketcan: an interface that is made anew before anyone looked is read again", "[link]") {
  SocketCan bus;
  {
    const Interface interface;
    REQUIRE(bus.open(interface.name(), tilt) == Status::ok);
  }
  const Interface anew;
  receive_all(bus);
  REQUIRE(reaches(bus, LinkState::up));
  CHECK(bus.counters().times_gone == 1);
  check_carries(bus, anew.name());
}

TEST_CASE("socketcan: an interface that is down when it is opened is read once it is up", "[link]") {
  const Interface interface;
  REQUIRE(vcan::set_link(interface.name(), false) == 0);
  SocketCan bus;
  REQUIRE(bus.open(interface.name(), tilt) == Status::ok);
  CHECK(bus.link() == LinkState::down);
  REQUIRE(vcan::set_link(interface.name(), true) == 0);
  REQUIRE(reaches(bus, LinkState::up));
  check_carries(bus, interface.name());
  CHECK(bus.counters().times_down == 0);
}

TEST_CASE("socketcan: poll hears frames and a link that fails", "[link]") {
  const Interface interface;
  SocketCan bus, sender;
  REQUIRE(bus.open(interface.name(), tilt) == Status::ok);
  REQUIRE(sender.open(interface.name(), {}) == Status::ok);
  std::array<can::Frame, 2> frames{};
  pollfd ready{bus.descriptor(), POLLIN, 0};
  CHECK(::poll(&ready, 1, 0) == 0);
  REQUIRE(sender.send(frame_of(0x181)) == Status::ok);
  CHECK(::poll(&ready, 1, 1000) == 1);
  CHECK(bus.receive(frames, 0) == 1);
  REQUIRE(vcan::set_link(interface.name(), false) == 0);
  CHECK(::poll(&ready, 1, 1000) == 1);
  CHECK(bus.receive(frames, 0) == 0);
  CHECK(bus.link() == LinkState::down);
}

}  // namespace
}  // namespace curbline::socketcan::testing
