#include "lms200/turn_clock.hpp"

#include <algorithm>

namespace curbline::lms200 {

void TurnClock::restart() {
  offset_.restart();
  turns_ = 0;
  last_ns_ = INT64_MIN;
}

std::int64_t TurnClock::sent_ns(std::int64_t arrival_ns, std::int64_t turns) {
  turns_ += turns;
  if (!offset_.empty()) {
    const std::int64_t late_ns = arrival_ns - (offset_.value_ns() + turns_ * turn_ns);
    if (late_ns > 8 * turns * turn_ns) turns_ += (late_ns + turn_ns / 2) / turn_ns;
  }
  offset_.add(arrival_ns - turns_ * turn_ns, arrival_ns);
  std::int64_t time_ns = offset_.value_ns() + turns_ * turn_ns;
  if (last_ns_ != INT64_MIN)
    time_ns = std::max(time_ns, last_ns_ + turn_ns / 2);  // a falling envelope would move lines back
  last_ns_ = time_ns;
  return time_ns;
}

}  // namespace curbline::lms200
