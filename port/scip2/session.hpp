// Turns a Hokuyo UTM-30LX (or another SCIP 2.0 scanner) into scan lines. It is set up with QT (stop), SCIP2.0, PP (its
// steps and ranges), TM (its clock), BM (laser on) and MD (every scan, all steps, three characters a range: two end at
// 4.095 m). A command is repeated if it is not answered within half a second.
//
// Time: the stamp is that of step 0, in whole milliseconds, 24 bits; a line has the time of its first step, which comes
// AMIN steps of the turn later (a UTM-30LX has AMIN 0). Before measuring, eight TM1 requests compare the scanner's
// clock with the host's (the one with the smallest delay counts; accurate to the millisecond of the stamp and the
// transmission delay); after that, lines are used to follow the drift. Sources: Hokuyo C-42-03320B; UTM-30LX
// specification C-42-3615; that the stamp is that of step 0 follows the driver urg_stamped.
#pragma once

#include <array>

#include "scanner/device_clock.hpp"
#include "scanner/session.hpp"
#include "scip2/decoder.hpp"

namespace curbline::scip2 {

inline constexpr int tcp_port = 10940;

/// The contents of the reply to PP.
struct Parameters {
  int dmin_mm = 0, dmax_mm = 0;  ///< ranges outside mean no return
  int steps_a_turn = 0;          ///< ARES
  int first_step = 0, last_step = 0, front_step = 0;
  int turns_a_minute = 0;  ///< SCAN

  /// From step 0 to the first step.
  std::int64_t since_step_0_ns() const {
    return std::int64_t{60'000'000'000} * first_step / (std::int64_t{turns_a_minute} * steps_a_turn);
  }
};

class Session final : public scanner::Session {
 public:
  Session() : decoder_(counters_) {}

  void restart(const scanner::Now& now) override;
  std::span<const std::uint8_t> to_send(const scanner::Now& now) override;
  bool take(std::span<const std::uint8_t>& bytes, const scanner::Now& now) override;
  std::int64_t log_time_ns(std::int64_t near_ns) const override { return stamps_.nearest_ns(line_.device_ns, near_ns); }
  std::span<const std::uint8_t> farewell() const override;

 private:
  enum class Step : unsigned char {
    stop,
    scip2,
    parameters,
    clock_on,
    clock_ask,
    clock_off,
    laser_on,
    measure,
    measuring
  };

  void go_to(Step step);
  void take_reply(const Reply& reply, const scanner::Now& now);
  void end_of_stream(const Reply& reply);
  void refuse(std::string_view problem);
  void take_parameters(const Reply& reply);
  void take_time(const Reply& reply, const scanner::Now& now);
  bool take_scan(const Scan& scan, const scanner::Now& now);
  void write_command();
  std::string_view command() const { return {command_.data(), command_size_}; }

  Decoder decoder_;
  Step step_ = Step::stop;
  std::array<char, 24> command_{};
  std::size_t command_size_ = 0;
  int clock_asked_ = 0;
  Parameters parameters_{};
  scanner::StampCounter stamps_{24, 1'000'000};
  scanner::DeviceClock clock_{25'000'000};  ///< a turn of a UTM-30LX, if the scanner refuses TM
  std::array<float, most_steps> ranges_m_{};
};

}  // namespace curbline::scip2
