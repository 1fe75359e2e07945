// Log times for the frames of a live bus on which a recording is replayed: used by replay and the daemon for tilt
// frames if the scan lines come from a log. tilt_frames.hpp gives the reason.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "curbline/can/signal.hpp"
#include "formats/can_log.hpp"

namespace curbline::tools {

/// The times at which the frames of a signal were recorded, assigned to the same frames when they are received in the
/// same order.
class RecordedTimes {
 public:
  RecordedTimes(const std::string& log, const can::Signal& signal, std::optional<std::uint16_t> sync_id)
      : log_(log), signal_(signal), sync_id_(sync_id) {}

  /// Reads the whole log now; nothing is allocated after that.
  void read_all();

  /// The recorded time of a frame that is due around `due_ns` (log time; the first frame may be any of the first 10 s).
  /// The frame must be the next recorded one, or an equal one recorded at most a second before or 0.2 s after the due
  /// time; nothing if there is none. Recorded frames before it count as missed.
  std::optional<std::int64_t> time_of(const can::Frame& frame, std::optional<std::int64_t> due_ns);

  /// Whether every recorded frame has been matched or missed.
  bool ended();
  long missed() const { return missed_; }
  const std::string& path() const { return log_.path(); }

 private:
  bool read_one();
  bool wanted(const can::Frame& frame) const;

  CanLogReader log_;
  can::Signal signal_;
  std::optional<std::uint16_t> sync_id_;
  std::deque<can::Frame> ahead_;  ///< read and not matched yet, in order of time
  std::int64_t newest_ns_ = INT64_MIN;
  bool at_end_ = false;
  long missed_ = 0;
};

/// Converts the bus's time to the log's: recorded times if there are any, otherwise a constant offset, as if the first
/// frame had come at the time of the first scan line.
class LogClock {
 public:
  explicit LogClock(std::optional<RecordedTimes> recorded = std::nullopt) : recorded_(std::move(recorded)) {}

  /// Frames keep the bus's time.
  static LogClock of_the_bus();
  /// For a scan log: recorded times are those of the CAN log of its recording, NAME.candump beside NAME.carmen, or
  /// can.log.
  static LogClock of_log(const std::string& scans, const can::Signal& signal, std::optional<std::uint16_t> sync_id);

  /// Sets a frame's time to that in the log. `line_ns` is the time of the scan line that waits for it.
  void set_log_time(can::Frame& frame, std::int64_t line_ns);

  /// Log time minus bus time; nothing before the first frame.
  std::optional<std::int64_t> offset_ns() const { return offset_ns_; }
  /// A remark for the user if there is no CAN log beside the scan log: the time of the first frame is then a guess.
  /// Otherwise empty.
  const std::string& guess() const { return guess_; }
  long not_recorded() const { return not_recorded_; }  ///< frames that are not in the recording
  RecordedTimes* recorded() { return recorded_ ? &*recorded_ : nullptr; }
  const RecordedTimes* recorded() const { return recorded_ ? &*recorded_ : nullptr; }

 private:
  std::optional<RecordedTimes> recorded_;
  std::optional<std::int64_t> offset_ns_;
  std::string guess_;
  long not_recorded_ = 0;
};

}  // namespace curbline::tools
