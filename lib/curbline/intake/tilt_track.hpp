// The angle of the tilt servo over time. Readings come from an interrupt or another thread, at their own rate; a scan
// line takes a snapshot of them (tilt_snapshot.hpp), without a lock.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "curbline/intake/rising_times.hpp"
#include "curbline/intake/tilt_snapshot.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/settings.hpp"
#include "curbline/tilt_reading.hpp"

namespace curbline {

/// Ring of the newest readings. One writer, one reader, neither ever waits.
template <Limits limits>
class TiltTrack {
  static_assert(
      limits.tilt_samples >= 4 && (limits.tilt_samples & (limits.tilt_samples - 1)) == 0,
      "tilt_samples must be a power of two, for the count of readings wraps, and 4 at least: a snapshot leaves "
      "one out, and a rate wants two");

 public:
  /// Forgets all readings. Call while nothing calls push(): with its interrupt masked or its thread stopped.
  void init(const TiltSettings& settings) {
    settings_ = settings;
    written_.store(0, std::memory_order_relaxed);
    dropped_.store(0, std::memory_order_relaxed);
    times_ = RisingTimes{};
    most_repeats_ = 0;
  }

  /// Takes a reading; false (and counted) if it is not within TiltReading::furthest_rad or not later than the one
  /// before (rising_times.hpp). O(1), wait-free: may be called from an interrupt while another context takes snapshots.
  /// One writer only.
  bool push(const TiltReading& reading);

  /// Copies the readings, except those that the writer may have replaced meanwhile. `offset_s` is added to
  /// TiltSettings::latency_s; `until_ns` is the time of the line's last beam. O(tilt_samples).
  void snapshot(TiltSnapshot<limits>& out, float offset_s, std::int64_t until_ns);

  std::uint32_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
  struct Entry {
    std::atomic<std::uint32_t> time_low{0}, time_high{0}, angle{0};
  };
  TiltSettings settings_{};
  std::array<Entry, limits.tilt_samples> entries_{};
  std::atomic<std::uint32_t> written_{0};  ///< readings taken since init, modulo 2^32 but never 0 again
  std::atomic<std::uint32_t> dropped_{0};
  RisingTimes times_{};   ///< the writer's
  int most_repeats_ = 0;  ///< the reader's: TiltSnapshot::most_repeats() so far
};

template <Limits limits>
bool TiltTrack<limits>::push(const TiltReading& reading) {
  constexpr float furthest_rad = TiltReading::furthest_rad;
  if (!(reading.angle_rad >= -furthest_rad && reading.angle_rad <= furthest_rad) || !times_.admits(reading.time_ns)) {
    dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    return false;
  }
  times_.take(reading.time_ns);
  const std::uint32_t n = written_.load(std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);  // no store below is seen before the count above
  Entry& entry = entries_[n % limits.tilt_samples];
  const auto time = static_cast<std::uint64_t>(reading.time_ns);
  entry.time_low.store(static_cast<std::uint32_t>(time), std::memory_order_relaxed);
  entry.time_high.store(static_cast<std::uint32_t>(time >> 32), std::memory_order_relaxed);
  entry.angle.store(std::bit_cast<std::uint32_t>(reading.angle_rad), std::memory_order_relaxed);
  // 0 is an empty ring: after 2^32 - 1 comes a full one. A snapshot taken meanwhile may lose its readings.
  written_.store(n + 1 != 0 ? n + 1 : limits.tilt_samples, std::memory_order_release);
  return true;
}

template <Limits limits>
void TiltTrack<limits>::snapshot(TiltSnapshot<limits>& out, float offset_s, std::int64_t until_ns) {
  const std::uint32_t capacity = limits.tilt_samples;
  const std::uint32_t before = written_.load(std::memory_order_acquire);
  const std::uint32_t count = before < capacity ? before : capacity;
  const std::int64_t latency_ns = to_ns(settings_.latency_s + offset_s);
  for (std::uint32_t k = 0; k < count; ++k) {
    const Entry& entry = entries_[(before - count + k) % capacity];
    const std::uint64_t low = entry.time_low.load(std::memory_order_relaxed);
    const std::uint64_t high = entry.time_high.load(std::memory_order_relaxed);
    out.put(k, {static_cast<std::int64_t>(high << 32 | low) - latency_ns,
                std::bit_cast<float>(entry.angle.load(std::memory_order_relaxed))});
  }
  std::atomic_thread_fence(std::memory_order_acquire);
  // What the writer added meanwhile, and what it may be writing now, has replaced the oldest.
  const std::uint32_t added = written_.load(std::memory_order_relaxed) - before + 1;
  const std::uint32_t room = capacity - count;
  const std::uint32_t lost = added > room ? added - room : 0;
  const std::uint32_t whole = lost < count ? count - lost : 0;
  out.begin(count, whole, before, settings_, until_ns, most_repeats_);
  most_repeats_ = out.most_repeats();
}

}  // namespace curbline
