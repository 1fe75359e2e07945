#include "scanner/device_clock.hpp"

#include <algorithm>

namespace curbline::scanner {

std::optional<std::int64_t> StampCounter::unwrap(std::uint32_t stamp) {
  const std::uint64_t raw = stamp & mask_;
  if (!ticks_) {
    ticks_ = static_cast<std::int64_t>(raw);
  } else {
    const std::uint64_t forward = (raw - static_cast<std::uint64_t>(*ticks_)) & mask_;
    if (forward > mask_ / 2) {
      ++back_;
      return std::nullopt;
    }
    *ticks_ += static_cast<std::int64_t>(forward);
  }
  back_ = 0;
  return *ticks_ * tick_ns_;
}

std::int64_t StampCounter::nearest_ns(std::int64_t device_ns, std::int64_t near_ns) const {
  const std::int64_t whole_ns = (static_cast<std::int64_t>(mask_) + 1) * tick_ns_;
  const std::int64_t ahead_ns = ((device_ns - near_ns) % whole_ns + whole_ns) % whole_ns;
  return near_ns + (ahead_ns < whole_ns / 2 ? ahead_ns : ahead_ns - whole_ns);
}

void LowerEnvelope::add(std::int64_t value_ns, std::int64_t now_ns) {
  if (empty()) window_start_ns_ = now_ns;
  const std::int64_t since_ns = now_ns - window_start_ns_;
  if (since_ns >= window_ns_) {
    before_ = since_ns < 2 * window_ns_ ? now_ : value_ns;  // a whole window without values: now_ is out of date
    now_ = none;
    window_start_ns_ = now_ns;
  }
  now_ = std::min(now_, value_ns);
}

void DeviceClock::restart() {
  anchors_.restart();
  lines_.restart();
}

void DeviceClock::follow(std::int64_t device_ns, std::int64_t arrival_ns) {
  lines_.add(arrival_ns - device_ns, arrival_ns);
  if (lines_.first_window()) first_lines_ns_ = lines_.value_ns();
}

std::int64_t DeviceClock::to_steady(std::int64_t device_ns) const {
  if (anchors_.empty()) return device_ns + lines_.value_ns() - delay_ns_;
  const std::int64_t drift_ns = lines_.empty() ? 0 : lines_.value_ns() - first_lines_ns_;
  return device_ns + anchors_.value_ns() + drift_ns;
}

}  // namespace curbline::scanner
