// Whether the tilt servo is alive: says once that it went silent and once that it came back, so that a daemon or a
// board can tell its user. A localisation likewise, with poses for readings. Beside the way of the data: the pipeline
// drops what lies beyond its bound on extrapolation by itself.
//
// No clock: times come in, of one time base. update() takes constant time and belongs to one context; what it asks for,
// the newest reading's time, may come from an interrupt as long as it is read whole.
#pragma once

#include <cstdint>
#include <limits>

namespace curbline {

enum class TiltState : std::uint8_t {
  never,  ///< no reading yet
  ok,     ///< or there is no servo: the tilt is fixed
  stale,  ///< the newest reading is older than the bound
};

/// What update() saw happen. Each is told once.
enum class TiltEvent : std::uint8_t {
  none,
  missing,    ///< no reading since the start, for longer than the bound
  first,      ///< the first reading, a fresh one
  lost,       ///< ok to stale, or the first reading is stale already
  recovered,  ///< stale to ok
};

class TiltWatch {
 public:
  /// What newest_ns is as long as there is no reading.
  static constexpr std::int64_t no_reading = std::numeric_limits<std::int64_t>::min();

  /// Starts afresh. stale_after_s: a servo that is silent for longer is stale. TiltSettings::max_gap_s is a good
  /// choice: beams in a longer gap have no angle. `fixed`, as in TiltSettings: nothing is watched, all is well.
  void init(float stale_after_s, bool fixed) {
    *this = TiltWatch{};
    stale_after_ns_ = static_cast<std::int64_t>(stale_after_s * 1e9f);
    fixed_ = fixed;
    if (fixed) state_ = TiltState::ok;
  }

  /// Call as often as the answer matters, say with every scan line. newest_ns: time of the newest reading.
  TiltEvent update(std::int64_t newest_ns, std::int64_t now_ns);

  TiltState state() const { return state_; }
  std::uint32_t times_lost() const { return times_lost_; }
  /// Age of the newest reading when it was greatest, as far as update() saw; 0 before the first.
  std::int64_t longest_silence_ns() const { return longest_silence_ns_; }

 private:
  TiltEvent update_never(std::int64_t now_ns);

  TiltState state_ = TiltState::never;
  bool fixed_ = false, started_ = false, missing_told_ = false;
  std::int64_t stale_after_ns_ = 0;
  std::int64_t start_ns_ = 0;  ///< of the first update
  std::int64_t longest_silence_ns_ = 0;
  std::uint32_t times_lost_ = 0;
};

inline TiltEvent TiltWatch::update(std::int64_t newest_ns, std::int64_t now_ns) {
  if (fixed_) return TiltEvent::none;
  if (newest_ns == no_reading) return state_ == TiltState::never ? update_never(now_ns) : TiltEvent::none;
  const std::int64_t silence_ns = now_ns - newest_ns;  // below 0 if the clocks differ: fresh
  if (silence_ns > longest_silence_ns_) longest_silence_ns_ = silence_ns;
  const TiltState before = state_;
  state_ = silence_ns > stale_after_ns_ ? TiltState::stale : TiltState::ok;
  if (state_ == before) return TiltEvent::none;
  if (state_ == TiltState::ok) return before == TiltState::never ? TiltEvent::first : TiltEvent::recovered;
  ++times_lost_;
  return TiltEvent::lost;
}

inline TiltEvent TiltWatch::update_never(std::int64_t now_ns) {
  if (!started_) {
    started_ = true;
    start_ns_ = now_ns;
  }
  if (missing_told_ || now_ns - start_ns_ <= stale_after_ns_) return TiltEvent::none;
  missing_told_ = true;
  return TiltEvent::missing;
}

}  // namespace curbline
