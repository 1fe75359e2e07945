// The angle of the tilt servo over time. Readings come from an interrupt or another thread, in their own rhythm; a scan
// line takes a snapshot and asks for the angle at each beam's time.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "curbline/extrapolation.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/rising_times.hpp"
#include "curbline/settings.hpp"
#include "curbline/tilt_reading.hpp"

namespace curbline {

/// The angle at one time.
struct TiltAngle {
  enum class Source : std::uint8_t { none, interpolated, extrapolated };
  Source source = Source::none;
  float angle_rad = 0.0f;
  float rate_rad_s = 0.0f;  ///< by which the angle would differ if time did: over 15 ms about it, if there are readings
};

/// Readings as they were at one moment, ascending in time; times are those at which the angles were true. Ask with
/// rising times: a cursor makes each question O(1) on average.
template <Limits limits>
class TiltSnapshot {
 public:
  TiltAngle at(std::int64_t time_ns);
  /// Number of the reading up to which the last answer goes; the same for all times between two readings.
  std::uint32_t reading_number() const { return written_ - static_cast<std::uint32_t>(size_ - cursor_); }
  /// Lets the next question be an earlier one.
  void rewind() { cursor_ = 0; }

 private:
  template <Limits>
  friend class TiltTrack;
  /// Not inlined, so that at() is, which is asked for each beam: 16,000 instructions a line of a Cortex-M7.
  [[gnu::noinline]] TiltAngle find(std::int64_t time_ns);
  TiltAngle beyond(std::int64_t time_ns, int end, int inward) const;
  static float seconds(std::int64_t ns) { return to_float(ns) * 1e-9f; }
  static float slope_rad_s(const TiltReading& a, const TiltReading& b) {
    return (b.angle_rad - a.angle_rad) * 1e9f / to_float(b.time_ns - a.time_ns);
  }
  static TiltAngle alone(std::int64_t time_ns, const TiltReading& reading);
  float rate_about(int before, int after, float own_rad_s) const;
  const TiltReading& reading(int k) const { return readings_[static_cast<std::size_t>(k)]; }

  std::array<TiltReading, limits.tilt_samples> readings_{};
  int size_ = 0;
  int awaited_ = 0;            ///< readings up to the first later than the line's last beam
  std::uint32_t written_ = 0;  ///< readings up to the newest of them, since init()
  int cursor_ = 0;             ///< readings_[cursor_] is the first later than the last question, or size_
  std::int64_t max_gap_ns_ = 0, max_extrapolation_ns_ = 0;
  float angle_variance_ = 0.0f, time_variance_s2_ = 0.0f;  ///< of a reading
  // Between the two readings that the last question fell between: empty if it did not.
  std::int64_t segment_from_ns_ = 0, segment_to_ns_ = 0;
  float segment_angle_rad_ = 0.0f, segment_slope_rad_s_ = 0.0f, segment_rate_rad_s_ = 0.0f;

  /// Rates are told over as long a time at least. Stamps jitter by a millisecond: two frames at 50 Hz tell a rate to
  /// 7 %, at 100 Hz to 14 %, and those of a servo that reports at 1 kHz any.
  static constexpr std::int64_t rate_span_ns = 15'000'000;
};

/// Ring of the newest readings. One writer, one reader, neither ever waits.
template <Limits limits>
class TiltTrack {
  static_assert(
      limits.tilt_samples >= 4 && (limits.tilt_samples & (limits.tilt_samples - 1)) == 0,
      "tilt_samples must be a power of two, for the count of readings wraps, and 4 at least: a snapshot leaves "
      "one out, and a rate wants two");

 public:
  /// Forgets all readings. Before the interrupt that calls push() is enabled, or with it masked; not beside push() of
  /// another thread.
  void init(const TiltSettings& settings) {
    settings_ = settings;
    written_.store(0, std::memory_order_relaxed);
    dropped_.store(0, std::memory_order_relaxed);
    times_ = RisingTimes{};
  }

