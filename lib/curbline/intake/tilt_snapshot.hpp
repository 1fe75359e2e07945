// The angle of the tilt servo at each beam of a line, interpolated between the readings that a TiltTrack held when the
// line came, and extrapolated a little. A driver that has no new angle may send its last one again, under a new stamp:
// between readings that show how the servo moved, such a repeat is replaced by the angle on the line through them.
// Working memory of one line. Cost: a step a beam, a search for the rate a reading, a comparison for every second one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "curbline/intake/extrapolation.hpp"
#include "curbline/limits.hpp"
#include "curbline/math.hpp"
#include "curbline/settings.hpp"
#include "curbline/tilt_reading.hpp"

namespace curbline {

/// The angle at one time.
struct TiltAngle {
  enum class Source : std::uint8_t { none, interpolated, extrapolated };
  Source source = Source::none;
  float angle_rad = 0.0f;
  float rate_rad_s = 0.0f;  ///< over at least 15 ms around the time, if there are readings
};

/// Readings ascending in time; times are those at which the angles were true.
template <Limits limits>
class TiltSnapshot {
 public:
  /// For TiltTrack: put() stores `count` readings, number 0 the oldest, and begin() uses the newest `whole` of them, as
  /// far as their times rise. `written` counts the readings up to the newest since init(). Of those after `until_ns`,
  /// the line's last beam, angles between readings use the first alone, so that they do not depend on how long the line
  /// has waited. `repeats`: the longest row of repeats that earlier snapshots have seen.
  void put(std::uint32_t number, const TiltReading& reading) { readings_[number] = reading; }
  void begin(std::uint32_t count, std::uint32_t whole, std::uint32_t written, const TiltSettings& settings,
             std::int64_t until_ns, int repeats);

  /// The longest row of repeats that these and this one have seen.
  int most_repeats() const { return most_repeats_; }

  /// The angle at a time; Source::none where no readings are near. Times must not fall, except after rewind(). O(1) on
  /// average.
  TiltAngle at(std::int64_t time_ns);
  /// Number of the reading that follows the last time asked for; the same for all times between two readings.
  std::uint32_t reading_number() const { return written_ - static_cast<std::uint32_t>(size_ - cursor_); }
  /// Allows the next time to be an earlier one.
  void rewind() {
    cursor_ = 0;
    segment_from_ns_ = segment_to_ns_ = 0;
  }

 private:
  /// Not inlined, so that at() is, which runs for each beam: saves 16,000 instructions a line on a Cortex-M7.
  [[gnu::noinline]] TiltAngle find(std::int64_t time_ns);
  TiltAngle beyond(std::int64_t time_ns, int end, int inward) const;
  static float seconds(std::int64_t ns) { return to_float(ns) * 1e-9f; }
  static float slope_rad_s(const TiltReading& a, const TiltReading& b) {
    return (b.angle_rad - a.angle_rad) * 1e9f / to_float(b.time_ns - a.time_ns);
  }
  static TiltAngle alone(std::int64_t time_ns, const TiltReading& reading);
  float rate_about(int before, int after, float own_rad_s) const;
  void fill_repeats();
  int other_angle(int after) const;
  bool moves(int from, int to) const;
  bool tells(int before, int at, int next) const;
  bool goes_on(int before, int at, int next) const;
  void fill(int at, int next, float rate_rad_s);
  const TiltReading& reading(int k) const { return readings_[static_cast<std::size_t>(k)]; }

  std::array<TiltReading, limits.tilt_samples> readings_{};
  int size_ = 0;
  int most_repeats_ = 0;       ///< in a row
  int awaited_ = 0;            ///< readings up to the first one later than the line's last beam
  std::uint32_t written_ = 0;  ///< readings up to the newest, since init()
  int cursor_ = 0;             ///< the first reading later than the last time asked for, or size_
  std::int64_t max_gap_ns_ = 0, max_extrapolation_ns_ = 0;
  float angle_variance_ = 0.0f, time_variance_s2_ = 0.0f;  ///< of a reading
  // The segment between two readings that the last time fell into; empty at first.
  std::int64_t segment_from_ns_ = 0, segment_to_ns_ = 0;
  float segment_angle_rad_ = 0.0f, segment_slope_rad_s_ = 0.0f, segment_rate_rad_s_ = 0.0f;

