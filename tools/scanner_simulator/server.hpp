// A simulated scanner that a driver can connect to: a device on a TCP port of the loopback interface, or on a pty for a
// serial one. It plays a feed of scan lines from the moment the first reader requests them, each when its last beam is
// measured, and ends with the feed.
//
// The scanner's clock is the feed's time, modulo the width of its counter, so that a reader with the feed's CAN log can
// recover the time of each line: exactly if it is a whole number of milliseconds (SCIP 2.0) or microseconds (CoLa B).
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <set>
#include <string>

#include "scanner_simulator/device.hpp"
#include "scanner_simulator/scan_feed.hpp"

namespace curbline::tools {

enum class Protocol { scip2, cola, lms200 };

struct ServerOptions {
  std::uint16_t port = 0;  ///< TCP; 0: any free port
  double speed = 1.0;      ///< factor relative to the feed; 0: as fast as it is read
  int baud = 500'000;  ///< of a serial line at power-on; a real LMS200 has 9600, or another rate that it was configured
                       ///< to keep

  // Faults, for tests.
  std::function<void(Bytes& telegram, long line)> damage{};  ///< may change what is sent for a line, counted from 0
  std::set<long> restart_before{};                           ///< lines before which it is power-cycled
};

class ScannerServer {
 public:
  /// Throws BadInput if the feed is empty or does not fit this scanner, or the port is not available.
  ScannerServer(Protocol protocol, ScanFeed feed, const std::string& source, ServerOptions options);
  ScannerServer(const ScannerServer&) = delete;
  ScannerServer& operator=(const ScannerServer&) = delete;
  ~ScannerServer();

  /// The argument for `curbline replay --scans`: "scip2:127.0.0.1:10940", "lms200:/dev/pts/3".
  std::string address() const;
  std::uint16_t port() const { return port_; }
  const std::string& path() const { return path_; }  ///< of the pty

  /// Runs until the feed ends, or `stop`. The feed starts with the first request; after that, lines that fall due
  /// without a reader are lost.
  void run(const std::atomic<bool>& stop);

 private:
  using Clock = std::chrono::steady_clock;

  void listen_tcp();
  void open_pty();
  void accept_reader();
  void serve();
  bool same_speed() const;
  bool line_is_due() const;
  std::int64_t clock_ns() const;
  void play_line();
  void restart_device();
  void send(const Bytes& bytes);
  void drop_reader();
  void finish();

  Protocol protocol_;
  ScanFeed feed_;
  ServerOptions options_;
  std::unique_ptr<Device> device_;
  std::int64_t first_ns_;  ///< of the feed
  Clock::time_point started_{};
  bool clock_runs_ = false, played_ = false;
  int listener_ = -1, reader_ = -1, pty_ = -1;  ///< reader_: the connection, or the pty's controlling end
  std::uint16_t port_ = 0;
  std::string path_;
  long next_line_ = 0;
  std::int64_t wire_free_ns_ = INT64_MIN;  ///< in the feed's time: when a serial line has transmitted what was sent
};

}  // namespace curbline::tools
