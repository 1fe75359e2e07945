// Tilt frames of a log or bus, decoded and fed in order up to the time for which a scan line needs them: what would
// have reached the robot's computer by then.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>

#include "curbline/can/frame.hpp"
#include "curbline/can/tilt_decoder.hpp"
#include "curbline/intake/rising_times.hpp"
#include "curbline/tilt_reading.hpp"
#include "robot/robot.hpp"

namespace curbline::tools {

class TiltFeed {
 public:
  explicit TiltFeed(const Robot& robot) : max_gap_ns_(static_cast<std::int64_t>(robot.tilt.max_gap_s * 1e9f)) {
    decoder_.init(robot.tilt_signal, robot.tilt_sync_id);
  }

  /// Feeds frames up to the first reading at or after a time. `next` gives the next frame, or nothing at the end and
  /// while a bus is silent; `take` takes each with the reading that it completes, if any. False if frames did not reach
  /// so far.
  template <typename Next, typename Take>
  bool feed(std::int64_t until_ns, Next&& next, Take&& take) {
    while (fed_until_ns_ < until_ns) {
      const auto decoded = pop(next);
      if (!decoded) return false;
      take(decoded->frame, decoded->reading);
      if (decoded->reading && !is_damaged(decoded->reading->time_ns, until_ns, next))
        fed_until_ns_ = decoded->reading->time_ns;
    }
    return true;
  }
  /// There are no more frames: scan lines need not wait.
  void end() { fed_until_ns_ = std::numeric_limits<std::int64_t>::max(); }

  /// Time of the newest reading fed, damaged ones aside; INT64_MIN before the first, INT64_MAX after end().
  std::int64_t fed_until_ns() const { return fed_until_ns_; }
  can::TiltDecoderCounters counters() const { return decoder_.counters(); }

 private:
  struct Decoded {
    can::Frame frame;
    std::optional<TiltReading> reading;
  };

  template <typename Next>
  std::optional<Decoded> read(Next&& next) {
    const auto frame = next();
    if (!frame) return std::nullopt;
    return Decoded{*frame, decoder_.take(*frame)};
  }

  template <typename Next>
  std::optional<Decoded> pop(Next&& next) {
    if (ahead_.empty()) return read(next);
    const Decoded decoded = ahead_.front();
    ahead_.pop_front();
    return decoded;
  }

  /// Whether a time is too far ahead of the one waited for to be of use, and an earlier one follows: it would hold back
  /// all others. After a real gap, no earlier one follows.
  template <typename Next>
  bool is_damaged(std::int64_t time_ns, std::int64_t until_ns, Next&& next) {
    if (time_ns <= until_ns + max_gap_ns_) return false;
    const auto has_reading = [](const Decoded& decoded) { return decoded.reading.has_value(); };
    while (std::count_if(ahead_.begin(), ahead_.end(), has_reading) <= RisingTimes::most_refused) {
      const auto decoded = read(next);
      if (!decoded) break;
      ahead_.push_back(*decoded);
    }
    return std::any_of(ahead_.begin(), ahead_.end(),
                       [&](const Decoded& decoded) { return decoded.reading && decoded.reading->time_ns < time_ns; });
  }

  can::TiltDecoder decoder_;
  std::int64_t max_gap_ns_;
  std::deque<Decoded> ahead_;  ///< read and not fed yet
  std::int64_t fed_until_ns_ = std::numeric_limits<std::int64_t>::min();
};

}  // namespace curbline::tools
