// A live scanner, read by its own thread because connecting blocks. Its lines go into the inbox. The thread reconnects
// to a lost scanner for as long as it takes.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "line_inbox.hpp"
#include "scanner/live_scanner.hpp"
#include "streams/scanner_link.hpp"

namespace curbline::daemon {

struct ScannerState {
  std::string_view name{};     ///< as given to --scans; lives as long as the thread
  bool connected = false;      ///< and sends lines of the robot's laser
  bool lost = false;           ///< and has not sent one since: not at the start, before a connection has failed
  int error = 0;               ///< errno of the last failure, ETIMEDOUT: no lines; 0: it closed the connection
  std::string_view problem{};  ///< what the scanner refused or reported; static text
  std::uint64_t connections = 0;
  std::uint64_t other_beams = 0;    ///< lines dropped because their number of beams is not that of the robot's laser
  std::uint64_t damaged = 0;        ///< damaged telegrams
  std::uint64_t device_errors = 0;  ///< faults that the scanner reports about itself, though its lines come
};

class ScannerThread {
 public:
  /// A scanner without a line for `silent_after_s` is told as lost at once. Its connection has longer, the link's
  /// `silence`, since setting it up anew takes time too.
  ScannerThread(std::string name, tools::ScannerLink link, const LaserSettings& laser, LineInbox& inbox,
                float silent_after_s);
  /// Stops the scanner's stream and the thread, within the 2 s that an attempt to connect may take.
  ~ScannerThread();
  ScannerThread(const ScannerThread&) = delete;
  ScannerThread& operator=(const ScannerThread&) = delete;

  void start();
  ScannerState state() const;

 private:
  void run();
  bool take_line();

  std::string name_;
  tools::ScannerLink link_;
  scanner::LiveScanner scanner_;
  LaserSettings laser_;
  LineInbox& inbox_;
  std::int64_t silent_after_ns_;
  mutable std::mutex mutex_;
  ScannerState state_{};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace curbline::daemon
