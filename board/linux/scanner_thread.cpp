#include "scanner_thread.hpp"

#include <cerrno>

#include "formats/carmen.hpp"

namespace curbline::daemon {

using scanner::LiveScanner;

ScannerThread::ScannerThread(std::string name, tools::ScannerLink link, const LaserSettings& laser, LineInbox& inbox,
                             float silent_after_s)
    : name_(std::move(name)),
      link_(std::move(link)),
      scanner_(*link_.session, std::move(link_.stream), {.reconnect = true, .silence = link_.silence}),
      laser_(laser),
      inbox_(inbox),
      silent_after_ns_(static_cast<std::int64_t>(silent_after_s * 1e9f)) {
  state_.name = name_;
}

ScannerThread::~ScannerThread() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void ScannerThread::start() {
  thread_ = std::thread([this] { run(); });
}

ScannerState ScannerThread::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void ScannerThread::run() {
  std::int64_t last_line_ns = 0;
  bool silent = false;  // after lines, and still connected
  while (!stop_) {
    const LiveScanner::Event event = scanner_.read(port::Milliseconds{100});
    const std::int64_t now_ns = scanner::steady_now_ns();
    const bool line = event == LiveScanner::Event::line && take_line();
    if (line) last_line_ns = now_ns;
    const std::lock_guard lock(mutex_);
    const scanner::Counters& c = link_.session->counters();
    silent = (silent || state_.connected) && now_ns - last_line_ns > silent_after_ns_ && scanner_.is_open();
    if (event == LiveScanner::Event::lost || silent) state_.lost = true;
    if (line) state_.lost = false;
    state_.connected = (line || state_.connected) && !state_.lost;
    state_.error = silent ? ETIMEDOUT : scanner_.last_error();
    state_.problem = link_.session->problem();
    state_.connections = scanner_.connections();
    state_.damaged = c.bad_checksum + c.wrong_length + c.cut + c.malformed;
    state_.device_errors = c.device_errors;
  }
}

/// False if it is of another laser.
bool ScannerThread::take_line() {
  const scanner::Line& line = link_.session->line();
  const tools::Misfit misfit = tools::misfit_of(line.ranges_m.size(), static_cast<double>(line.first_bearing_rad),
                                                static_cast<double>(line.bearing_step_rad), laser_);
  if (misfit == tools::Misfit::none) {
    inbox_.push({line.host_ns, line.ranges_m}, scanner::steady_now_ns());
    return true;
  }
  const std::lock_guard lock(mutex_);
  ++state_.other_beams;
  return false;
}

}  // namespace curbline::daemon
