#include "curbline/intake/line_clock.hpp"

#include <algorithm>
#include <span>

#include "curbline/intake/rising_times.hpp"
#include "curbline/math.hpp"

namespace curbline {
namespace {

/// Smaller delays count as none: by a laser that nods at 1 rad/s, ground 5 m away is misplaced by a millimetre.
constexpr float exact_ns = 250e3f;
/// A slower sensor is no scanner.
constexpr float longest_turn_s = 10.0f;
/// Share of a turn: an estimate of how far a motor deviates from the settings.
constexpr float most_slower = 0.005f;
/// In a longer pause turns cannot be counted: by then the motor may be off by a twelfth of one.
constexpr std::int64_t most_turns = 16;
/// Arrivals needed to know the turns: at first, and after stamps that did not keep to them.
constexpr int enough_at_first = 8, enough_again = 32;
/// After so many consecutive lines later than usual, by chance once in 9 million, the turns have changed.
constexpr int most_late = 8;
/// Times the mean delay: later than usual is one line in seven.
constexpr float usual = 2.0f;
/// Times the mean delay: as late is one line in 150, as rare as a lost line.
constexpr float seldom = 5.0f;
/// Share of a turn: the largest mean delay with which turns are counted. Stamps anywhere between turns have a half.
constexpr float most_mean = 0.45f;

/// An arrival: by how much it is later than its turn would be by the settings.
struct Place {
  float turn, late_ns;
};

/// Slope of the straight line below all arrivals that is nearest to them on average: that of the edge of their lower
/// convex hull under the mean turn. At least two arrivals, in ascending order.
float slope_below(std::span<const Place> arrivals) {
  std::array<Place, LineClock::capacity> hull{};
  std::size_t corners = 0;
  float mean_turn = 0.0f;
  for (const Place& p : arrivals) {
    mean_turn += p.turn / to_float(static_cast<std::int64_t>(arrivals.size()));
    for (; corners >= 2; --corners) {
      const Place &a = hull[corners - 2], &b = hull[corners - 1];
      if ((b.late_ns - a.late_ns) * (p.turn - a.turn) < (p.late_ns - a.late_ns) * (b.turn - a.turn)) break;
    }
    hull[corners++] = p;
  }
  std::size_t edge = 0;
  while (edge + 2 < corners && hull[edge + 1].turn < mean_turn) ++edge;
  const Place &a = hull[edge], &b = hull[edge + 1];
  return (b.late_ns - a.late_ns) / (b.turn - a.turn);
}

}  // namespace

void LineClock::init(const LaserSettings& laser) {
  *this = LineClock{};
  const float turn_s = laser.beam_interval_s * (2.0f * pi / magnitude(laser.bearing_step_rad));
  if (turn_s <= longest_turn_s) turn_ns_ = to_ns(turn_s);
  enough_ = enough_at_first;
}

std::optional<std::int64_t> LineClock::time_of(std::int64_t stamp_ns) {
  if (turn_ns_ == 0) return stamp_ns;
  if (!stamps_.admits(stamp_ns)) {
    if (!RisingTimes::is_time(stamp_ns) || stamp_ns <= time_ns_) return stamp_ns;
    ++left_out_;  // the pipeline would take it for a newer line: the newest was set back, or got no time
    return std::nullopt;
  }
  stamps_.take(stamp_ns);
  const Turns turns = turns_to(stamp_ns);
  if (turns.count > 0) add(turns.count, stamp_ns);
  const bool known = steady_ && size_ >= enough_ && mean_late_ns_ <= most_mean * to_float(turn_ns_);
  if (!known || stamp_ns != newest().stamp_ns || !(turns.doubtful || newest_late_ns_ > exact_ns))
    return time_ns_ = stamp_ns;
  const std::int64_t time_ns = stamp_ns - static_cast<std::int64_t>(newest_late_ns_);
  if (turns.doubtful || time_ns <= time_ns_) {
    ++left_out_;
    return std::nullopt;
  }
  ++set_back_;
  return time_ns_ = time_ns;
}

/// Turns since the newest arrival; 0 if the line is not to be added: it starts the clock afresh, or comes too early.
LineClock::Turns LineClock::turns_to(std::int64_t stamp_ns) {
  const std::int64_t since_ns = size_ > 0 ? stamp_ns - newest().stamp_ns : -1;
  if (since_ns < 0 || since_ns > most_turns * turn_ns_) {
    restart(stamp_ns);
    return {};
  }
  if (size_ == 1) usual_turns_ = last_turns_ = std::max<std::int64_t>(1, (since_ns + turn_ns_ / 2) / turn_ns_);
  const float half = turn() / 2.0f;
  std::int64_t turns = usual_turns_;
  while (turns > 1 && late_ns(stamp_ns, turns) < -half) --turns;
  const bool none_lost = take_back_lost(stamp_ns, turns);
  if (waited_ > 0) --waited_;
  const float late = late_ns(stamp_ns, turns);
  if (late < -half) return {};
  if (late < -usual * mean_late_ns_ - exact_ns) {  // earlier than all: their turns were late
    restart(stamp_ns);
    return {};
  }
  const std::int64_t lost = floor_to_int((late + exact_ns) / turn());
  turn_late_ = lost > 0 ? turn_late_ + 1 : 0;
  if (lost == 0 || none_lost) return {turns};  // after a line that has waited, others come in a bunch
  const float rest = late - to_float(lost) * turn();
  const bool doubtful = (rest > exact_ns || waited_ > 0) && turns + lost != last_turns_;
  if (rest > usual * mean_late_ns_) return {turns, doubtful};
  if (to_float(turn_late_ * lost) * turn() <= seldom * mean_late_ns_) return {turns, doubtful};
  lost_turns_ = lost;
  turn_late_ = 0;
  return {turns + lost, doubtful};
}

/// Does a line come too early for the turns counted as lost before the newest? Then that one was late by as much
/// instead.
bool LineClock::take_back_lost(std::int64_t stamp_ns, std::int64_t turns) {
  const std::int64_t lost = lost_turns_;
  lost_turns_ = 0;
  if (lost == 0 || late_ns(stamp_ns, turns) >= -turn() / 2.0f) return false;
  arrivals_[static_cast<std::size_t>(size_ - 1)].turn -= lost;
  newest_late_ns_ += to_float(lost) * turn();
  waited_ = capacity;  // as long as it is among the arrivals
  return true;
}

void LineClock::restart(std::int64_t stamp_ns) {
  arrivals_[0] = {0, stamp_ns};
  size_ = 1;
  slower_ns_ = newest_late_ns_ = 0.0f;
  mean_late_ns_ = exact_ns;
  usual_turns_ = last_turns_ = 1;
  lost_turns_ = 0;
  waited_ = late_ = turn_late_ = 0;
}

void LineClock::add(std::int64_t turns, std::int64_t stamp_ns) {
  if (turns == last_turns_) usual_turns_ = turns;
  last_turns_ = turns;
  late_ = late_ns(stamp_ns, turns) > usual * mean_late_ns_ ? late_ + 1 : 0;
  const std::int64_t turn = newest().turn + turns;
  if (size_ == capacity) keep_newest(capacity - 1);
  arrivals_[static_cast<std::size_t>(size_++)] = {turn, stamp_ns};
  if (late_ >= most_late) {
    keep_newest(late_);
    late_ = 0;
    enough_ = enough_again;
  }
  fit();
}

void LineClock::keep_newest(int count) {
  std::copy(arrivals_.begin() + (size_ - count), arrivals_.begin() + size_, arrivals_.begin());
  size_ = count;
}

float LineClock::turn() const {
  return to_float(turn_ns_) + slower_ns_;
}

float LineClock::late_ns(std::int64_t stamp_ns, std::int64_t turns) const {
  return to_float(stamp_ns - newest().stamp_ns - turns * turn_ns_) + newest_late_ns_ - to_float(turns) * slower_ns_;
}

/// Turns take as long as the line below all arrivals says; the newest is as late as it lies above that line.
void LineClock::fit() {
  std::array<Place, capacity> places;
  for (int k = 0; k < size_; ++k) {
    const std::int64_t turn = arrival(k).turn - newest().turn;
    const std::int64_t late_ns = arrival(k).stamp_ns - newest().stamp_ns - turn * turn_ns_;
    places[static_cast<std::size_t>(k)] = {to_float(turn), to_float(late_ns)};
  }
  const std::span<const Place> all(places.data(), static_cast<std::size_t>(size_));
  const float slower_ns = slope_below(all), most_ns = most_slower * to_float(turn_ns_);
  slower_ns_ = std::clamp(slower_ns, -most_ns, most_ns);
  float least_ns = 0.0f, sum_ns = 0.0f;  // height above the line through the newest
  for (const Place& p : all) {
    const float above_ns = p.late_ns - slower_ns_ * p.turn;
    least_ns = std::min(least_ns, above_ns);
    sum_ns += above_ns;
  }
  newest_late_ns_ = -least_ns;
  mean_late_ns_ = std::max(sum_ns / to_float(size_) - least_ns, exact_ns);
  // By chance alone the fit deviates by a fraction of this.
  steady_ = to_float(newest().turn - arrival(0).turn) * magnitude(slower_ns - slower_ns_) <= mean_late_ns_;
}

}  // namespace curbline
