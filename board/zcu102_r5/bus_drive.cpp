// A drive whose CAN frames go over the board's bus, each at its own time: CAN1 plays the servo, CAN0 the robot, and a
// frame's time is that of its reception by CAN0. The results contain each frame as received, so that a desk can repeat
// the board's computation bit for bit. With each frame goes one with another id, which must be filtered out. Words:
// PROGRAM DRIVE RESULTS.
#include "can_pair.hpp"
#include "cycle_clock.hpp"
#include "drive.hpp"
#include "runtime.hpp"
#include "semihosting/semihosting.hpp"

namespace semihosting = curbline::semihosting;
namespace can = curbline::can;
using namespace curbline::board;

namespace {

curbline::Pipeline<limits> pipeline;
semihosting::FilePair files;

class Wire {
 public:
  bool open(const can::Signal& signal) {
    const std::array filters{curbline::xilinx_can::filter_of(signal)};
    const std::array nothing{curbline::xilinx_can::Filter{0x7FF, 0x7FF, false}};
    return robot_.open(can_settings, filters) == curbline::xilinx_can::Status::ok &&
           servo_.open(can_settings, nothing) == curbline::xilinx_can::Status::ok;
  }

  bool carry(const can::Frame& frame, auto&& take) {
    if (!started_) clock_.start(frame.time_ns - before_first_ns);
    started_ = true;
    clock_.skip();  // excludes the pipeline and the host's files: an emulated core is no measure of their time
    while (clock_.now_ns() < frame.time_ns) {
    }
    can::Frame other = frame;
    other.id ^= 0x10;
    if (servo_.send(other) != curbline::xilinx_can::Status::ok ||
        servo_.send(frame) != curbline::xilinx_can::Status::ok)
      return false;
    return receive(take);
  }

 private:
  static constexpr std::int64_t before_first_ns = 1'000'000, longest_ns = 1'000'000;

  /// Receives the one frame in transit.
  bool receive(auto&& take) {
    std::array<can::Frame, 4> frames;
    const std::int64_t until_ns = clock_.now_ns() + longest_ns;
    int n = 0;
    while (n == 0 && clock_.now_ns() < until_ns) n = robot_.receive(frames, clock_.now_ns());
    if (n != 1 || !keep(frames[0])) return false;
    take(frames[0]);
    return true;
  }

  static bool keep(const can::Frame& frame) {
    const RecordHeader header{RecordKind::can_frame, sizeof frame};
    return files.write(std::as_bytes(std::span(&header, 1))) && files.write(std::as_bytes(std::span(&frame, 1)));
  }

  Can servo_{curbline::xilinx_can::MemoryRegisters{can1_base}},
      robot_{curbline::xilinx_can::MemoryRegisters{can0_base}};
  CycleClock clock_{};
  bool started_ = false;
};

Drive<semihosting::FilePair, Wire> drive(files, pipeline);

}  // namespace

int main() {
  const semihosting::CommandLine command_line;
  const auto words = command_line.words();
  if (words.size() != 3 || !files.open(words[1], words[2])) {
    semihosting::print("usage: FIRMWARE DRIVE RESULTS, files that can be opened\n");
    return 2;
  }
  const DriveEnd end = drive.run();
  if (end == DriveEnd::done) return 0;
  semihosting::print(to_string(end));
  semihosting::print("\n");
  return 1;
}
