// An LMS151 in CoLa B: sEN LMDscandata, sRN LMDscandata; anything else is an error (sFA). Source: SICK 8014631.
#include <bit>
#include <cmath>
#include <numbers>

#include "cola/session.hpp"
#include "cola/telegram.hpp"
#include "formats/bad_input.hpp"
#include "scanner_simulator/cola_content.hpp"
#include "scanner_simulator/device.hpp"

namespace curbline::tools {
namespace {

constexpr std::uint8_t unknown_command = 1, unknown_variable = 3;  // error codes of sFA
constexpr double turn_ns = 20e6, ahead_deg = 90.0;
constexpr std::uint16_t first_range = 16;

std::uint16_t range_mm(float range_m) {
  if (!(range_m > 0.0f)) return 0;
  const long mm = std::lround(static_cast<double>(range_m) * 1000.0);
  return mm < first_range || mm > 65'535 ? std::uint16_t{0} : static_cast<std::uint16_t>(mm);
}

class ColaDevice final : public Device {
 public:
  explicit ColaDevice(const CarmenLine& scan) : last_(scan) {}

  Bytes power_on() override {
    telegrams_.restart();
    measuring_ = false;
    return {};
  }

  Bytes take(std::span<const std::uint8_t> bytes, std::int64_t) override {
    Bytes replies;
    while (true) {
      const auto telegram = telegrams_.take(bytes);
      if (telegram.empty()) return replies;
      const Bytes reply = answer(cola::content_of(telegram));
      replies.insert(replies.end(), reply.begin(), reply.end());
    }
  }

  bool measuring() const override { return measuring_; }

  Bytes telegram(const CarmenLine& scan) override {
    last_ = scan;
    return scan_data("sSN LMDscandata ");
  }

  std::int64_t line_duration_ns() const override {
    return std::llround(turn_ns * static_cast<double>(last_.ranges_m.size() - 1) * last_.angular_resolution_rad /
                        (2.0 * std::numbers::pi));
  }

 private:
  Bytes answer(std::span<const std::uint8_t> content) {
    constexpr std::string_view stream = "sEN LMDscandata ";
    if (cola::begins(content, stream) && content.size() == stream.size() + 1) {
      measuring_ = content.back() == 1;
      return ColaContent("sEA LMDscandata ").number(content.back(), 1).telegram();
    }
    if (cola::begins(content, "sRN LMDscandata") && content.size() == 15) return scan_data("sRA LMDscandata ");
    return ColaContent("sFA ").number(cola::begins(content, "sRN ") ? unknown_variable : unknown_command, 2).telegram();
  }

  Bytes scan_data(std::string_view command) {
    constexpr double tenthousandths = 1e4 * 180.0 / std::numbers::pi;
    const auto start_us = static_cast<std::uint32_t>((last_.time_ns + 500) / 1000);
    ++count_;
    ColaContent content(command);
    content.number(1, 2).number(1, 2).number(0x00C0FFEE, 4).number(0, 2).number(count_, 2).number(count_, 2);
    content.number(start_us, 4).number(start_us + static_cast<std::uint32_t>(line_duration_ns() / 1000), 4);
    content.number(0, 2).number(0x0700, 2).number(0, 2).number(5000, 4).number(540, 4).number(0, 2).number(1, 2);
    content.text("DIST1").number(std::bit_cast<std::uint32_t>(1.0f), 4).number(0, 4);
    content.number(static_cast<std::uint32_t>(std::lround(last_.start_angle_rad * tenthousandths + ahead_deg * 1e4)),
                   4);
    content.number(static_cast<std::uint32_t>(std::lround(last_.angular_resolution_rad * tenthousandths)), 2);
    content.number(static_cast<std::uint32_t>(last_.ranges_m.size()), 2);
    for (const float range_m : last_.ranges_m) content.number(range_mm(range_m), 2);
    content.number(0, 2).number(0, 2).number(0, 2).number(0, 2).number(0, 2).number(0, 2);
    return content.telegram();
  }

  scanner::Counters counters_{};
  cola::TelegramBuffer telegrams_{counters_};
  bool measuring_ = false;
  std::uint16_t count_ = 0;
  CarmenLine last_;
};

}  // namespace

std::unique_ptr<Device> make_cola_device(const CarmenLine& scan, const std::string& source) {
  const bool fits =
      scan.ranges_m.size() >= 2 && scan.ranges_m.size() <= cola::most_beams && scan.angular_resolution_rad > 0;
  if (!fits) throw BadInput(source + ": no scan of an LMS1xx; expected 2 to 1441 beams, counterclockwise");
  return std::make_unique<ColaDevice>(scan);
}

}  // namespace curbline::tools
