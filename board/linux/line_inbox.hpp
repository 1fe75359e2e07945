// Holds scan lines that wait for their tilt and pose (curbline/intake/line_queue.hpp), between the context that reads
// the scanner and the one that runs the pipeline. Neither waits for the other for longer than it takes to copy a line.
// About 750 kB, no heap.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>

#include "curbline/intake/line_queue.hpp"
#include "robot/robot.hpp"

namespace curbline::daemon {

/// Room for more than a second of lines at any scanner's rate up to 64 Hz, with as many beams as any supported scanner
/// has.
inline constexpr Limits inbox_limits{.beams = tools::most_beams};
inline constexpr int inbox_lines = 64;

class LineInbox {
 public:
  LineInbox();
  ~LineInbox();
  LineInbox(const LineInbox&) = delete;
  LineInbox& operator=(const LineInbox&) = delete;

  void init(const tools::Robot& robot, float max_wait_s);

  /// From the scanner's context. Makes descriptor() readable.
  void push(const ScanLine& line, std::int64_t now_ns);

  /// From the pipeline's context; see LineQueue::pop(). `covered`: the line's tilt and pose are known. The ranges are
  /// valid until the next pop().
  std::optional<ScanLine> pop(const NewestTimes& newest, std::int64_t now_ns, float offset_s, bool& covered);

  bool empty() const;
  LineQueueCounters counters() const;
  int descriptor() const { return event_; }  ///< for poll(2), POLLIN; then call quiet()
  void quiet() const;

 private:
  mutable std::mutex mutex_;
  LineQueue<inbox_limits, inbox_lines> queue_;
  std::array<float, static_cast<std::size_t>(inbox_limits.beams)> ranges_m_{};
  int event_ = -1;
};

}  // namespace curbline::daemon
