// Turns a SICK LMS151 (or another LMS1xx) into scan lines, over CoLa B: "sEN LMDscandata 1" requests every scan, and is
// repeated until the scanner confirms it. The scanner's configuration is not changed: resolution and field of view are
// as set in it and are contained in every telegram. Port 2112 must be set to CoLa B (binary); if a scanner answers in
// CoLa A, problem() says so.
//
// Time: a telegram contains the scan's start and its own transmission, in microseconds of one 32-bit counter. The
// transmission is compared with the arrival (a lower envelope), so that the duration of a scan does not matter. Source:
// SICK 8014631.
#pragma once

#include <array>

#include "cola/scan_data.hpp"
#include "cola/telegram.hpp"
#include "scanner/device_clock.hpp"
#include "scanner/session.hpp"

namespace curbline::cola {

inline constexpr int tcp_port = 2112;
inline constexpr std::size_t most_beams = 1441;

class Session final : public scanner::Session {
 public:
  Session() : telegrams_(counters_) {}

  void restart(const scanner::Now& now) override;
  std::span<const std::uint8_t> to_send(const scanner::Now& now) override;
  bool take(std::span<const std::uint8_t>& bytes, const scanner::Now& now) override;
  std::int64_t log_time_ns(std::int64_t near_ns) const override { return stamps_.nearest_ns(line_.device_ns, near_ns); }
  std::span<const std::uint8_t> farewell() const override;

 private:
  bool take_content(std::span<const std::uint8_t> content, const scanner::Now& now);
  bool take_scan(std::span<const std::uint8_t> content, const scanner::Now& now);
  bool take_time(const ScanData& data, const scanner::Now& now);
  void look_for_cola_a(std::span<const std::uint8_t> bytes);

  TelegramBuffer telegrams_;
  bool confirmed_ = false;
  scanner::StampCounter stamps_{32, 1'000};
  scanner::DeviceClock clock_{0};
  std::array<float, most_beams> ranges_m_{};
};

}  // namespace curbline::cola
