// Scan lines that wait for their tilt and pose. A line is complete with its last beam, but its angles are known only
// with the next servo frame, and its pose with the next pose, up to a period later: taken at once, its end would be
// extrapolated. Stands before the pipeline:
//
//   scanner --> LineQueue --> Pipeline::take()       pop(newest, now, offset) after every line, tilt reading and pose
//
// First in, first out. It keeps a copy of each line; sizeof is about capacity * (4 beams + 32) bytes. Capacity: a line
// waits at most until capacity - 1 more have come, and should be able to wait for the settings' latency and two periods
// of the servo's frames (one may be lost), or two periods of poses: that time over a line's period, rounded up, plus
// one. No clock: times come in. push() costs a copy of the ranges, pop() constant time. One context, or several that
// exclude each other.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "curbline/intake/rising_times.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/scan_line.hpp"
#include "curbline/settings.hpp"

namespace curbline {

/// Every line pushed is counted in one of the others, or still waits. All wrap at 2^32.
struct LineQueueCounters {
  std::uint32_t pushed = 0;
  std::uint32_t covered = 0;   ///< given out with tilt and pose for every beam
  std::uint32_t overdue = 0;   ///< given out after the longest wait: beams may be extrapolated or dropped
  std::uint32_t crowded = 0;   ///< given out early, because the queue was full
  std::uint32_t dropped = 0;   ///< the oldest, because the queue was full and nobody took it
  std::uint32_t too_long = 0;  ///< refused: more beams than the limits have
  std::uint32_t bad_time = 0;  ///< refused: a stamp beyond RisingTimes::furthest_ns
};

/// Stamps of the newest tilt reading and the newest pose that the pipeline took; `none` before the first, and where
/// none ever comes, with a fixed tilt or a robot that stands.
struct NewestTimes {
  static constexpr std::int64_t none = RisingTimes::none;
  std::int64_t tilt_ns = none, pose_ns = none;
};

template <Limits limits, int capacity>
class LineQueue {
  static_assert(capacity >= 2, "one line waits, one comes");

 public:
  /// Empties the queue. A line waits at most max_wait_s, 0 to 1e9, and as much longer as readings are late by the
  /// settings (TiltSettings::latency_s). A good choice is TiltSettings::max_gap_s, as beams in a longer gap have no
  /// angle, or PoseSettings::max_extrapolation_s of a robot that drives, if longer. The pipeline must keep readings and
  /// poses for as long as a line waits: Limits::tilt_samples, Limits::poses.
  void init(const LaserSettings& laser, const TiltSettings& tilt, const PoseSettings& pose, float max_wait_s);

  /// Copies a line that has arrived at now_ns (any clock, the same as for pop()). False if it is refused, for its
  /// length or its stamp. A full queue drops its oldest line; it never does if each push() is followed by pop() until
  /// that returns nothing.
  bool push(const ScanLine& line, std::int64_t now_ns);

  /// The oldest line, if tilt and poses reach its last beam, if it has waited for max_wait_s, or if the queue is full.
  /// offset_s is the pipeline's tilt_latency().latest_offset_s(): with the settings' latency, it is how much later a
  /// reading's stamp is than its angle. The ranges are valid until the next push().
  std::optional<ScanLine> pop(const NewestTimes& newest, std::int64_t now_ns, float offset_s);

  int size() const { return size_; }
  const LineQueueCounters& counters() const { return counters_; }

 private:
  struct Entry {
    std::int64_t time_ns, last_beam_ns, arrival_ns;
    std::size_t beams;
  };

  ScanLine take_oldest();

  // All of it begins as zeros: in static memory it takes no flash.
  std::int64_t beam_interval_ns_ = 0;
  float latency_s_ = 0.0f;
  std::int64_t max_wait_ns_ = 0;
  bool fixed_ = false, still_ = false;
  int oldest_ = 0, size_ = 0;
  std::array<Entry, capacity> entries_{};
  std::array<std::array<float, static_cast<std::size_t>(limits.beams)>, capacity> ranges_m_{};
  LineQueueCounters counters_{};
};

template <Limits limits, int capacity>
void LineQueue<limits, capacity>::init(const LaserSettings& laser, const TiltSettings& tilt, const PoseSettings& pose,
                                       float max_wait_s) {
  beam_interval_ns_ = laser.beam_interval_ns();
  latency_s_ = tilt.latency_s;
  max_wait_ns_ = to_ns(max_wait_s + (tilt.fixed ? 0.0f : std::max(0.0f, tilt.latency_s)));
  fixed_ = tilt.fixed;
  still_ = pose.still;
  oldest_ = size_ = 0;
  counters_ = LineQueueCounters{};
}

template <Limits limits, int capacity>
bool LineQueue<limits, capacity>::push(const ScanLine& line, std::int64_t now_ns) {
  ++counters_.pushed;
  const std::size_t beams = line.ranges_m.size();
  if (beams > static_cast<std::size_t>(limits.beams)) {
    ++counters_.too_long;
    return false;
  }
  if (!RisingTimes::is_time(line.time_ns)) {
    ++counters_.bad_time;
    return false;
  }
  if (size_ == capacity) {
    take_oldest();
    ++counters_.dropped;
  }
  const auto slot = static_cast<std::size_t>((oldest_ + size_++) % capacity);
  const std::int64_t last_beam_ns = line.time_ns + LaserSettings::duration_ns(beams, beam_interval_ns_);
  entries_[slot] = {line.time_ns, last_beam_ns, now_ns, beams};
  std::copy(line.ranges_m.begin(), line.ranges_m.end(), ranges_m_[slot].begin());
  return true;
}

template <Limits limits, int capacity>
std::optional<ScanLine> LineQueue<limits, capacity>::pop(const NewestTimes& newest, std::int64_t now_ns,
                                                         float offset_s) {
  if (size_ == 0) return std::nullopt;
  const Entry& entry = entries_[static_cast<std::size_t>(oldest_)];
  const std::int64_t late_ns = to_ns(latency_s_ + offset_s);
  const bool tilt_is_there = fixed_ || newest.tilt_ns >= entry.last_beam_ns + late_ns;
  const bool pose_is_there = still_ || newest.pose_ns >= entry.last_beam_ns;
  if (tilt_is_there && pose_is_there) {
    ++counters_.covered;
  } else if (now_ns - entry.arrival_ns > max_wait_ns_) {
    ++counters_.overdue;
  } else if (size_ == capacity) {
    ++counters_.crowded;
  } else {
    return std::nullopt;
  }
  return take_oldest();
}

template <Limits limits, int capacity>
ScanLine LineQueue<limits, capacity>::take_oldest() {
  const auto slot = static_cast<std::size_t>(oldest_);
  oldest_ = (oldest_ + 1) % capacity;
  --size_;
  return {entries_[slot].time_ns, std::span<const float>(ranges_m_[slot].data(), entries_[slot].beams)};
}

}  // namespace curbline
