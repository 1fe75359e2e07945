// Whether the laser sees the window, so that "no curb" is told from "nobody looks": a covered laser gives scan lines,
// and the pipeline takes them, without a point. Beside the way of the data, as source_watch.hpp. The rule:
//
//   - A line that put points into the window's cells sees it.
//   - Of a line without a single return, of a laser that is covered or blind or looks into the open sky, nothing is
//     known: the laser does not see, at once.
//   - A line whose returns are all outside the window, as at one end of many sweeps, counts as long as a line that put
//     points into it is no older than the bound: a mount may have been knocked, a servo may hold.
//
// No clock: times are those of the lines. update() takes constant time; one context.
#pragma once

#include <cstdint>

#include "curbline/counters.hpp"
#include "curbline/intake/source_watch.hpp"

namespace curbline {

class SightWatch {
 public:
  /// Starts afresh, as must be done when the pipeline does, whose counters then begin at 0. longest_away_s: for how
  /// long the laser may look beside the window, a sweep there and back at most; of a laser at a fixed tilt as long as a
  /// bump of the way may turn it away.
  void init(float longest_away_s) {
    *this = SightWatch{};
    sees_.init(longest_away_s, false);
  }

  /// Call after each scan line that the pipeline was given, with its counters and the line's time. True if the line
  /// says something about the window as it is now; false, too, if it was dropped.
  bool update(const Counters& counters, std::int64_t line_ns);

  /// What the last update() saw happen: lost, once no line has put a point into the window for the bound, or recovered.
  SourceEvent event() const { return event_; }
  /// ok or stale as of that; never before the first line.
  const SourceWatch& watch() const { return sees_.watch(); }

 private:
  SignWatch sees_{};  ///< the sign: points that went into cells
  SourceEvent event_ = SourceEvent::none;
  std::uint32_t lines_ = 0, points_ = 0, outside_ = 0;  ///< counted before
};

inline bool SightWatch::update(const Counters& counters, std::int64_t line_ns) {
  const bool taken = counters.lines != lines_, inside = counters.points != points_;
  const bool returned = inside || counters.outside != outside_;
  lines_ = counters.lines;
  points_ = counters.points;
  outside_ = counters.outside;
  event_ = SourceEvent::none;
  if (!taken) return false;
  event_ = sees_.update(inside, line_ns);
  return returned && points_ > 0 && watch().state() == SourceState::ok;
}

}  // namespace curbline
