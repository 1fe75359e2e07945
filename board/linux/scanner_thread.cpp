#include "scanner_thread.hpp"

#include "formats/carmen.hpp"

namespace curbline::daemon {

using scanner::LiveScanner;

ScannerThread::ScannerThread(std::string name, tools::ScannerLink link, const LaserSettings& laser, LineInbox& inbox)
    : name_(std::move(name)),
      link_(std::move(link)),
      scanner_(*link_.session, std::move(link_.stream), {.reconnect = true, .silence = link_.silence}),
      laser_(laser),
      inbox_(inbox) {
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
  while (!stop_) {
    const LiveScanner::Event event = scanner_.read(port::Milliseconds{100});
    if (event == LiveScanner::Event::line) take_line();
    const std::lock_guard lock(mutex_);
    const scanner::Counters& c = link_.session->counters();
    if (event == LiveScanner::Event::line) state_.connected = true;
    if (event == LiveScanner::Event::lost) state_.connected = false;
    state_.error = scanner_.last_error();
    state_.problem = link_.session->problem();
    state_.connections = scanner_.connections();
    state_.damaged = c.bad_checksum + c.wrong_length + c.cut + c.malformed;
  }
}

void ScannerThread::take_line() {
  const scanner::Line& line = link_.session->line();
  const tools::Misfit misfit = tools::misfit_of(line.ranges_m.size(), static_cast<double>(line.first_bearing_rad),
                                                static_cast<double>(line.bearing_step_rad), laser_);
  if (misfit == tools::Misfit::none) {
    inbox_.push({line.host_ns, line.ranges_m}, scanner::steady_now_ns());
    return;
  }
  const std::lock_guard lock(mutex_);
  ++state_.other_beams;
}

}  // namespace curbline::daemon
