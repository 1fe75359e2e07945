// Lines, readings and clocks at arbitrary times: the stages before the pipeline account for all that they are given.
#include <array>
#include <optional>

#include "curbline/curbline.hpp"
#include "fuzz/claim.hpp"
#include "fuzz/run.hpp"

namespace curbline::fuzz {
namespace {

constexpr Limits limits{.beams = 8};

std::int64_t some_time_ns(Numbers& numbers, std::int64_t after_ns) {
  if (numbers.seldom()) return numbers.time_ns();
  return after_ns % (INT64_MAX / 2) + 25'000'000 + numbers.whole(-3'000'000, 9'000'000);
}

void clock(Numbers& numbers) {
  Settings settings;
  settings.laser.beams = limits.beams;
  numbers.change(settings.laser.beam_interval_s, 0.0f, 1.0f);
  numbers.change(settings.laser.bearing_step_rad, -1.0f, 1.0f);
  if (bad_setting(settings, limits) != nullptr) return;
  LineClock clock;
  clock.init(settings.laser);
  std::int64_t stamp_ns = 0;
  std::uint32_t set_back = 0, left_out = 0;
  while (!numbers.used_up()) {
    stamp_ns = some_time_ns(numbers, stamp_ns);
    const std::optional<std::int64_t> time_ns = clock.time_of(stamp_ns);
    claim(!time_ns || *time_ns <= stamp_ns, "no line is later than its stamp");
    set_back += time_ns && *time_ns < stamp_ns;
    left_out += !time_ns;
    claim(clock.set_back() == set_back && clock.left_out() == left_out, "what is set back or left out is counted");
  }
}

void queue(Numbers& numbers) {
  Settings settings;
  settings.laser.beams = limits.beams;
  settings.tilt.fixed = numbers.flag();
  settings.pose.still = numbers.flag();
  numbers.change(settings.laser.beam_interval_s, 0.0f, 1.0f);
  numbers.change(settings.tilt.latency_s, -10.0f, 10.0f);
  if (bad_setting(settings, limits) != nullptr) return;
  LineQueue<limits, 3> queue;
  queue.init(settings.laser, settings.tilt, settings.pose, numbers.number(0.0f, 10.0f));
  SourceWatch watch;
  watch.init(numbers.number(0.0f, 10.0f), settings.tilt.fixed);
  constexpr std::array<float, limits.beams + 1> ranges_m{};
  std::int64_t now_ns = 0, tilt_ns = SourceWatch::no_reading, pose_ns = tilt_ns;
  while (!numbers.used_up()) {
    now_ns += numbers.whole(0, 100'000'000);
    if (numbers.flag()) tilt_ns = now_ns + numbers.whole(-100'000'000, 100'000'000);
    if (numbers.flag()) pose_ns = now_ns + numbers.whole(-100'000'000, 100'000'000);
    const auto beams = static_cast<std::size_t>(numbers.whole(0, numbers.seldom() ? limits.beams + 1 : limits.beams));
    const bool taken = queue.push({some_time_ns(numbers, now_ns), {ranges_m.data(), beams}}, now_ns);
    claim(!taken || beams <= static_cast<std::size_t>(limits.beams), "a line that is too long is refused");
    watch.update(tilt_ns, now_ns);
    const float offset_s = numbers.number(-1.0f, 1.0f);
    while (numbers.flag()) {
      const std::optional<ScanLine> line = queue.pop({tilt_ns, pose_ns}, now_ns, offset_s);
      claim(line || !settings.tilt.fixed || !settings.pose.still || queue.size() == 0,
            "without a servo no line of a robot that stands waits");
      if (!line) break;
    }
    const LineQueueCounters c = queue.counters();
    claim(c.pushed == c.covered + c.overdue + c.crowded + c.dropped + c.too_long + c.bad_time +
                          static_cast<std::uint32_t>(queue.size()),
          "every line is counted once");
  }
}

}  // namespace

void run(Numbers& numbers) {
  if (numbers.flag()) {
    clock(numbers);
  } else {
    queue(numbers);
  }
}

}  // namespace curbline::fuzz
