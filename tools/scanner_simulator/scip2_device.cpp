// A UTM-30LX: QT, SCIP2.0, PP, TM, BM, MD and MS, RS. Source: Hokuyo C-42-03320B.
#include <cmath>
#include <numbers>
#include <string_view>

#include "formats/bad_input.hpp"
#include "scanner_simulator/device.hpp"
#include "scip2/codec.hpp"
#include "scip2/decoder.hpp"

namespace curbline::tools {
namespace {

constexpr int dmin_mm = 23, dmax_mm = 60'000;
constexpr std::uint32_t no_return = 1;  // a value below DMIN is an error code
constexpr double turn_ns = 25e6;
constexpr std::size_t block = 64;

std::uint32_t range_mm(float range_m) {
  if (!(range_m > 0.0f)) return no_return;
  const long mm = std::lround(static_cast<double>(range_m) * 1000.0);
  return mm < dmin_mm || mm > dmax_mm ? no_return : static_cast<std::uint32_t>(mm);
}

std::string stamp_text(std::int64_t time_ns) {
  std::string text(4, '0');
  scip2::encode(static_cast<std::uint32_t>((time_ns + 500'000) / 1'000'000), text);
  return text + scip2::sum_of(text) + "\n";
}

std::string reply(const std::string& echo, std::string_view status, const std::string& body = {}) {
  return echo + "\n" + std::string(status) + scip2::sum_of(status) + "\n" + body + "\n";
}

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

class Scip2Device final : public Device {
 public:
  explicit Scip2Device(const CarmenLine& scan)
      : steps_(static_cast<int>(scan.ranges_m.size())),
        steps_a_turn_(static_cast<int>(std::lround(2.0 * std::numbers::pi / scan.angular_resolution_rad))),
        front_(static_cast<int>(std::lround(-scan.start_angle_rad / scan.angular_resolution_rad))) {}

  Bytes power_on() override {
    command_.clear();
    scan_command_.clear();
    laser_on_ = adjusting_ = false;
    return {};
  }

  Bytes take(std::span<const std::uint8_t> bytes, std::int64_t clock_ns) override {
    std::string replies;
    for (const std::uint8_t byte : bytes) {
      if (byte != '\n' && byte != '\r') {
        command_ += static_cast<char>(byte);
      } else if (!command_.empty()) {
        replies += answer(command_, clock_ns);
        command_.clear();
      }
    }
    return bytes_of(replies);
  }

  bool measuring() const override { return !scan_command_.empty(); }

  Bytes telegram(const CarmenLine& scan) override {
    const std::size_t width = scan_command_[1] == 'D' ? 3 : 2;
    std::string characters;
    for (int step = first_; step <= last_; ++step) {
      std::string text(width, '0');
      scip2::encode(range_mm(scan.ranges_m[static_cast<std::size_t>(step)]), text);
      characters += text;
    }
    std::string body = stamp_text(scan.time_ns);
    for (std::size_t at = 0; at < characters.size(); at += block) {
      const std::string part = characters.substr(at, block);
      body += part + scip2::sum_of(part) + "\n";
    }
    return bytes_of(reply(scan_command_, "99", body));
  }

  std::int64_t line_duration_ns() const override { return std::llround(turn_ns * (steps_ - 1) / steps_a_turn_); }

 private:
  std::string answer(const std::string& command, std::int64_t clock_ns) {
    if (command.starts_with("TM")) return answer_clock(command, clock_ns);
    if (adjusting_) return reply(command, "0E");
    if (command == "QT" || command == "RS") {
      scan_command_.clear();
      laser_on_ = false;
      return reply(command, "00");
    }
    if (command == "PP") return reply(command, "00", parameters());
    if (command == "BM") {
      const bool was_on = laser_on_;
      laser_on_ = true;
      return reply(command, was_on ? "02" : "00");
    }
    if (command.starts_with("MD") || command.starts_with("MS")) return answer_measure(command);
    return reply(command, "0E");  // unknown command; also SCIP2.0, because it supports nothing else
  }

  std::string answer_clock(const std::string& command, std::int64_t clock_ns) {
    if (command == "TM0") {
      const bool was = adjusting_;
      adjusting_ = true;
      scan_command_.clear();
      return reply(command, was ? "02" : "00");
    }
    if (command == "TM1")
      return adjusting_ ? reply(command, "00", stamp_text(clock_ns - 500'000)) : reply(command, "04");
    if (command != "TM2") return reply(command, "01");
    const bool was = adjusting_;
    adjusting_ = false;
    return reply(command, was ? "00" : "03");
  }

  std::string answer_measure(const std::string& command) {
    constexpr std::size_t size = 15;
    if (command.size() < size) return reply(command, "0C");
    if (command.find_first_not_of("0123456789", 2) != std::string::npos) return reply(command, "01");
    first_ = std::stoi(command.substr(2, 4));
    last_ = std::stoi(command.substr(6, 4));
    if (last_ >= steps_) return reply(command, "04");
    if (last_ < first_) return reply(command, "05");
    laser_on_ = true;
    scan_command_ = command;
    return reply(command, "00");
  }

  std::string parameters() const {
    std::string text;
    const auto add = [&text](const std::string& field) { text += field + ";" + scip2::sum_of(field) + "\n"; };
    add("MODL:UTM-30LX");
    add("DMIN:" + std::to_string(dmin_mm));
    add("DMAX:" + std::to_string(dmax_mm));
    add("ARES:" + std::to_string(steps_a_turn_));
    add("AMIN:0");
    add("AMAX:" + std::to_string(steps_ - 1));
    add("AFRT:" + std::to_string(front_));
    add("SCAN:2400");
    return text;
  }

  int steps_, steps_a_turn_, front_;
  int first_ = 0, last_ = 0;
  bool laser_on_ = false, adjusting_ = false;
  std::string command_, scan_command_;
};

}  // namespace

std::unique_ptr<Device> make_scip2_device(const CarmenLine& scan, const std::string& source) {
  const bool fits =
      scan.ranges_m.size() <= scip2::most_steps && scan.angular_resolution_rad > 0 && scan.start_angle_rad <= 0;
  if (!fits)
    throw BadInput(source + ": no scan of a UTM-30LX; expected at most 1441 beams, counterclockwise from the right");
  return std::make_unique<Scip2Device>(scan);
}

}  // namespace curbline::tools
