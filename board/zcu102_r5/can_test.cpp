// Tests the driver on the board's two controllers, which share a bus. Prints one line per claim; ends with 1 if one
// does not hold.
#include <array>

#include "can_pair.hpp"
#include "semihosting/semihosting.hpp"

namespace semihosting = curbline::semihosting;
namespace can = curbline::can;
using namespace curbline::board;
using curbline::xilinx_can::Filter;
using curbline::xilinx_can::MemoryRegisters;
using curbline::xilinx_can::Status;

namespace {

Can sender{MemoryRegisters{can1_base}}, receiver{MemoryRegisters{can0_base}};
bool all_hold = true;

void claim(const char* text, bool holds) {
  semihosting::print(holds ? "ok      " : "FAILED  ");
  semihosting::print(text);
  semihosting::print("\n");
  all_hold = all_hold && holds;
}

can::Frame frame_of(std::uint32_t id, bool extended, std::uint8_t length) {
  can::Frame frame;
  frame.id = id;
  frame.extended = extended;
  frame.length = length;
  for (std::uint8_t i = 0; i < length; ++i) frame.data[i] = static_cast<std::uint8_t>(0x31 * i + id);
  return frame;
}

bool open(std::span<const Filter> filters) {
  return sender.open(can_settings, {}) == Status::ok && receiver.open(can_settings, filters) == Status::ok;
}

/// Polls the receiver 1000 times and returns how many frames came, the last of them in `last`.
int drain(can::Frame& last) {
  std::array<can::Frame, 8> frames;
  int count = 0;
  for (int look = 0; look < 1000; ++look) {
    const int n = receiver.receive(frames, look);
    if (n > 0) last = frames[static_cast<std::size_t>(n - 1)];
    count += n;
  }
  return count;
}

bool arrives(const can::Frame& sent) {
  can::Frame got;
  return sender.send(sent) == Status::ok && drain(got) == 1 && got.id == sent.id && got.extended == sent.extended &&
         got.length == sent.length && got.data == sent.data;
}

void every_length_and_kind() {
  bool all = open({});
  for (std::uint8_t length = 0; length <= 8; ++length) {
    all = all && arrives(frame_of(0x181, false, length)) && arrives(frame_of(0x1234567, true, length));
  }
  claim("frames of every length, of 11 and of 29 bits, arrive as they were sent", all);
}

void filters() {
  const std::array wanted{Filter{0x181, 0x7FF, false}, Filter{0x12300, 0x1FFFFF00, true}};
  bool all = open(wanted) && arrives(frame_of(0x181, false, 8)) && arrives(frame_of(0x12345, true, 8));
  can::Frame got;
  for (const can::Frame& other : {frame_of(0x180, false, 8), frame_of(0x181, true, 8), frame_of(0x12445, true, 8)}) {
    all = all && sender.send(other) == Status::ok && drain(got) == 0;
  }
  can::Frame remote = frame_of(0x181, false, 0);
  remote.remote = true;
  claim("filters let their ids through, and no other, nor remote requests",
        all && sender.send(remote) == Status::ok && drain(got) == 0);
}

void overflow() {
  bool all = open({});
  const std::uint32_t before = receiver.counters().overflows;
  for (std::uint32_t id = 0; id < 70; ++id) all = all && sender.send(frame_of(id, false, 8)) == Status::ok;
  can::Frame got;
  claim("of 70 frames that nobody takes the oldest 64 are kept, and the loss is counted",
        all && drain(got) == 64 && got.id == 63 && receiver.counters().overflows == before + 1);
  claim("after an overflow frames arrive again", arrives(frame_of(0x55, false, 8)));
}

}  // namespace

int main() {
  claim("CAN0 passes its self-test", receiver.self_test(can_settings) == Status::ok);
  claim("CAN1 passes its self-test", sender.self_test(can_settings) == Status::ok);
  every_length_and_kind();
  filters();
  overflow();
  return all_hold ? 0 : 1;
}
