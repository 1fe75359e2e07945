// Arbitrary bytes from a scanner among its own telegrams, intact or changed, with or without a matching checksum: a
// session returns lines that can be used, goes on, and reports what it drops.
#include <cmath>
#include <string>
#include <utility>

#include "fuzz/claim.hpp"
#include "fuzz/run.hpp"
#include "lms200/telegram.hpp"
#include "port/scanner_support.hpp"
#include "scip2/codec.hpp"

namespace curbline::fuzz {
namespace {

using tools::Bytes;

/// Recomputes the checksums of a changed telegram, as if a device had sent other contents.
void sum_up_scip2(Bytes& bytes) {
  std::size_t begin = 0;
  for (std::size_t end = 0; end < bytes.size(); ++end) {
    if (bytes[end] != '\n') continue;
    const std::string line(bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                           bytes.begin() + static_cast<std::ptrdiff_t>(end));
    if (begin > 0 && line.size() > 1)  // not the echo
      bytes[end - 1] = static_cast<std::uint8_t>(scip2::sum_of(line.substr(0, line.size() - 1)));
    begin = end + 1;
  }
}
void sum_up_cola(Bytes& bytes) {
  if (bytes.size() < 10) return;
  bytes.back() = 0;
  for (std::size_t i = 8; i + 1 < bytes.size(); ++i) bytes.back() ^= bytes[i];
}
void sum_up_lms200(Bytes& bytes) {
  if (bytes.size() < lms200::frame_bytes) return;
  const std::size_t size = bytes.size() - lms200::crc_bytes;
  const unsigned crc = lms200::crc_of({bytes.data(), size});
  bytes[size] = static_cast<std::uint8_t>(crc & 0xFF);
  bytes[size + 1] = static_cast<std::uint8_t>(crc >> 8);
}

void sum_up(tools::Protocol protocol, Bytes& bytes) {
  switch (protocol) {
    case tools::Protocol::scip2:
      return sum_up_scip2(bytes);
    case tools::Protocol::cola:
      return sum_up_cola(bytes);
    case tools::Protocol::lms200:
      return sum_up_lms200(bytes);
  }
}

void change(Numbers& numbers, tools::Protocol protocol, Bytes& bytes) {
  for (int changes = numbers.whole(0, 4); changes > 0 && !bytes.empty(); --changes) {
    const auto at = static_cast<std::size_t>(numbers.whole(0, static_cast<int>(bytes.size()) - 1));
    switch (numbers.whole(0, 3)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), numbers.byte());
        break;
      default:
        bytes[at] = numbers.byte();
    }
  }
  if (numbers.flag()) sum_up(protocol, bytes);
}

void look_at(const scanner::Session& session) {
  const scanner::Line& line = session.line();
  claim(std::isfinite(line.first_bearing_rad) && std::isfinite(line.bearing_step_rad), "bearings are numbers");
  for (const float range : line.ranges_m) claim(std::isnan(range) || range >= 0.0f, "a range is not below 0, or none");
  session.log_time_ns(1'700'000'000'000'000'000);
}

}  // namespace

void run(Numbers& numbers) {
  test::Scanner s = std::move(test::small_scanners()[static_cast<std::size_t>(numbers.whole(0, 2))]);
  scanner::Now now{1'800'000'000'000'000'000, 0};
  const auto take = [&](Bytes bytes) {
    change(numbers, s.protocol, bytes);
    std::span<const std::uint8_t> left(bytes);
    while (s.session->take(left, now)) look_at(*s.session);
    claim(left.empty(), "all bytes are used");
  };
  s.session->restart(now);
  take(s.device->power_on());
  while (!numbers.used_up()) {
    now.steady_ns += numbers.whole(0, 60'000'000);
    now.host_ns = numbers.seldom() ? numbers.time_ns() / 4 : now.host_ns + 20'000'000;
    const std::span<const std::uint8_t> command = s.session->to_send(now);
    if (!command.empty()) take(s.device->take(command, now.steady_ns));
    switch (numbers.whole(0, 7)) {
      case 0:
        s.session->restart(now);
        break;
      case 1: {
        const std::string text = numbers.text();
        take(Bytes(text.begin(), text.end()));
        break;
      }
      default:
        if (s.device->measuring()) take(s.device->telegram(s.first));
    }
    s.first.time_ns += numbers.seldom() ? numbers.time_ns() / 4 : 20'000'000;
    s.first.time_ns &= INT64_MAX / 2;
    s.session->problem();
  }
}

}  // namespace curbline::fuzz
