#include <algorithm>

#include "curbline/tilt_frames.hpp"

namespace curbline::tools {
namespace {

constexpr std::int64_t reach_ns = 1'000'000'000, first_reach_ns = 10'000'000'000;

bool same(const can::Frame& a, const can::Frame& b) {
  return a.id == b.id && a.fd == b.fd && a.length == b.length &&
         std::equal(a.data.begin(), a.data.begin() + a.length, b.data.begin());
}

}  // namespace

/// What the kernel's filters let through.
bool RecordedTimes::wanted(const can::Frame& frame) const {
  if (frame.error || frame.remote) return false;
  if (sync_id_ && !frame.extended && frame.id == *sync_id_) return true;
  return frame.extended == signal_.extended && ((frame.id ^ signal_.id) & signal_.id_mask) == 0;
}

bool RecordedTimes::read_one() {
  while (!at_end_) {
    const auto frame = log_.next();
    at_end_ = !frame;
    if (frame && wanted(*frame)) {
      ahead_.push_back(*frame);
      return true;
    }
  }
  return false;
}

std::optional<std::int64_t> RecordedTimes::time_of(const can::Frame& frame, std::optional<std::int64_t> due_ns) {
  if (ahead_.empty() && !read_one()) return std::nullopt;
  const std::int64_t front_ns = ahead_.front().time_ns;
  const std::int64_t from_ns = due_ns ? *due_ns - reach_ns : front_ns;
  const std::int64_t until_ns = due_ns ? std::max(*due_ns, front_ns) + reach_ns : front_ns + first_reach_ns;
  while (ahead_.back().time_ns <= until_ns && read_one()) {
  }
  // The first of equal frames: while a servo rests they are many, and which is which makes no difference.
  const auto met = std::find_if(ahead_.begin(), ahead_.end(), [&](const can::Frame& recorded) {
    return recorded.time_ns >= from_ns && recorded.time_ns <= until_ns && same(recorded, frame);
  });
  if (met == ahead_.end()) return std::nullopt;
  const std::int64_t time_ns = met->time_ns;
  missed_ += met - ahead_.begin();
  ahead_.erase(ahead_.begin(), met + 1);
  return time_ns;
}

bool RecordedTimes::ended() {
  return ahead_.empty() && !read_one();
}

}  // namespace curbline::tools
