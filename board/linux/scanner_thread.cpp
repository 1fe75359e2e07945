#include "scanner_thread.hpp"

#include <cmath>

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
  if (has_beams_of_laser(line)) {
    inbox_.push({line.host_ns, line.ranges_m}, scanner::steady_now_ns());
    return;
  }
  const std::lock_guard lock(mutex_);
  ++state_.other_beams;
}

/// As check_geometry() has it for logs: the first and the last beam within half a step.
bool ScannerThread::has_beams_of_laser(const scanner::Line& line) const {
  const float tolerance_rad = 0.5f * std::abs(laser_.bearing_step_rad);
  const auto steps = static_cast<float>(laser_.beams - 1);
  return line.ranges_m.size() == static_cast<std::size_t>(laser_.beams) &&
         std::abs(line.first_bearing_rad - laser_.first_bearing_rad) <= tolerance_rad &&
         std::abs(line.bearing_step_rad - laser_.bearing_step_rad) * steps <= tolerance_rad;
}

}  // namespace curbline::daemon
