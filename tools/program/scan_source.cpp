#include "program/scan_source.hpp"

#include <signal.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <iostream>

#include "formats/bad_input.hpp"
#include "formats/laser_log.hpp"
#include "scanner/live_scanner.hpp"

namespace curbline::tools {
namespace {

using port::Milliseconds, scanner::LiveScanner;

std::atomic<bool> interrupted = false;
struct sigaction before_interrupt {};

void interrupt(int) {
  interrupted = true;
  ::sigaction(SIGINT, &before_interrupt, nullptr);
}

/// While this object lives, Ctrl-C ends the scan; a second one has its previous effect.
class InterruptWatch {
 public:
  InterruptWatch() {
    interrupted = false;
    struct sigaction action {};
    action.sa_handler = interrupt;
    ::sigaction(SIGINT, &action, &before_interrupt);
  }
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;
  ~InterruptWatch() { ::sigaction(SIGINT, &before_interrupt, nullptr); }
};

class LogSource final : public ScanSource {
 public:
  LogSource(const std::string& path, const LaserSettings& laser) : log_(path, laser) {}

  std::optional<CarmenLine> next() override { return log_.next(); }
  bool of_the_future() const override { return log_.of_the_future(); }
  std::string remarks() const override { return log_.remarks(); }

 private:
  LaserLog log_;
};

class LiveSource final : public ScanSource {
 public:
  LiveSource(const std::string& name, ScannerLink link, const LaserSettings& laser,
             std::optional<std::int64_t> log_time_ns)
      : name_(name),
        owner_(link.session),
        session_(*owner_),
        scanner_(session_, std::move(link.stream), {.reconnect = false, .silence = link.silence}),
        silence_(link.silence),
        laser_(laser),
        log_time_ns_(log_time_ns) {
    if (const int failed = scanner_.open(); failed != 0) {
      throw BadInput(name + ": " + std::strerror(failed) +
                     (failed == EBUSY ? "; expected a line that no other program uses" : "; expected a scanner there"));
    }
  }

  std::optional<CarmenLine> next() override {
    while (!interrupted) {
      switch (scanner_.read(Milliseconds{100})) {
        case LiveScanner::Event::line:
          return take_line();
        case LiveScanner::Event::nothing:
          break;
        case LiveScanner::Event::lost:
          end();
          return std::nullopt;
      }
    }
    return std::nullopt;
  }

 private:
  CarmenLine take_line() {
    const scanner::Line& line = session_.line();
    CarmenLine scan;
    scan.time_ns = line.host_ns;
    if (log_time_ns_) {
      log_time_ns_ = session_.log_time_ns(*log_time_ns_);
      scan.time_ns = *log_time_ns_;
    }
    scan.start_angle_rad = static_cast<double>(line.first_bearing_rad);
    scan.angular_resolution_rad = static_cast<double>(line.bearing_step_rad);
    scan.field_of_view_rad = scan.angular_resolution_rad * static_cast<double>(line.ranges_m.size() - 1);
    scan.maximum_range_m = static_cast<double>(laser_.max_range_m);
    scan.ranges_m.assign(line.ranges_m.begin(), line.ranges_m.end());
    check_geometry(scan, laser_, name_, ++lines_);
    return scan;
  }

  /// A connection that ends after its first line is treated like the end of a log; only the user can know whether it
  /// was intended.
  void end() const {
    const int error = scanner_.last_error();
    std::string what = error == ETIMEDOUT ? "no scan line for " + std::to_string(silence_.count() / 1000) + " s"
                       : error != 0       ? std::string(std::strerror(error))
                                          : "closed the connection";
    what += lines_ == 0 ? " before its first scan line" : " after " + std::to_string(lines_) + " scan lines";
    if (!session_.problem().empty()) what += ", " + std::string(session_.problem());
    if (lines_ == 0) throw BadInput(name_ + ": " + what + "; expected scan lines");
    std::cerr << name_ << ": " << what << "; taken as its end\n";
  }

  std::string name_;
  std::shared_ptr<scanner::Session> owner_;
  scanner::Session& session_;
  LiveScanner scanner_;
  Milliseconds silence_;
  LaserSettings laser_;
  std::optional<std::int64_t> log_time_ns_;
  long lines_ = 0;
  InterruptWatch watch_;
};

}  // namespace

std::unique_ptr<ScanSource> open_scan_source(const std::string& scans, const LaserSettings& laser,
                                             std::optional<std::int64_t> log_time_ns) {
  if (!is_scanner(scans)) return std::make_unique<LogSource>(scans, laser);
  ScannerLink link = scanner_link(scans, laser);
  if (log_time_ns && !link.has_stamps) {
    throw BadInput(scans +
                   ": its telegrams have no time stamps to join a log by; expected --can can:IFACE, or a robot "
                   "without CAN and poses");
  }
  return std::make_unique<LiveSource>(scans, std::move(link), laser, log_time_ns);
}

}  // namespace curbline::tools
