// Interfaces and sockets for tests on the kernel's CAN.
#pragma once

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstring>
#include <string>
#include <vector>

#include "socketcan/socketcan.hpp"
#include "vcan/link.hpp"

namespace curbline::socketcan::testing {

constexpr std::array<Filter, 2> everything{Filter{0, 0, false}, Filter{0, 0, true}};

/// A virtual interface for one test.
class Interface {
 public:
  explicit Interface(const char* name = "vcan9", unsigned mtu = vcan::mtu_fd) : name_(name) {
    REQUIRE(vcan::make_vcan(name, mtu) == 0);
  }
  ~Interface() { vcan::remove_link(name_); }
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  const char* name() const { return name_; }

 private:
  const char* name_;
};

inline can::Frame frame_of(std::uint32_t id, bool extended = false, std::vector<std::uint8_t> data = {1, 2}) {
  can::Frame frame;
  frame.id = id;
  frame.extended = extended;
  frame.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

/// Sends an error message as a controller's driver does.
inline void say_error(SocketCan& by, canid_t what, std::uint8_t controller = 0) {
  can_frame frame{};
  frame.can_id = CAN_ERR_FLAG | what;
  frame.len = CAN_ERR_DLC;
  frame.data[1] = controller;
  REQUIRE(::write(by.descriptor(), &frame, sizeof frame) == sizeof frame);
}

/// Receives until nothing has arrived for 50 ms.
inline std::vector<can::Frame> receive_all(SocketCan& bus) {
  std::vector<can::Frame> all;
  std::array<can::Frame, 64> some{};
  for (int n; (n = bus.receive(some, 50)) > 0;) all.insert(all.end(), some.begin(), some.begin() + n);
  return all;
}

/// Calls receive() until the link reaches a state, for at most 2 s.
inline bool reaches(SocketCan& bus, LinkState state) {
  std::array<can::Frame, 4> frames{};
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (bus.link() != state && std::chrono::steady_clock::now() < deadline) bus.receive(frames, 100);
  return bus.link() == state;
}

}  // namespace curbline::socketcan::testing
