// Tilt readings written by a timer's interrupt while the pipeline reads. Prints one line for each of two claims and
// ends with 1 if one does not hold: every snapshot of a track under constant writes is consistent; a drive whose
// readings arrive by interrupt has the same results, byte for byte, as one without interrupts. Words: PROGRAM DRIVE
// RESULTS.
#include <atomic>

#include "drive.hpp"
#include "runtime.hpp"
#include "semihosting/semihosting.hpp"
#include "timer.hpp"

namespace semihosting = curbline::semihosting;
namespace timer = curbline::board::timer;
namespace can = curbline::can;
using namespace curbline;
using namespace curbline::board;

namespace {

Pipeline<limits> pipeline;
semihosting::FilePair files;
void (*handler)() = nullptr;

bool claim(const char* text, bool holds) {
  semihosting::print(holds ? "ok      " : "FAILED  ");
  semihosting::print(text);
  semihosting::print("\n");
  return holds;
}

/// A varying period, from 100 to 227 ticks of 40 ns: 250 to 570 instructions at 16 ns each.
std::uint32_t next_period() {
  static std::uint32_t state = 1;
  state = state * 1664525u + 1013904223u;
  return 100 + (state >> 25);
}

// A track alone. Both halves of a reading's time change from one reading to the next, so that a torn one is detected.
namespace hammer {

constexpr std::int64_t step_ns = 2'000'000'011;
constexpr std::uint32_t snapshots = 5'000, capacity = limits.tilt_samples, most_added = 20;
TiltTrack<limits> track;
TiltSnapshot<limits> snapshot;
std::atomic<std::uint32_t> pushed{0};

TiltReading reading(std::uint32_t n) {
  return {static_cast<std::int64_t>(n) * step_ns, static_cast<float>(n % 65536)};
}

void on_timer() {
  const std::uint32_t n = pushed.load(std::memory_order_relaxed);
  track.push(reading(n));
  pushed.store(n + 1, std::memory_order_relaxed);
}

/// Whether the snapshot contains every reading that it must, as it was pushed: of the readings before it all but the
/// newest, except those that a later reading, possibly still being written, has replaced.
bool whole(std::uint32_t before, std::uint32_t added) {
  for (std::uint32_t n = before + added + 1 - capacity; n + 1 < before; ++n) {
    const TiltAngle angle = snapshot.at(reading(n).time_ns);
    if (angle.source != TiltAngle::Source::interpolated || angle.angle_rad != reading(n).angle_rad) return false;
  }
  return true;
}

bool run() {
  TiltSettings settings;
  settings.max_gap_s = 10.0f;
  track.init(settings);
  handler = on_timer;
  timer::start(next_period());
  std::uint32_t interrupted = 0;
  bool good = true;
  while (pushed.load() < capacity) {
  }
  for (std::uint32_t i = 0; i < snapshots && good; ++i) {
    const std::uint32_t before = pushed.load();
    track.snapshot(snapshot, 0.0f, INT64_MAX);
    const std::uint32_t added = pushed.load() - before;
    interrupted += added > 0;
    good = added <= most_added && whole(before, added);
  }
  timer::stop();
  semihosting::print_number("        snapshots that were interrupted: ", interrupted);
  return good && interrupted > snapshots / 2;
}

}  // namespace hammer

// The servo of a drive at six times its rate: between two of its frames, readings interpolated linearly.
namespace servo {

constexpr int parts = 6;
TiltReading from, to;
std::atomic<int> left{0};  ///< readings of the pair that have not been pushed yet

void push_next() {
  const int part = left.load(std::memory_order_relaxed) - 1;
  const auto share = static_cast<float>(part) / parts;
  pipeline.add_tilt({to.time_ns - (to.time_ns - from.time_ns) * part / parts,
                     to.angle_rad - (to.angle_rad - from.angle_rad) * share});
  left.store(part, std::memory_order_release);
}

std::atomic<std::uint32_t> by_interrupt{0};
void on_timer() {
  if (left.load(std::memory_order_acquire) == 0) return;
  push_next();
  by_interrupt.store(by_interrupt.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

/// A pair is handed over once all readings of the previous pair are pushed, so the last pair before a scan line is
/// pushed while the pipeline is at work.
class Way {
 public:
  explicit Way(bool interrupts) : interrupts_(interrupts) {}
  bool open(const can::Signal& signal) { return decoder_.init(signal); }
  bool carry(const can::Frame& frame, auto&&) {
    const std::optional<TiltReading> reading = decoder_.take(frame);
    if (!reading) return true;
    while (left.load(std::memory_order_acquire) > 0) {
    }
    from = to;
    to = *reading;
    if (from.time_ns != 0) left.store(parts, std::memory_order_release);
    while (!interrupts_ && left.load(std::memory_order_relaxed) > 0) push_next();
    return true;
  }

 private:
  bool interrupts_;
  can::TiltDecoder decoder_{};
};

/// Keeps a hash of the results (FNV-1a) instead of the results.
struct SummedFiles {
  std::uint64_t sum = 0xCBF29CE484222325u;
  std::uint32_t bytes = 0;
  std::size_t read(std::span<std::byte> in) { return files.read(in); }
  bool write(std::span<const std::byte> out) {
    for (const std::byte b : out) sum = (sum ^ static_cast<std::uint8_t>(b)) * 0x100000001B3u;
    bytes += static_cast<std::uint32_t>(out.size());
    return true;
  }
};

bool drive(const char* in, const char* out, bool interrupts, SummedFiles& results) {
  if (!files.open(in, out)) return false;
  from = to = TiltReading{};
  left.store(0);
  Drive<SummedFiles, Way> drive(results, pipeline, Way(interrupts));
  handler = on_timer;
  if (interrupts) timer::start(next_period());
  const DriveEnd end = drive.run();
  timer::stop();
  return end == DriveEnd::done;
}

bool run(const char* in, const char* out) {
  SummedFiles called, interrupted;
  if (!drive(in, out, false, called) || !drive(in, out, true, interrupted)) return false;
  semihosting::print_number("        readings by interrupt: ", by_interrupt.load());
  semihosting::print_number("        points: ", pipeline.counters().points);
  return called.sum == interrupted.sum && called.bytes == interrupted.bytes && pipeline.counters().points > 10'000 &&
         by_interrupt.load() > 1000;
}

}  // namespace servo
}  // namespace

void on_interrupt(std::uint32_t) {
  timer::acknowledge();
  timer::set_period(next_period());
  handler();
}

int main() {
  const semihosting::CommandLine command_line;
  const auto words = command_line.words();
  if (words.size() != 3) {
    semihosting::print("usage: FIRMWARE DRIVE RESULTS\n");
    return 2;
  }
  const bool track = claim("a track that an interrupt writes gives whole snapshots", hammer::run());
  const bool drive =
      claim("a drive whose readings come by interrupt has the results of one without", servo::run(words[1], words[2]));
  return track && drive ? 0 : 1;
}
