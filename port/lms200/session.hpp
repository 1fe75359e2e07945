// Turns a SICK LMS200 (LMS2xx) on a serial line into scan lines. The session looks for the scanner at 500000, 38400,
// 9600 (its rate after power-on) and 19200 baud, switches it to 38400 from the lower two, requests its measuring mode
// (74h), sets field of view and step to those of the robot's description (3Bh), and starts it (20h 24h). It does not
// write the EEPROM.
//
// The telegrams have no time stamps: a line's time is derived from its arrival and the turns of the mirror
// (turn_clock.hpp), minus the transmission time and the part of a turn that its field of view takes, to within a few
// milliseconds. At 38400 baud the line carries 9 of the scanner's 75 scans a second; 500000 baud, RS-422, carries all.
// Source: SICK 8007954.
#pragma once

#include <array>

#include "lms200/scan_data.hpp"
#include "lms200/telegram.hpp"
#include "lms200/turn_clock.hpp"
#include "scanner/session.hpp"

namespace curbline::lms200 {

class Session final : public scanner::Session {
 public:
  /// `beams` is that of the robot's laser. The scanner is set to that number if it has a matching field and step;
  /// otherwise it is left as it is.
  explicit Session(std::size_t beams) : telegrams_(counters_), variant_(variant_of(beams)) {}

  void restart(const scanner::Now& now) override;
  std::span<const std::uint8_t> to_send(const scanner::Now& now) override;
  bool take(std::span<const std::uint8_t>& bytes, const scanner::Now& now) override;
  std::int64_t log_time_ns(std::int64_t near_ns) const override { return near_ns; }
  std::span<const std::uint8_t> farewell() const override;
  int baud() const override;

 private:
  enum class Step : unsigned char { find, speed_up, configuration, variant, start, measuring };

  void go_to(Step step);
  std::size_t write_command();
  bool take_content(std::span<const std::uint8_t> content, const scanner::Now& now);
  void take_reply(std::span<const std::uint8_t> content);
  void refuse(std::string_view problem);
  void take_time(Variant variant, std::size_t telegram_bytes, const scanner::Now& now);
  bool take_scan(std::span<const std::uint8_t> content, const scanner::Now& now);

  HostBuffer telegrams_;
  Variant variant_;
  Step step_ = Step::find;
  int tries_ = 0;
  std::size_t baud_ = 0;  ///< index of the rate that is being tried
  std::array<std::uint8_t, 16> command_{};
  int range_bits_ = 13;
  TurnClock clock_{};
  std::uint64_t lost_before_ = 0;  ///< number of lost telegrams when the last line came
  std::array<float, most_beams> ranges_m_{};
};

}  // namespace curbline::lms200
