// The two kinds of JSON lines that the daemon outputs; README.md describes them for those who read them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "curb_server.hpp"
#include "curbline/can/tilt_decoder.hpp"
#include "curbline/counters.hpp"
#include "curbline/curbs/curb.hpp"
#include "curbline/intake/line_queue.hpp"
#include "curbline/intake/source_watch.hpp"
#include "curbline/intake/tilt_latency.hpp"
#include "latency_histogram.hpp"
#include "scanner_thread.hpp"
#include "socketcan/socketcan.hpp"

namespace curbline::daemon {

/// For a moving robot.
struct PoseReport {
  const SourceWatch* watch = nullptr;  ///< nullptr: the robot is stationary
  std::string_view wanted{};           ///< where the poses come from, for the user
  std::uint64_t taken = 0, damaged = 0;
};

/// For a robot on a CAN bus.
struct BusReport {
  socketcan::LinkState link = socketcan::LinkState::closed;
  socketcan::BusState state = socketcan::BusState::active;
  socketcan::Counters counters{};
};

/// The contents of a status line. nullptr: the robot does not have this part.
struct Report {
  std::int64_t time_ns = 0;
  double uptime_s = 0, scan_line_s = 0;
  const SourceWatch* tilt = nullptr;
  const SourceWatch* nod = nullptr;  ///< stale if the tilt rests
  std::string_view wanted_tilt{};    ///< the first frame that is waited for, for the user
  const can::TiltDecoderCounters* tilt_frames = nullptr;
  const TiltLatency* tilt_latency = nullptr;
  bool angles_in_doubt = false;     ///< they are not radians: streams/radians_watch.hpp
  std::uint64_t angles_beyond = 0;  ///< more than a turn from where a sweep began, while that was so
  PoseReport poses{};
  std::optional<BusReport> bus{};
  const ScannerState* scanner = nullptr;
  const SourceWatch* sight = nullptr;  ///< of the window, by the laser
  LineQueueCounters lines{};
  std::uint64_t lines_without_tilt = 0, lines_without_pose = 0;  ///< dropped, though frames or poses come
  Counters pipeline{};
  std::size_t curbs = 0;
  std::uint32_t curbs_left_out = 0;
  int clients = 0;
  ServerCounters server{};
  const LatencyHistogram* latency = nullptr;  ///< tilt frame to curbs
  const LatencyHistogram* work = nullptr;     ///< a scan line in the pipeline
  std::uint64_t not_recorded = 0;             ///< tilt frames that are not in the recording beside a log
  std::uint64_t heap_calls_before = 0, heap_calls_since = 0;
};

/// The most serious problem, as a word: ok, can_down, bus_off, tilt_missing, tilt_stale, poses_missing, poses_stale,
/// scanner_lost, tilt_not_radians, laser_blind or tilt_resting.
std::string_view state_of(const Report& status);

std::string_view status_line(const Report& status, std::span<char> buffer);

/// All curbs of the window after a scan line, in the pipeline's order. `left_out` counts those that do not fit.
std::string_view curbs_line(std::int64_t time_ns, std::span<const Curb> curbs, std::span<char> buffer,
                            std::uint32_t& left_out);

}  // namespace curbline::daemon
