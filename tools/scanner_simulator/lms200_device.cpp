// An LMS200: 20h (modes 24h, 25h and the speeds), 3Bh, 74h; anything else is refused with 0x15. Source: SICK 8007954.
#include <cmath>
#include <numbers>
#include <string_view>

#include "formats/bad_input.hpp"
#include "lms200/scan_data.hpp"
#include "lms200/telegram.hpp"
#include "scanner_simulator/device.hpp"

namespace curbline::tools {
namespace {

constexpr std::uint8_t status_well = 0x10, address = 0x80;
constexpr double turn_ns = 1e9 / 75.0;
constexpr int furthest_mm = 8182, no_return = 8183;
constexpr std::uint16_t millimetres = 1 << 14;

Bytes framed(Bytes content) {
  content.push_back(status_well);
  Bytes telegram(content.size() + lms200::frame_bytes);
  lms200::frame(address, content, telegram);
  return telegram;
}

std::uint16_t range_mm(float range_m) {
  if (!(range_m > 0.0f)) return no_return;
  const long mm = std::lround(static_cast<double>(range_m) * 1000.0);
  return static_cast<std::uint16_t>(mm > furthest_mm ? no_return : mm);
}

class Lms200Device final : public Device {
 public:
  Lms200Device(std::size_t beams, int power_on_baud)
      : variant_(lms200::variant_of(beams)), power_on_baud_(power_on_baud), baud_(power_on_baud) {}

  Bytes power_on() override {
    telegrams_.restart();
    measuring_ = false;
    baud_ = power_on_baud_;
    constexpr std::string_view name = "LMS200;30106;V02.30 ";
    Bytes content{0x90};
    content.insert(content.end(), name.begin(), name.end());
    return framed(content);
  }

  Bytes take(std::span<const std::uint8_t> bytes, std::int64_t) override {
    Bytes replies;
    while (true) {
      const auto telegram = telegrams_.take(bytes);
      if (telegram.empty()) return replies;
      const Bytes content = answer(lms200::content_of(telegram));
      replies.push_back(content.empty() ? lms200::not_acknowledged : lms200::acknowledged);
      if (content.empty()) continue;
      const Bytes reply = framed(content);
      replies.insert(replies.end(), reply.begin(), reply.end());
    }
  }

  bool measuring() const override { return measuring_; }
  int baud() const override { return baud_; }

  Bytes telegram(const CarmenLine& scan) override {
    Bytes content{0xB0};
    const auto put = [&content](std::uint16_t value) {
      content.push_back(static_cast<std::uint8_t>(value));
      content.push_back(static_cast<std::uint8_t>(value >> 8));
    };
    put(static_cast<std::uint16_t>(scan.ranges_m.size() | millimetres));
    for (const float range_m : scan.ranges_m) put(range_mm(range_m));
    return framed(content);
  }

  std::int64_t line_duration_ns() const override { return std::llround(turn_ns * variant_.field_deg / 360.0); }

 private:
  /// Content of the reply; empty for an unknown command.
  Bytes answer(std::span<const std::uint8_t> command) {
    if (command.size() == 2 && command[0] == 0x20) return answer_mode(command[1]);
    if (command.size() == 1 && command[0] == 0x74) {
      Bytes configuration(35, 0);  // measuring mode 0 (8 m, three flags), unit 1 (millimetres)
      configuration[0] = 0xF4;
      configuration[7] = 1;
      return configuration;
    }
    if (command.size() == 5 && command[0] == 0x3B) {
      const bool same = (command[1] | command[2] << 8) == variant_.field_deg &&
                        (command[3] | command[4] << 8) == variant_.step_centideg;
      return {0xBB, same ? std::uint8_t{1} : std::uint8_t{0}, command[1], command[2], command[3], command[4]};
    }
    return {};
  }

  Bytes answer_mode(std::uint8_t mode) {
    switch (mode) {
      case 0x24:
      case 0x25:
        measuring_ = mode == 0x24;
        break;
      case 0x40:
        baud_ = 38'400;
        break;
      case 0x41:
        baud_ = 19'200;
        break;
      case 0x42:
        baud_ = 9'600;
        break;
      case 0x48:
        baud_ = 500'000;
        break;
      default:
        return {0xA0, 1};
    }
    return {0xA0, 0};
  }

  lms200::Variant variant_;
  scanner::Counters counters_{};
  lms200::ScannerBuffer telegrams_{counters_};
  bool measuring_ = false;
  int power_on_baud_, baud_;
};

}  // namespace

std::unique_ptr<Device> make_lms200_device(const CarmenLine& scan, const std::string& source, int baud) {
  const std::size_t beams = scan.ranges_m.size();
  const lms200::Variant variant = lms200::variant_of(beams);
  constexpr double degree = std::numbers::pi / 180.0;
  const bool fits =
      variant.field_deg != 0 && std::abs(scan.angular_resolution_rad - variant.step_centideg / 100.0 * degree) < 1e-4;
  if (!fits)
    throw BadInput(source +
                   ": no scan of an LMS200; expected 181 or 361 beams over 180 deg, or 101, 201 or 401 over 100");
  return std::make_unique<Lms200Device>(beams, baud);
}

}  // namespace curbline::tools
