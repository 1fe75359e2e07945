#include "lms200/session.hpp"

#include <algorithm>
#include <numbers>

namespace curbline::lms200 {
namespace {

constexpr std::array<int, 4> bauds{500'000, 38'400, 9'600, 19'200};
constexpr std::size_t as_brought = 1;  // index of the rate to which the scanner is switched
constexpr int tries_a_baud = 2;
constexpr std::array<std::uint8_t, 8> stop_command{stx, 0, 2, 0, 0x20, 0x25, 0x35, 0x08};

// Commands and their replies.
constexpr std::uint8_t mode = 0x20, configuration = 0x74, set_variant = 0x3B;
constexpr std::uint8_t continuous = 0x24, request = 0x25, at_38400 = 0x40;
constexpr std::uint8_t mode_reply = 0xA0, configuration_reply = 0xF4, variant_reply = 0xBB, scan = 0xB0,
                       power_on = 0x90;
constexpr std::size_t measuring_mode_at = 6;  // in the reply to 74h

/// Bits of the range for each measuring mode: 8 m, 16 m and 32 m in millimetres, and mode 15, which is 32 m without
/// flags. 0: no ranges.
int range_bits_of(std::uint8_t measuring_mode) {
  if (measuring_mode <= 2) return 13;
  if (measuring_mode <= 4) return 14;
  return measuring_mode <= 6 ? 15 : measuring_mode == 15 ? 16 : 0;
}

}  // namespace

void Session::restart(const scanner::Now&) {
  telegrams_.restart();
  clock_.restart();
  problem_ = {};
  go_to(Step::find);
}

void Session::go_to(Step step) {
  if (step == Step::variant && variant_.field_deg == 0) step = Step::start;
  step_ = step;
  due_ = step != Step::measuring;
  tries_ = 0;
}

int Session::baud() const {
  return bauds[baud_];
}

std::span<const std::uint8_t> Session::farewell() const {
  return stop_command;
}

std::span<const std::uint8_t> Session::to_send(const scanner::Now& now) {
  const bool again = !due_;
  if (step_ == Step::measuring || !is_due(now)) return {};
  if (again && ++tries_ == tries_a_baud) {  // no answer: try the next speed, now
    baud_ = (baud_ + 1) % bauds.size();
    go_to(Step::find);
    due_ = false;
  }
  return std::span(command_).first(write_command());
}

std::size_t Session::write_command() {
  const auto write = [this](std::initializer_list<std::uint8_t> content) {
    return frame(0, {content.begin(), content.size()}, command_);
  };
  switch (step_) {
    case Step::speed_up:
      return write({mode, at_38400});
    case Step::configuration:
      return write({configuration});
    case Step::variant:
      return write({set_variant, static_cast<std::uint8_t>(variant_.field_deg), 0,
                    static_cast<std::uint8_t>(variant_.step_centideg), 0});
    case Step::start:
      return write({mode, continuous});
    case Step::find:
    case Step::measuring:
      break;
  }
  return write({mode, request});
}

bool Session::take(std::span<const std::uint8_t>& bytes, const scanner::Now& now) {
  while (true) {
    const auto telegram = telegrams_.take(bytes);
    if (telegram.empty()) return false;
    if (take_content(content_of(telegram), now)) return true;
  }
}

bool Session::take_content(std::span<const std::uint8_t> content, const scanner::Now& now) {
  const std::uint8_t status = content.back();
  if ((status & 7) >= 3) {  // 0: ok, 1 and 2: information and warning, 3 and 4: error
    ++counters_.device_errors;
    problem_ = "the scanner reports an error in its status byte";
  }
  switch (content[0]) {
    case scan:
      return step_ == Step::measuring && take_scan(content, now);
    case power_on:  // it was power-cycled and waits for commands
      clock_.restart();
      go_to(Step::find);
      return false;
    default:
      if (!due_) take_reply(content);
      return false;
  }
}

void Session::take_reply(std::span<const std::uint8_t> content) {
  const std::uint8_t command = content[0];
  if (content.size() < 3) return;
  if (command == mode_reply && content[1] != 0) {
    refuse("the scanner refuses a change of its operating mode (command 20h)");
  } else if (command == mode_reply && step_ == Step::find) {
    go_to(bauds[baud_] < bauds[as_brought] ? Step::speed_up : Step::configuration);
  } else if (command == mode_reply && step_ == Step::speed_up) {
    baud_ = as_brought;
    go_to(Step::configuration);
  } else if (command == mode_reply && step_ == Step::start) {
    problem_ = {};
    go_to(Step::measuring);
  } else if (command == configuration_reply && step_ == Step::configuration && content.size() > measuring_mode_at) {
    range_bits_ = range_bits_of(content[measuring_mode_at]);
    if (range_bits_ == 0) return refuse("the scanner measures reflectivity; expected a measuring mode with ranges");
    go_to(Step::variant);
  } else if (command == variant_reply && step_ == Step::variant) {
    if (content[1] != 1) return refuse("the scanner refuses the field and step of the robot's laser (command 3Bh)");
    go_to(Step::start);
  }
}

void Session::refuse(std::string_view problem) {
  ++counters_.refused;
  problem_ = problem;
}

bool Session::take_scan(std::span<const std::uint8_t> content, const scanner::Now& now) {
  std::size_t count = 0;
  switch (parse_scan_data(content, range_bits_, ranges_m_, count)) {
    case ScanResult::ok:
      break;
    case ScanResult::wrong_length:
      ++counters_.wrong_length;
      return false;
    case ScanResult::partial:
    case ScanResult::other_unit:
      ++counters_.unsupported;
      problem_ =
          "the scanner sends interlaced partial scans or ranges in another unit; expected whole scans in centimetres "
          "or millimetres";
      return false;
  }
  const Variant v = variant_of(count);
  constexpr double degree = std::numbers::pi / 180.0;
  ++counters_.lines;
  take_time(v, content.size() + frame_bytes, now);
  line_.first_bearing_rad = static_cast<float>(-0.5 * v.field_deg * degree);
  line_.bearing_step_rad = static_cast<float>(v.step_centideg / 100.0 * degree);
  line_.ranges_m = std::span(ranges_m_).first(count);
  return true;
}

void Session::take_time(Variant variant, std::size_t telegram_bytes, const scanner::Now& now) {
  const std::int64_t wire_ns = std::int64_t{10'000'000'000} * static_cast<std::int64_t>(telegram_bytes) / baud();
  const std::int64_t scan_turns = 100 / variant.step_centideg;
  const std::int64_t turns = std::max(scan_turns, (wire_ns + turn_ns - 1) / turn_ns);
  const std::uint64_t lost = counters_.bad_checksum + counters_.wrong_length;
  const auto lost_now = static_cast<std::int64_t>(lost - lost_before_);
  lost_before_ = lost;
  const std::int64_t sent_ns = clock_.sent_ns(now.steady_ns, turns * (1 + lost_now));
  line_.host_ns = now.to_host(sent_ns - wire_ns - (scan_turns - 1) * turn_ns - turn_ns * variant.field_deg / 360);
}

}  // namespace curbline::lms200
