#include "streams/recorded_times.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <limits>

namespace curbline::tools {
namespace {

/// A player sends late, never early; but the due time is derived from the previous frame, which may itself have been
/// late.
constexpr std::int64_t late_ns = 1'000'000'000, early_ns = 200'000'000, first_reach_ns = 10'000'000'000;

bool same(const can::Frame& a, const can::Frame& b) {
  return a.id == b.id && a.fd == b.fd && a.length == b.length &&
         std::equal(a.data.begin(), a.data.begin() + a.length, b.data.begin());
}

/// Of the equal recorded frames, the nearest to the due time, because a nodding servo passes each angle twice. Of
/// consecutive equal frames, while the servo rests, the first: it makes no difference which.
template <typename Iterator>
Iterator nearest_same(Iterator first, Iterator last, const can::Frame& frame, std::int64_t due_ns) {
  Iterator nearest = last;
  std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
  for (Iterator at = first; at != last; ++at) {
    const std::int64_t off_ns = std::abs(at->time_ns - due_ns);
    if (off_ns >= least_ns || !same(*at, frame)) continue;
    nearest = at;
    least_ns = off_ns;
  }
  while (nearest != last && nearest != first && same(*std::prev(nearest), frame)) --nearest;
  return nearest;
}

/// The CAN log of the recording that a scan log belongs to.
std::optional<std::string> recording_beside(const std::string& scans) {
  const std::filesystem::path path(scans);
  for (const auto& log : {std::filesystem::path(path).replace_extension(".candump"), path.parent_path() / "can.log"}) {
    std::error_code none;
    if (std::filesystem::is_regular_file(log, none)) return log.string();
  }
  return std::nullopt;
}

}  // namespace

/// What the kernel's filters accept.
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
      if (frame->time_ns < newest_ns_)
        throw BadInput(log_.path(), log_.line(), "the time goes back; expected no less than that of the frame before");
      newest_ns_ = frame->time_ns;
      ahead_.push_back(*frame);
      return true;
    }
  }
  return false;
}

void RecordedTimes::read_all() {
  while (read_one()) {
  }
}

std::optional<std::int64_t> RecordedTimes::time_of(const can::Frame& frame, std::optional<std::int64_t> due_ns) {
  if (ahead_.empty() && !read_one()) return std::nullopt;
  const std::int64_t front_ns = ahead_.front().time_ns;
  const std::int64_t from_ns = due_ns ? *due_ns - late_ns : front_ns;
  const std::int64_t until_ns = due_ns ? *due_ns + early_ns : front_ns + first_reach_ns;
  while (ahead_.back().time_ns <= until_ns && read_one()) {
  }
  if (same(ahead_.front(), frame)) {  // the next one, however late: a stalled player still sends it
    ahead_.pop_front();
    return front_ns;
  }
  const auto in_time = [](const can::Frame& recorded, std::int64_t time_ns) { return recorded.time_ns < time_ns; };
  const auto first = std::lower_bound(ahead_.begin(), ahead_.end(), from_ns, in_time);
  const auto last = std::lower_bound(first, ahead_.end(), until_ns + 1, in_time);
  const auto met = nearest_same(first, last, frame, due_ns.value_or(front_ns));
  if (met == last) return std::nullopt;
  const std::int64_t time_ns = met->time_ns;
  missed_ += met - ahead_.begin();
  ahead_.erase(ahead_.begin(), met + 1);
  return time_ns;
}

bool RecordedTimes::ended() {
  return ahead_.empty() && !read_one();
}

LogClock LogClock::of_the_bus() {
  LogClock clock;
  clock.offset_ns_ = 0;
  return clock;
}

LogClock LogClock::of_log(const std::string& scans, const can::Signal& signal, std::optional<std::uint16_t> sync_id) {
  if (const auto log = recording_beside(scans)) return LogClock(RecordedTimes(*log, signal, sync_id));
  LogClock clock;
  const std::string name = std::filesystem::path(scans).filename().replace_extension(".candump").string();
  clock.guess_ =
      scans + ": no " + name +
      " or can.log beside it; expected one, to know when tilt frames were recorded: the first is taken for " +
      "one of the first scan line's time, and curbs are wrong if it is not";
  return clock;
}

void LogClock::set_log_time(can::Frame& frame, std::int64_t line_ns) {
  std::optional<std::int64_t> due_ns;
  if (offset_ns_) due_ns = frame.time_ns + *offset_ns_;
  const auto recorded_ns = recorded_ ? recorded_->time_of(frame, due_ns) : std::nullopt;
  if (recorded_ && !recorded_ns) ++not_recorded_;
  const std::int64_t time_ns = recorded_ns ? *recorded_ns : due_ns.value_or(line_ns);
  offset_ns_ = time_ns - frame.time_ns;
  frame.time_ns = time_ns;
}

}  // namespace curbline::tools
