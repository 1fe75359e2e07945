// A full bus of 1 Mbit/s, 8,000 frames a second, beside the pipeline.
#include <atomic>
#include <cmath>
#include <thread>

#include "bus.hpp"
#include "curbline/can/servo_presets.hpp"
#include "support/heap_count.hpp"
#include "support/nodding_pipeline.hpp"

namespace curbline::socketcan::testing {
namespace {

constexpr std::uint32_t frames = 100'000, tilt_every = 8;
constexpr double rate_hz = 8000.0;

const can::Signal signal = can::cia402_position(1);

/// Every eighth frame is a tilt frame. Bytes that its signal does not use number the frames.
can::Frame frame_number(std::uint32_t n) {
  can::Frame frame;
  frame.id = 0x200 + n % 500;
  frame.extended = n % 3 == 0;
  if (n % tilt_every == 0) {
    frame = can::Frame{};
    can::encode(signal, test::NoddingLaser::tilt_rad(n / rate_hz), frame);
  }
  frame.length = 8;
  for (const auto& [byte, shift] : {std::pair{0u, 0u}, {1u, 8u}, {6u, 16u}, {7u, 24u}}) {
    frame.data[byte] = static_cast<std::uint8_t>(n >> shift);
  }
  return frame;
}

std::uint32_t number_of(const can::Frame& frame) {
  return std::uint32_t{frame.data[0]} | std::uint32_t{frame.data[1]} << 8 | std::uint32_t{frame.data[6]} << 16 |
         std::uint32_t{frame.data[7]} << 24;
}

/// Sends in bursts of a millisecond.
void send_all(SocketCan& bus, std::atomic<bool>& sent) {
  const auto start = std::chrono::steady_clock::now();
  for (std::uint32_t n = 0; n < frames; ++n) {
    if (n % 8 == 0) std::this_thread::sleep_until(start + std::chrono::microseconds(n * 125));
    const can::Frame frame = frame_number(n);
    while (bus.send(frame) == Status::queue_full) std::this_thread::yield();
  }
  sent = true;
}

/// Scan lines at 40 Hz, each taken when the tilt of its last beam is available.
class Lines {
 public:
  Lines() {
    test::NoddingLaser laser;
    const int count = static_cast<int>(frames / rate_hz / test::NoddingLaser::line_s) - 1;
    for (int line = 0; line < count; ++line) ranges_.push_back(laser.ranges({}, line, [](double) { return 0.0; }));
  }
  void take_tilt(const can::Frame& frame, test::FullPipeline& pipeline) {
    const auto angle_rad = can::decode(signal, frame);
    if (!angle_rad) return;
    if (start_ns_ == 0) start_ns_ = frame.time_ns;
    pipeline.add_tilt({frame.time_ns, static_cast<float>(*angle_rad)});
    for (;;) {
      const std::int64_t time_ns = start_ns_ + static_cast<std::int64_t>(taken_) * 25'000'000;
      if (taken_ == ranges_.size() || frame.time_ns < time_ns + 25'000'000) return;
      pipeline.take({time_ns, ranges_[taken_++]});
    }
  }
  std::size_t size() const { return ranges_.size(); }
  std::size_t taken() const { return taken_; }

 private:
  std::vector<std::vector<float>> ranges_;
  std::size_t taken_ = 0;
  std::int64_t start_ns_ = 0;
};

TEST_CASE("socketcan: 100,000 frames at 8,000 a second beside the pipeline: none lost, in order, nothing from the heap",
          "[load]") {
  const Interface interface;
  const std::array tilt{filter_of(signal)};
  SocketCan sender, all, servo;
  REQUIRE(sender.open(interface.name(), {}) == Status::ok);
  REQUIRE(all.open(interface.name(), everything) == Status::ok);
  REQUIRE(servo.open(interface.name(), tilt) == Status::ok);
  const auto pipeline = test::started();
  Lines lines;
  std::array<can::Frame, 64> some{};

  std::atomic<bool> sent = false;
  const auto start = std::chrono::steady_clock::now();
  std::thread sending(send_all, std::ref(sender), std::ref(sent));
  std::uint32_t next = 0, out_of_order = 0;
  std::int64_t last_ns = 0, times_back = 0;
  const long heap_before = test::heap_count();
  for (int silent = 0; silent < 20;) {  // 20 waits of 10 ms after the last
    const int tilts = servo.receive(some, 10);
    for (int i = 0; i < tilts; ++i) lines.take_tilt(some[static_cast<std::size_t>(i)], *pipeline);
    int others = 0;
    for (int n; (n = all.receive(some, 0)) > 0; others += n) {
      for (int i = 0; i < n; ++i) {
        const can::Frame& frame = some[static_cast<std::size_t>(i)];
        out_of_order += number_of(frame) != next++;
        times_back += frame.time_ns < last_ns;
        last_ns = frame.time_ns;
      }
    }
    silent = sent && tilts + others == 0 ? silent + 1 : 0;
  }
  const long heap_asked = test::heap_count() - heap_before;
  sending.join();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() - 0.2;
  WARN(frames / seconds << " frames/s, " << lines.taken() << " scan lines");

  CHECK(next == frames);
  CHECK(out_of_order == 0);
  CHECK(times_back == 0);
  CHECK(heap_asked == 0);
  CHECK(sender.counters().sent == frames);
  CHECK(all.counters().frames == frames);
  CHECK(all.counters().frames_lost == 0);
  CHECK(servo.counters().frames == frames / tilt_every);
  CHECK(servo.counters().frames_lost == 0);
  CHECK(lines.taken() == lines.size());
  CHECK(pipeline->counters().lines == lines.size());
  CHECK(pipeline->counters().lines_dropped == 0);
  CHECK(pipeline->counters().tilt_dropped == 0);
  CHECK(pipeline->counters().beams_without_tilt == 0);
  CHECK(pipeline->counters().points > 0);
}

}  // namespace
}  // namespace curbline::socketcan::testing
