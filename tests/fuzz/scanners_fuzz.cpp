// Any bytes from a scanner, among its own telegrams, whole or changed, with sums that fit or not: a session gives out
// lines that can be used, goes on, and says what it drops.
#include <cmath>
#include <memory>

#include "cola/session.hpp"
#include "fuzz/claim.hpp"
#include "fuzz/numbers.hpp"
#include "lms200/session.hpp"
#include "lms200/telegram.hpp"
#include "scanner/device.hpp"
#include "scip2/session.hpp"

namespace curbline::fuzz {
namespace {

using tools::Bytes;

/// The sums of a telegram that has been changed, made anew: what a device sends that means something else.
void sum_up_scip2(Bytes& bytes) {
  std::size_t begin = 0;
  for (std::size_t end = 0; end < bytes.size(); ++end) {
    if (bytes[end] != '\n') continue;
    unsigned sum = 0;
    for (std::size_t i = begin; i + 1 < end; ++i) sum += bytes[i];
    if (begin > 0 && end > begin + 1) bytes[end - 1] = static_cast<std::uint8_t>((sum & 0x3F) + 0x30);  // not the echo
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

struct Scanner {
  std::shared_ptr<scanner::Session> session;
  std::unique_ptr<tools::Device> device;
  void (*sum_up)(Bytes&);
  tools::CarmenLine line;
};

tools::CarmenLine geometry(std::size_t beams, double first_deg, double step_deg, double longest_m) {
  constexpr double degree = 3.14159265358979 / 180;
  tools::CarmenLine line;
  line.start_angle_rad = first_deg * degree;
  line.angular_resolution_rad = step_deg * degree;
  line.field_of_view_rad = line.angular_resolution_rad * static_cast<double>(beams - 1);
  line.maximum_range_m = longest_m;
  line.ranges_m.assign(beams, 1.5f);
  return line;
}

Scanner some_scanner(Numbers& numbers) {
  const int which = numbers.whole(0, 2);
  if (which == 0) {
    const tools::CarmenLine line = geometry(41, -5, 0.25, 30);
    return {std::make_shared<scip2::Session>(), tools::make_scip2_device(line, "fuzz"), sum_up_scip2, line};
  }
  if (which == 1) {
    const tools::CarmenLine line = geometry(21, -5, 0.5, 50);
    return {std::make_shared<cola::Session>(), tools::make_cola_device(line, "fuzz"), sum_up_cola, line};
  }
  const tools::CarmenLine line = geometry(101, -50, 1, 8);
  return {std::make_shared<lms200::Session>(101), tools::make_lms200_device(line, "fuzz"), sum_up_lms200, line};
}

void change(Numbers& numbers, Scanner& s, Bytes& bytes) {
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
  if (numbers.flag()) s.sum_up(bytes);
}

void look_at(const scanner::Session& session) {
  const scanner::Line& line = session.line();
  claim(std::isfinite(line.first_bearing_rad) && std::isfinite(line.bearing_step_rad), "bearings are numbers");
  for (const float range : line.ranges_m) claim(std::isnan(range) || range >= 0.0f, "a range is not below 0, or none");
  session.log_time_ns(1'700'000'000'000'000'000);
}

void run(Numbers& numbers) {
  Scanner s = some_scanner(numbers);
  scanner::Now now{1'800'000'000'000'000'000, 0};
  const auto take = [&](Bytes bytes) {
    change(numbers, s, bytes);
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
        if (s.device->measuring()) take(s.device->telegram(s.line));
    }
    s.line.time_ns += numbers.seldom() ? numbers.time_ns() / 4 : 20'000'000;
    s.line.time_ns &= INT64_MAX / 2;
    s.session->problem();
  }
}

}  // namespace
}  // namespace curbline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  curbline::fuzz::Numbers numbers(bytes, size);
  curbline::fuzz::run(numbers);
  return 0;
}
