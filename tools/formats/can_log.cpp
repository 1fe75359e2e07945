#include "formats/can_log.hpp"

#include <array>
#include <stdexcept>

#include "candump/candump.hpp"
#include "curbline/intake/rising_times.hpp"
#include "formats/decimals.hpp"
#include "formats/parse_number.hpp"

namespace curbline::tools {
namespace {

constexpr std::string_view lost = "DROPCOUNT: dropped ";  // written by candump -d, followed by a number

}  // namespace

std::optional<can::Frame> CanLogReader::next() {
  while (const auto text = source_.next()) {
    if (text->find_first_not_of(" \t") == std::string_view::npos || text->starts_with('#')) continue;
    if (text->starts_with(lost)) {
      const std::string_view rest = text->substr(lost.size());
      frames_lost_ += parse_number<std::uint64_t>(rest.substr(0, rest.find(' '))).value_or(1);
      continue;
    }
    const candump::ParsedLine parsed = candump::parse_line(*text);
    if (!parsed.ok()) source_.fail(std::string(parsed.error));
    if (!RisingTimes::is_time(parsed.frame.time_ns))
      source_.fail("the time is more than 126 years from 1970; expected seconds");
    interface_name_ = parsed.interface_name;
    return parsed.frame;
  }
  if (interface_name_.empty()) throw BadInput(path() + ": no CAN frame; expected at least one line of candump -L");
  return std::nullopt;
}

void OneInterface::check(const CanLogReader& log, const can::Signal& signal, const can::Frame& frame) {
  if (!can::carries(signal, frame)) return;
  if (name_.empty()) name_ = log.interface_name();
  if (name_ == log.interface_name()) return;
  throw BadInput(log.path(), log.line(),
                 "tilt frames of " + log.interface_name() + " after those of " + name_ + "; expected one interface");
}

std::string frame_of(const can::Signal& signal) {
  const std::string id = "id " + hexadecimal(signal.id) + (signal.extended ? " of 29 bits" : " of 11 bits");
  return signal.multiplexor ? id + " with multiplexor " + std::to_string(signal.multiplexor->value) : id;
}

void write_can_frame(std::ostream& out, const can::Frame& frame, std::string_view interface_name) {
  std::array<char, candump::max_line> line{};
  const std::size_t length = candump::format_line(frame, interface_name, line);
  if (length == 0) throw std::invalid_argument("write_can_frame: no frame of a CAN bus");
  out.write(line.data(), static_cast<std::streamsize>(length)) << '\n';
}

}  // namespace curbline::tools
