// The daemon: tilt frames of a CAN interface and scan lines of a log or scanner in, curbs out.
//
//   CAN --> SocketCan --> TiltDecoder --+--> Pipeline --> CurbServer (JSON lines), SocketCan (frames of the curb ahead)
//   scanner's thread --> LineInbox -----+
//   localisation --> PoseSource --------+
//
// One thread does everything except reading the scanner. It waits in poll(2), and never for a client, a scanner or a
// bus. All memory is allocated during construction; heap_trap.hpp checks that none is allocated later. A scan line goes
// into the pipeline as soon as a tilt reading and a pose cover its last beam, or after longest_wait_s without them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "curb_server.hpp"
#include "curbline/can/tilt_decoder.hpp"
#include "curbline/intake/nod_watch.hpp"
#include "curbline/intake/sight_watch.hpp"
#include "curbline/intake/source_watch.hpp"
#include "latency_histogram.hpp"
#include "line_inbox.hpp"
#include "pose_source.hpp"
#include "reports.hpp"
#include "robot/robot.hpp"
#include "scan_log.hpp"
#include "scanner_thread.hpp"
#include "service_manager.hpp"
#include "socketcan/socketcan.hpp"
#include "streams/host_pipeline.hpp"
#include "streams/radians_watch.hpp"
#include "streams/recorded_times.hpp"
#include "troubles.hpp"

namespace curbline::daemon {

struct Options {
  std::string can;    ///< interface; empty for a robot with a fixed tilt
  std::string scans;  ///< a log, or a scanner: streams/scanner_link.hpp
  std::string poses;  ///< pose_source.hpp; empty for a stationary robot
  std::string curbs;  ///< where clients connect: curb_server.hpp
  bool can_out = false;
};

class Daemon {
 public:
  /// Opens everything. Blocks SIGTERM, SIGINT and SIGHUP, for which run() waits. Throws BadInput.
  Daemon(const tools::Robot& robot, const Options& options);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// Runs until SIGTERM, SIGINT or SIGHUP, or to the end of a log of scan lines.
  void run();

  /// The current status line. Valid until the next call.
  std::string_view status();

 private:
  void open_bus(const tools::Robot& robot, const Options& options);
  void open_scans(const tools::Robot& robot, const Options& options);

  bool wait();
  int time_to_wait_ms() const;
  void take_clients();
  void take_frames();
  void take_frame(can::Frame frame);
  void take_log();
  void take_lines();
  void take_line(const ScanLine& line);
  void note_dropped(Status status);
  void give_curbs(std::int64_t line_ns);
  void send_curbs(bool sees);
  void look_around();
  void give_status();
  Report make_report();
  std::optional<std::int64_t> log_offset_ns() const;

  LaserSettings laser_;
  TiltSettings tilt_settings_;
  double scan_line_s_;
  int signals_ = -1;
  CurbServer server_;
  ServiceManager service_;
  std::unique_ptr<tools::HostPipeline> pipeline_;
  LineInbox inbox_;

  bool has_bus_ = false, can_out_ = false;
  socketcan::SocketCan bus_;
  can::TiltDecoder tilt_decoder_;
  can::TiltDecoderCounters tilt_counters_{};
  SourceWatch tilt_watch_;
  NodWatch nod_watch_;
  tools::RadiansWatch radians_watch_;
  SourceEvent nod_event_ = SourceEvent::none;  ///< to be told
  std::string wanted_tilt_;                    ///< name of the frame that is waited for, for the user
  tools::LogClock clock_ = tools::LogClock::of_the_bus();
  std::array<can::Frame, socketcan::SocketCan::batch> frames_{};
  std::int64_t newest_tilt_ns_ = NewestTimes::none;           ///< as the pipeline has it
  std::int64_t newest_frame_ns_ = 0;                          ///< when the kernel received it
  std::int64_t newest_arrival_ns_ = SourceWatch::no_reading;  ///< when the daemon received it, steady clock
  bool by_frame_ = false;                                     ///< the lines are being processed because a frame came

  PoseSource poses_;
  std::optional<ScanLog> log_;
  std::optional<std::int64_t> fixed_offset_ns_;  ///< log time minus host time, if there are no frames to derive it from

  std::int64_t started_ns_ = 0, next_status_ns_ = 0, next_look_ns_ = 0;  ///< steady clock
  std::uint8_t curbs_sent_ = 255;  ///< the counter of CurbStatus; 255 so that the first CurbAhead has 0
  std::uint64_t heap_calls_before_ = 0;
  std::uint32_t curbs_left_out_ = 0;
  SightWatch sight_;
  SourceEvent sight_event_ = SourceEvent::none;                    ///< to be told
  std::uint64_t lines_without_tilt_ = 0, lines_without_pose_ = 0;  ///< as in Report
  LatencyHistogram latency_, work_;
  ScannerState scanner_state_;
  Troubles troubles_;
  std::string_view told_state_{};
  std::array<std::array<char, 64 << 10>, 2> curb_texts_{};  ///< the line sent last, and the next
  std::string_view curbs_given_{};
  std::array<char, 32 << 10> status_text_{};
  std::unique_ptr<ScannerThread> scanner_;  ///< last member, because its thread uses the inbox
};

}  // namespace curbline::daemon
