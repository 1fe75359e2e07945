#include "scip2/session.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <numbers>

#include "scip2/codec.hpp"
#include "text/part.hpp"

namespace curbline::scip2 {
namespace {

constexpr int clock_questions = 8;
constexpr std::array<std::uint8_t, 3> stop_command{'Q', 'T', '\n'};

/// The number after "NAME:" in a reply's body; -1 if there is none.
int field(std::string_view body, std::string_view name) {
  const std::size_t at = body.find(name);
  if (at == std::string_view::npos) return -1;
  const char* digits = body.data() + at + name.size();
  int value = -1;
  std::from_chars(digits, body.data() + body.size(), value);
  return value;
}

void put_digits(int value, std::span<char> digits) {
  for (std::size_t i = digits.size(); i-- > 0; value /= 10) digits[i] = static_cast<char>('0' + value % 10);
}

}  // namespace

void Session::restart(const scanner::Now&) {
  decoder_.restart();
  stamps_.restart();
  clock_.restart();
  parameters_ = {};
  problem_ = {};
  go_to(Step::stop);
}

void Session::go_to(Step step) {
  step_ = step;
  due_ = step != Step::measuring;
  if (step == Step::clock_on) clock_asked_ = 0;
}

/// The command of this step, without its line end.
void Session::write_command() {
  constexpr std::string_view commands[] = {"QT", "SCIP2.0", "PP", "TM0", "TM1", "TM2", "BM", "MD0000000000000"};
  const std::string_view text = commands[static_cast<std::size_t>(step_)];
  std::copy(text.begin(), text.end(), command_.begin());
  command_size_ = text.size();
  if (step_ == Step::measure) {
    put_digits(parameters_.first_step, std::span(command_).subspan(2, 4));
    put_digits(parameters_.last_step, std::span(command_).subspan(6, 4));
  }
}

std::span<const std::uint8_t> Session::to_send(const scanner::Now& now) {
  if (step_ == Step::measuring || !is_due(now)) return {};
  write_command();
  command_[command_size_] = '\n';
  return {reinterpret_cast<const std::uint8_t*>(command_.data()), command_size_ + 1};
}

std::span<const std::uint8_t> Session::farewell() const {
  return stop_command;
}

bool Session::take(std::span<const std::uint8_t>& bytes, const scanner::Now& now) {
  while (true) {
    switch (decoder_.take(bytes)) {
      case Decoder::Event::none:
        return false;
      case Decoder::Event::reply:
        take_reply(decoder_.reply(), now);
        break;
      case Decoder::Event::scan:
        if (step_ == Step::measuring && take_scan(decoder_.scan(), now)) return true;
        break;
    }
  }
}

void Session::take_reply(const Reply& reply, const scanner::Now& now) {
  if (step_ == Step::measuring) return end_of_stream(reply);
  const bool good = reply.status == "00";
  if (due_ || reply.echo != command()) return;  // the reply to an older command
  switch (step_) {
    case Step::stop:
      go_to(reply.status == "0E" ? Step::clock_off : Step::scip2);  // 0E: it was left in clock adjustment
      break;
    case Step::scip2:  // a scanner that only speaks SCIP 2.0 may refuse this
      go_to(Step::parameters);
      break;
    case Step::parameters:
      take_parameters(reply);
      break;
    case Step::clock_on:
      go_to(good || reply.status == "02" ? Step::clock_ask : Step::laser_on);
      break;
    case Step::clock_ask:
      take_time(reply, now);
      break;
    case Step::clock_off:
      go_to(parameters_.steps_a_turn > 0 ? Step::laser_on : Step::scip2);
      break;
    case Step::laser_on:
      if (!good && reply.status != "02") return refuse("the scanner refuses to switch its laser on (command BM)");
      go_to(Step::measure);
      break;
    case Step::measure:
      if (!good) return refuse("the scanner refuses to measure (command MD)");
      problem_ = {};
      go_to(Step::measuring);
      break;
    case Step::measuring:
      break;
  }
}

/// A stream that ends with a status other than 99: a fault of the scanner.
void Session::end_of_stream(const Reply& reply) {
  if (reply.echo != command()) {
    ++counters_.malformed;
    return;
  }
  if (reply.status == "00") return;
  ++counters_.device_errors;
  problem_ = "the scanner stopped measuring for a fault of its own; expected status 99";
  go_to(Step::stop);
}

void Session::refuse(std::string_view problem) {
  ++counters_.refused;
  problem_ = problem;
}

void Session::take_parameters(const Reply& reply) {
  const Parameters p{field(reply.body, "DMIN:"), field(reply.body, "DMAX:"), field(reply.body, "ARES:"),
                     field(reply.body, "AMIN:"), field(reply.body, "AMAX:"), field(reply.body, "AFRT:"),
                     field(reply.body, "SCAN:")};
  const bool good = reply.status == "00" && p.dmin_mm >= 0 && p.dmax_mm > p.dmin_mm && p.steps_a_turn > 0 &&
                    p.first_step >= 0 && p.last_step >= p.first_step && p.last_step < 10'000 &&
                    p.last_step - p.first_step < most_steps && p.front_step >= 0 && p.turns_a_minute > 0;
  if (good) {
    parameters_ = p;
    go_to(Step::clock_on);
  } else {
    ++counters_.malformed;
    problem_ = "the scanner's parameters are no scan of at most 1441 steps (command PP)";
  }
}

void Session::take_time(const Reply& reply, const scanner::Now& now) {
  if (reply.status == "00" && reply.body.size() == 5) {
    if (const auto device_ns = stamps_.unwrap(decode(port::part(reply.body, 0, 4))))
      clock_.anchor(*device_ns, now.steady_ns);
  }
  go_to(++clock_asked_ < clock_questions ? Step::clock_ask : Step::clock_off);
}

bool Session::take_scan(const Scan& scan, const scanner::Now& now) {
  const Parameters& p = parameters_;
  if (scan.first_step != p.first_step || scan.last_step != p.last_step) {
    ++counters_.malformed;
    return false;
  }
  const auto device_ns = stamps_.unwrap(scan.stamp_ms);
  if (!device_ns) {
    ++counters_.stamps_back;
    if (stamps_.lost()) restart(now);  // the scanner has restarted while the connection stayed up
    return false;
  }
  clock_.follow(*device_ns, now.steady_ns);
  for (std::size_t i = 0; i < scan.ranges_mm.size(); ++i) {
    const auto range_mm = static_cast<int>(scan.ranges_mm[i]);
    const bool is_return = range_mm >= p.dmin_mm && range_mm <= p.dmax_mm;
    ranges_m_[i] = is_return ? static_cast<float>(range_mm / 1000.0) : std::numeric_limits<float>::quiet_NaN();
  }
  const double step_rad = 2.0 * std::numbers::pi / p.steps_a_turn;
  const std::int64_t first_step_ns = *device_ns + p.since_step_0_ns();
  ++counters_.lines;
  line_ = {now.to_host(clock_.to_steady(first_step_ns)), first_step_ns,
           static_cast<float>((p.first_step - p.front_step) * step_rad), static_cast<float>(step_rad),
           std::span(ranges_m_).first(scan.ranges_mm.size())};
  return true;
}

}  // namespace curbline::scip2
