#include "line_inbox.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

namespace curbline::daemon {

LineInbox::LineInbox() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

LineInbox::~LineInbox() {
  ::close(event_);
}

void LineInbox::init(const tools::Robot& robot, float max_wait_s) {
  const std::lock_guard lock(mutex_);
  queue_.init(robot.laser, robot.tilt, robot.pose, max_wait_s);
}

void LineInbox::push(const ScanLine& line, std::int64_t now_ns) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push(line, now_ns);
  }
  ::eventfd_write(event_, 1);
}

std::optional<ScanLine> LineInbox::pop(const NewestTimes& newest, std::int64_t now_ns, float offset_s, bool& covered) {
  const std::lock_guard lock(mutex_);
  const std::uint32_t before = queue_.counters().covered;
  const auto line = queue_.pop(newest, now_ns, offset_s);
  if (!line) return std::nullopt;
  covered = queue_.counters().covered != before;
  std::copy(line->ranges_m.begin(), line->ranges_m.end(), ranges_m_.begin());
  return ScanLine{line->time_ns, std::span<const float>(ranges_m_).first(line->ranges_m.size())};
}

bool LineInbox::empty() const {
  const std::lock_guard lock(mutex_);
  return queue_.size() == 0;
}

LineQueueCounters LineInbox::counters() const {
  const std::lock_guard lock(mutex_);
  return queue_.counters();
}

void LineInbox::quiet() const {
  eventfd_t events = 0;
  ::eventfd_read(event_, &events);
}

}  // namespace curbline::daemon
