// Whether a source of readings, the tilt servo or the localisation, is alive, and whether readings still show what they
// should: says once that it ceased and once that it came back, so that a daemon or a board can tell its user. Beside
// the way of the data: the pipeline drops what lies beyond its bound on extrapolation by itself.
//
// No clock: times come in, of one time base. update() takes constant time and belongs to one context; what it asks for,
// the newest reading's time, may come from an interrupt as long as it is read whole.
#pragma once

#include <cstdint>

#include "curbline/intake/rising_times.hpp"
#include "curbline/math.hpp"

namespace curbline {

enum class SourceState : std::uint8_t {
  never,  ///< no reading yet
  ok,     ///< or there is nothing to watch: the tilt is fixed
  stale,  ///< the newest reading is older than the bound
};

/// What update() saw happen. Each is reported once.
enum class SourceEvent : std::uint8_t {
  none,
  missing,    ///< no reading since the start, for longer than the bound
  first,      ///< the first reading, a fresh one
  lost,       ///< ok to stale, or the first reading is stale already
  recovered,  ///< stale to ok
};

class SourceWatch {
 public:
  /// What newest_ns is as long as there is no reading.
  static constexpr std::int64_t no_reading = RisingTimes::none;

  /// Starts afresh. stale_after_s, 0 to 1e9: a source that is silent for longer is stale. For a servo
  /// TiltSettings::max_gap_s is a good choice: beams in a longer gap have no angle. `fixed`, as in TiltSettings:
  /// nothing is watched, all is well.
  void init(float stale_after_s, bool fixed) {
    *this = SourceWatch{};
    stale_after_ns_ = to_ns(stale_after_s);
    fixed_ = fixed;
    if (fixed) state_ = SourceState::ok;
  }

  /// Call as often as the answer matters, say with every scan line. newest_ns: time of the newest reading.
  SourceEvent update(std::int64_t newest_ns, std::int64_t now_ns);

  /// The bound, as init() was told it.
  std::int64_t stale_after_ns() const { return stale_after_ns_; }
  SourceState state() const { return state_; }
  std::uint32_t times_lost() const { return times_lost_; }
  /// Age of the newest reading when it was greatest, as far as update() saw; 0 before the first.
  std::int64_t longest_silence_ns() const { return longest_silence_ns_; }

 private:
  SourceEvent update_never(std::int64_t now_ns);

  SourceState state_ = SourceState::never;
  bool fixed_ = false, started_ = false, missing_reported_ = false;
  std::int64_t stale_after_ns_ = 0;
  std::int64_t start_ns_ = 0;  ///< of the first update
  std::int64_t longest_silence_ns_ = 0;
  std::uint32_t times_lost_ = 0;
};

/// The same for a sign that readings show now and then, by their own times: that the tilt moves (nod_watch.hpp), that
/// the laser sees the window (sight_watch.hpp).
class SignWatch {
 public:
  /// Starts afresh. longest_without_s: for how long no reading may show the sign. `fixed` as in SourceWatch.
  void init(float longest_without_s, bool fixed) {
    *this = SignWatch{};
    watch_.init(longest_without_s, fixed);
  }

  /// Does a reading of this time count as one with the sign, whatever it shows? The first does, as the sign is waited
  /// for as long as later, and one that is earlier than the last with the sign: the clock was set back.
  bool begins(std::int64_t time_ns) const { return first() || time_ns < shown_ns_; }
  /// Call with each reading. Lost, once no reading has shown the sign for the bound, or recovered.
  SourceEvent update(bool shows, std::int64_t time_ns) {
    const bool is_first = first();
    if (shows || begins(time_ns)) shown_ns_ = time_ns;
    const SourceEvent event = watch_.update(shown_ns_, time_ns);
    return is_first ? SourceEvent::none : event;
  }

  /// ok or stale as of that; never before the first reading.
  const SourceWatch& watch() const { return watch_; }

 private:
  bool first() const { return shown_ns_ == SourceWatch::no_reading; }

  SourceWatch watch_{};
  std::int64_t shown_ns_ = SourceWatch::no_reading;  ///< by the newest reading with the sign
};

inline SourceEvent SourceWatch::update(std::int64_t newest_ns, std::int64_t now_ns) {
  if (fixed_) return SourceEvent::none;
  if (newest_ns == no_reading) return state_ == SourceState::never ? update_never(now_ns) : SourceEvent::none;
  const std::int64_t silence_ns = now_ns - newest_ns;  // below 0 if the clocks differ: fresh
  if (silence_ns > longest_silence_ns_) longest_silence_ns_ = silence_ns;
  const SourceState before = state_;
  state_ = silence_ns > stale_after_ns_ ? SourceState::stale : SourceState::ok;
  if (state_ == before) return SourceEvent::none;
  if (state_ == SourceState::ok) return before == SourceState::never ? SourceEvent::first : SourceEvent::recovered;
  ++times_lost_;
  return SourceEvent::lost;
}

inline SourceEvent SourceWatch::update_never(std::int64_t now_ns) {
  if (!started_) {
    started_ = true;
    start_ns_ = now_ns;
  }
  if (missing_reported_ || now_ns - start_ns_ <= stale_after_ns_) return SourceEvent::none;
  missing_reported_ = true;
  return SourceEvent::missing;
}

}  // namespace curbline