  /// Takes a reading; false (and counted) if it is not within TiltReading::furthest_rad or not later than the one
  /// before (rising_times.hpp). O(1), wait-free: may be called from an interrupt while another context takes snapshots.
  /// One writer only.
  bool push(const TiltReading& reading);

  /// Copies the readings. O(tilt_samples). A reading that the writer may have been replacing meanwhile is left out.
  /// `offset_s` is added to TiltSettings::latency_s. `until_ns` is the line's last beam: how many readings have come
  /// beyond the first that is later changes nothing of what is told between readings.
  void snapshot(TiltSnapshot<limits>& out, float offset_s, std::int64_t until_ns) const;

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
  RisingTimes times_{};  ///< the writer's
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
void TiltTrack<limits>::snapshot(TiltSnapshot<limits>& out, float offset_s, std::int64_t until_ns) const {
  const std::uint32_t capacity = limits.tilt_samples;
  const std::uint32_t before = written_.load(std::memory_order_acquire);
  const std::uint32_t count = before < capacity ? before : capacity;
  const auto latency_ns = static_cast<std::int64_t>((settings_.latency_s + offset_s) * 1e9f);
  for (std::uint32_t k = 0; k < count; ++k) {
    const Entry& entry = entries_[(before - count + k) % capacity];
    const std::uint64_t low = entry.time_low.load(std::memory_order_relaxed);
    const std::uint64_t high = entry.time_high.load(std::memory_order_relaxed);
    out.readings_[k] = {static_cast<std::int64_t>(high << 32 | low) - latency_ns,
                        std::bit_cast<float>(entry.angle.load(std::memory_order_relaxed))};
  }
  std::atomic_thread_fence(std::memory_order_acquire);
  // What the writer added meanwhile, and what it may be writing now, has replaced the oldest.
  const std::uint32_t added = written_.load(std::memory_order_relaxed) - before + 1;
  const std::uint32_t room = capacity - count;
  const std::uint32_t lost = added > room ? added - room : 0;
  const std::uint32_t whole = lost < count ? count - lost : 0;
  std::uint32_t kept = whole > 0 ? 1 : 0;  // what came before the times went back is of another time
  while (kept < whole && out.readings_[count - kept - 1].time_ns < out.readings_[count - kept].time_ns) ++kept;
  for (std::uint32_t k = 0; k < kept; ++k) out.readings_[k] = out.readings_[count - kept + k];
  out.size_ = out.awaited_ = static_cast<int>(kept);
  while (out.awaited_ > 1 && out.reading(out.awaited_ - 2).time_ns > until_ns) --out.awaited_;
  out.written_ = before;
  out.cursor_ = 0;
  out.segment_from_ns_ = out.segment_to_ns_ = 0;
  out.max_gap_ns_ = static_cast<std::int64_t>(settings_.max_gap_s * 1e9f);
  out.max_extrapolation_ns_ = static_cast<std::int64_t>(settings_.max_extrapolation_s * 1e9f);
  out.angle_variance_ = square(settings_.angle_sd_rad);
  out.time_variance_s2_ = square(settings_.time_sd_s);
}

template <Limits limits>
TiltAngle TiltSnapshot<limits>::at(std::int64_t time_ns) {
  if (time_ns < segment_from_ns_ || time_ns >= segment_to_ns_) return find(time_ns);
  const auto since_s = static_cast<float>(static_cast<std::int32_t>(time_ns - segment_from_ns_)) * 1e-9f;
  return {TiltAngle::Source::interpolated, segment_angle_rad_ + since_s * segment_slope_rad_s_, segment_rate_rad_s_};
}

/// The angle at a time outside the segment in hand; makes the segment that the time lies in, if it does, the one in
/// hand.
template <Limits limits>
TiltAngle TiltSnapshot<limits>::find(std::int64_t time_ns) {
  segment_from_ns_ = segment_to_ns_ = 0;
  while (cursor_ < size_ && reading(cursor_).time_ns <= time_ns) ++cursor_;
  if (size_ == 0) return {};
  if (cursor_ == 0) return beyond(time_ns, 0, 1);
  if (cursor_ == size_) return beyond(time_ns, size_ - 1, -1);
  const TiltReading &a = reading(cursor_ - 1), &b = reading(cursor_);
  if (b.time_ns - a.time_ns > max_gap_ns_) return alone(time_ns, a);
  const float slope = slope_rad_s(a, b), rate_rad_s = rate_about(cursor_ - 1, cursor_, slope);
  if (b.time_ns - a.time_ns <= INT32_MAX) {
    segment_from_ns_ = a.time_ns;
    segment_to_ns_ = b.time_ns;
    segment_angle_rad_ = a.angle_rad;
    segment_slope_rad_s_ = slope;
    segment_rate_rad_s_ = rate_rad_s;
  }
  return {TiltAngle::Source::interpolated, a.angle_rad + seconds(time_ns - a.time_ns) * slope, rate_rad_s};
}

/// About two readings, of which the rate from one to the other is `own_rad_s`: with those around them, as long as they
/// are too close to tell it. If they lie off that by three standard deviations, near a turn of the servo or a damaged
/// reading, their own.
template <Limits limits>
float TiltSnapshot<limits>::rate_about(int before, int after, float own_rad_s) const {
  const auto goes_on = [this](int k) { return reading(k + 1).time_ns - reading(k).time_ns <= max_gap_ns_; };
  int from = before, to = after;
  while (reading(to).time_ns - reading(from).time_ns < rate_span_ns) {
    const bool earlier = from > 0 && goes_on(from - 1), later = to + 1 < awaited_ && goes_on(to);
    if (!earlier && !later) break;
    from -= earlier;
    to += later;
  }
  const float rate_rad_s = slope_rad_s(reading(from), reading(to));
  const float off_rad = (own_rad_s - rate_rad_s) * seconds(reading(after).time_ns - reading(before).time_ns);
  const float variance = 2.0f * (angle_variance_ + square(rate_rad_s) * time_variance_s2_);
  return square(off_rad) <= gate * variance ? rate_rad_s : own_rad_s;
}

/// The angle at an end of the readings or beyond it, at their rate there. `inward` is the way to the other end.
template <Limits limits>
TiltAngle TiltSnapshot<limits>::beyond(std::int64_t time_ns, int end, int inward) const {
  const std::int64_t end_ns = reading(end).time_ns;
  const std::int64_t beyond_ns = inward > 0 ? end_ns - time_ns : time_ns - end_ns;
  if (beyond_ns > max_extrapolation_ns_) return {};
  const int other = sample_for_rate(time_ns, end, inward, size_, [this](int k) { return reading(k).time_ns; });
  if (other < 0) return alone(time_ns, reading(end));
  const int before = inward > 0 ? end : other, after = inward > 0 ? other : end;
  const TiltReading &a = reading(before), &b = reading(after);
  if (b.time_ns - a.time_ns > max_gap_ns_) return alone(time_ns, reading(end));
  const float rate_rad_s = rate_about(before, after, slope_rad_s(a, b));
  return {beyond_ns > 0 ? TiltAngle::Source::extrapolated : TiltAngle::Source::interpolated,
          reading(end).angle_rad + seconds(time_ns - end_ns) * rate_rad_s, rate_rad_s};
}

/// Of one reading, or beside a gap too wide to say anything of the time between: good at its own moment only.
template <Limits limits>
TiltAngle TiltSnapshot<limits>::alone(std::int64_t time_ns, const TiltReading& reading) {
  if (time_ns != reading.time_ns) return {};
  return {TiltAngle::Source::interpolated, reading.angle_rad, 0.0f};
}

}  // namespace curbline