  /// Shortest time over which a rate is computed. Stamps jitter by a millisecond: two frames at 50 Hz give a rate to 7
  /// %, at 100 Hz to 14 %, and at 1 kHz any.
  static constexpr std::int64_t rate_span_ns = 15'000'000;
};

template <Limits limits>
void TiltSnapshot<limits>::begin(std::uint32_t count, std::uint32_t whole, std::uint32_t written,
                                 const TiltSettings& settings, std::int64_t until_ns, int repeats) {
  std::uint32_t kept = whole > 0 ? 1 : 0;  // readings before times went back are of another time base
  while (kept < whole && readings_[count - kept - 1].time_ns < readings_[count - kept].time_ns) ++kept;
  for (std::uint32_t k = 0; k < kept; ++k) readings_[k] = readings_[count - kept + k];
  size_ = awaited_ = static_cast<int>(kept);
  while (awaited_ > 1 && reading(awaited_ - 2).time_ns > until_ns) --awaited_;
  written_ = written;
  cursor_ = 0;
  segment_from_ns_ = segment_to_ns_ = 0;
  max_gap_ns_ = to_ns(settings.max_gap_s);
  max_extrapolation_ns_ = to_ns(settings.max_extrapolation_s);
  angle_variance_ = square(settings.angle_sd_rad);
  time_variance_s2_ = square(settings.time_sd_s);
  most_repeats_ = repeats;
  fill_repeats();
}

/// Looks at half of what a track holds, up to the reading that the line has awaited, so that none depends on how many
/// have come since. Repeats that no other angle has followed yet may be those of a servo that has stopped, unless there
/// have been as many before.
template <Limits limits>
void TiltSnapshot<limits>::fill_repeats() {
  const int first = std::max(0, awaited_ - limits.tilt_samples / 2);  // which may itself be a repeat
  int before = first, at = other_angle(before);
  while (at < awaited_) {
    const int next = other_angle(at), repeats = next - at - 1;
    if (repeats > 0 && moves(before, at)) {
      if (next == awaited_) {
        if (repeats <= most_repeats_ && before > first && tells(before, at, next))
          fill(at, next, slope_rad_s(reading(before), reading(at)));
      } else if (moves(at, next) && goes_on(before, at, next)) {
        fill(at, next, slope_rad_s(reading(at), reading(next)));
        most_repeats_ = std::max(most_repeats_, repeats);
      }
    }
    before = at;
    at = next;
  }
}

/// The first reading after one whose angle is another; awaited_ if there is none.
template <Limits limits>
int TiltSnapshot<limits>::other_angle(int after) const {
  int k = after + 1;
  while (k < awaited_ && reading(k).angle_rad == reading(after).angle_rad) ++k;
  return k;
}

/// By a tenth more than a step of the servo's resolution, if its error is a step's alone (as deviations are stated,
/// rounded)? Not across a gap.
template <Limits limits>
bool TiltSnapshot<limits>::moves(int from, int to) const {
  return reading(to).time_ns - reading(from).time_ns <= max_gap_ns_ &&
         square(reading(to).angle_rad - reading(from).angle_rad) > 14.5f * angle_variance_;
}

/// May the rate from `before` to `at` be used up to the last repeat? As far as beyond() goes, and not if both stamps
/// lie close together (extrapolation.hpp).
template <Limits limits>
bool TiltSnapshot<limits>::tells(int before, int at, int next) const {
  const std::int64_t beyond_ns = reading(next - 1).time_ns - reading(at).time_ns;
  return beyond_ns <= max_extrapolation_ns_ && reading(at).time_ns - reading(before).time_ns >= beyond_ns / 4;
}

/// Has the servo not stood from `at` to the last repeat? Then its way to `next` is nearer to what the rate before makes
/// of all that time than to what it makes of the rest.
template <Limits limits>
bool TiltSnapshot<limits>::goes_on(int before, int at, int next) const {
  const std::int64_t all_ns = reading(next).time_ns - reading(at).time_ns;
  const std::int64_t left_ns = reading(next).time_ns - reading(next - 1).time_ns;
  const float by_rad = reading(next).angle_rad - reading(at).angle_rad;
  const float half_rad = slope_rad_s(reading(before), reading(at)) * 0.5f * seconds(all_ns + left_ns);
  return half_rad < 0.0f ? by_rad < half_rad : by_rad > half_rad;
}

/// Puts the repeats of `at` before `next` on a line.
template <Limits limits>
void TiltSnapshot<limits>::fill(int at, int next, float rate_rad_s) {
  for (int k = at + 1; k < next; ++k) {
    TiltReading& repeat = readings_[static_cast<std::size_t>(k)];
    repeat.angle_rad += seconds(repeat.time_ns - reading(at).time_ns) * rate_rad_s;
  }
}

template <Limits limits>
TiltAngle TiltSnapshot<limits>::at(std::int64_t time_ns) {
  if (time_ns < segment_from_ns_ || time_ns >= segment_to_ns_) return find(time_ns);
  const auto since_s = static_cast<float>(static_cast<std::int32_t>(time_ns - segment_from_ns_)) * 1e-9f;
  return {TiltAngle::Source::interpolated, segment_angle_rad_ + since_s * segment_slope_rad_s_, segment_rate_rad_s_};
}

/// The angle at a time outside the current segment; the segment around that time, if there is one, becomes the current.
template <Limits limits>
TiltAngle TiltSnapshot<limits>::find(std::int64_t time_ns) {
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

/// The rate around two readings: over as many more on both sides as make up rate_span_ns. `own_rad_s`, that between the
/// two, is used where they deviate from it by three standard deviations, near a reversal or at a damaged reading.
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

/// The angle at an end of the readings or beyond it, at the rate there. `inward` is the direction to the other end.
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

/// The angle of a single reading, or beside a gap too wide to interpolate: valid at its own time only.
template <Limits limits>
TiltAngle TiltSnapshot<limits>::alone(std::int64_t time_ns, const TiltReading& reading) {
  if (time_ns != reading.time_ns) return {};
  return {TiltAngle::Source::interpolated, reading.angle_rad, 0.0f};
}

}  // namespace curbline
