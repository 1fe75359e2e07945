// Times for scan lines that are stamped on arrival: on a host, over USB or TCP, they are 1 to 10 ms late, each by
// another delay, never early. The mirror turns steadily, so lines are whole turns apart; the straight line that
// supports the newest arrivals from below gives the turns, since only lines with hardly any delay touch it. Stands
// before the pipeline, unless the scanner's driver knows better:
//
//   scanner --> LineClock::time_of() --> LineQueue --> Pipeline::take()
//
//   - A stamp on a turn is kept: nothing changes for a scanner with exact stamps.
//   - Stamps are also kept where they lie anywhere between turns (a mean delay of half a turn), where a turn
//     differs by more than 1/200 from the settings, and at first, until there are enough.
//   - A stamp that goes back is passed on if it is not later than the newest time given: the pipeline drops and counts
//     the line. A later one gets no time.
//   - A line late by a turn or more looks like the next one after a loss. One that may be either gets no time: it
//     is better left out than mapped a turn off. So is the first line after a loss, if stamps jitter.
//
// A constant part of the delay is left to the tilt latency. No clock: times come in. 40 operations for each of 64 lines
// a call, 1.1 kB. One context.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "curbline/intake/rising_times.hpp"
#include "curbline/settings.hpp"

namespace curbline {

class LineClock {
 public:
  static constexpr int capacity = 64;  ///< arrivals that it keeps, the newest

  /// Starts afresh. A turn takes as many beam intervals as beams fill a circle (LaserSettings). With a beam interval of
  /// 0, as of a sensor that does not turn, all stamps are kept.
  void init(const LaserSettings& laser);

  /// The time at which the line with this stamp was measured: the stamp or, if it came late, an earlier time. Nothing
  /// if its turn is ambiguous, or if that time is not later than the last one given. Call for each line, in order of
  /// arrival.
  std::optional<std::int64_t> time_of(std::int64_t stamp_ns);

  std::uint32_t set_back() const { return set_back_; }  ///< lines that were given an earlier time
  std::uint32_t left_out() const { return left_out_; }  ///< lines that were given none

 private:
  struct Arrival {
    std::int64_t turn = 0, stamp_ns = 0;
  };
  struct Turns {
    std::int64_t count = 0;
    bool doubtful = false;  ///< or lines may have been lost, or a line have waited
  };

  void restart(std::int64_t stamp_ns);
  Turns turns_to(std::int64_t stamp_ns);
  bool take_back_lost(std::int64_t stamp_ns, std::int64_t turns);
  void add(std::int64_t turns, std::int64_t stamp_ns);
  void keep_newest(int count);
  void fit();
  const Arrival& arrival(int k) const { return arrivals_[static_cast<std::size_t>(k)]; }
  const Arrival& newest() const { return arrival(size_ - 1); }
  /// How much later a stamp is than the line so many turns after the newest was.
  float late_ns(std::int64_t stamp_ns, std::int64_t turns) const;
  float turn() const;

  std::int64_t turn_ns_ = 0;                  ///< by the settings; 0: stamps are kept
  std::array<Arrival, capacity> arrivals_{};  ///< the oldest first
  int size_ = 0;
  int enough_ = 0;                                 ///< arrivals that tell the turns
  float newest_late_ns_ = 0.0f;                    ///< of the newest, as all of them tell it
  float slower_ns_ = 0.0f;                         ///< by which a turn takes longer than by the settings
  float mean_late_ns_ = 0.0f;                      ///< of all of them
  bool steady_ = true;                             ///< turns take no other time than a motor's may
  std::int64_t usual_turns_ = 1, last_turns_ = 1;  ///< from line to line
  std::int64_t lost_turns_ = 0;                    ///< that were taken for lost before the newest
  int waited_ = 0;                ///< arrivals until one that came whole turns late is no longer among those kept
  int late_ = 0, turn_late_ = 0;  ///< consecutive arrivals later than usual, and by a turn and more
  RisingTimes stamps_{};
  std::int64_t time_ns_ = RisingTimes::none;  ///< the newest that was given
  std::uint32_t set_back_ = 0, left_out_ = 0;
};

}  // namespace curbline
