#include "cola/session.hpp"

#include <numbers>

namespace curbline::cola {
namespace {

constexpr double ahead_deg = 90.0;
constexpr std::string_view scan_sent = "sSN LMDscandata ", scan_asked = "sRA LMDscandata ";

constexpr std::array<std::uint8_t, 26> switch_stream(std::uint8_t on) {
  std::array<std::uint8_t, 26> telegram{2, 2, 2, 2, 0, 0, 0, 17};
  std::uint8_t sum = on;
  std::size_t size = 8;
  for (const char c : std::string_view("sEN LMDscandata ")) {
    telegram[size++] = static_cast<std::uint8_t>(c);
    sum = static_cast<std::uint8_t>(sum ^ static_cast<std::uint8_t>(c));
  }
  telegram[size++] = on;
  telegram[size] = sum;
  return telegram;
}

constexpr auto start_stream = switch_stream(1), stop_stream = switch_stream(0);

}  // namespace

void Session::restart(const scanner::Now&) {
  telegrams_.restart();
  stamps_.restart();
  clock_.restart();
  confirmed_ = false;
  due_ = true;
  problem_ = {};
}

std::span<const std::uint8_t> Session::to_send(const scanner::Now& now) {
  if (confirmed_ || !is_due(now)) return {};
  return start_stream;
}

std::span<const std::uint8_t> Session::farewell() const {
  return stop_stream;
}

bool Session::take(std::span<const std::uint8_t>& bytes, const scanner::Now& now) {
  if (!confirmed_) look_for_cola_a(bytes);
  while (true) {
    const auto telegram = telegrams_.take(bytes);
    if (telegram.empty()) return false;
    if (take_content(content_of(telegram), now)) return true;
  }
}

/// CoLa A frames its text with single 0x02 and 0x03 characters.
void Session::look_for_cola_a(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= 2 && bytes[0] == 0x02 && bytes[1] == 's') {
    problem_ = "the scanner answers in CoLa A (text); expected CoLa B (binary), which is set in SOPAS ET";
  }
}

bool Session::take_content(std::span<const std::uint8_t> content, const scanner::Now& now) {
  if (begins(content, scan_sent) || begins(content, scan_asked)) {
    confirmed_ = true;
    return take_scan(content.subspan(scan_sent.size()), now);
  }
  if (begins(content, "sEA LMDscandata ")) {
    confirmed_ = content.back() == 1;
    if (confirmed_) problem_ = {};
  } else if (begins(content, "sFA")) {
    ++counters_.refused;
    problem_ = "the scanner refuses to send its scans (sEN LMDscandata)";
  }
  return false;
}

bool Session::take_scan(std::span<const std::uint8_t> content, const scanner::Now& now) {
  ScanData data;
  switch (parse_scan_data(content, data, ranges_m_)) {
    case ScanResult::ok:
      break;
    case ScanResult::no_dist1:
      ++counters_.unsupported;
      problem_ = "the scanner sends no distances; expected channel DIST1 in its telegrams (LMDscandatacfg)";
      return false;
    case ScanResult::malformed:
    case ScanResult::too_many:
      ++counters_.malformed;
      return false;
  }
  if ((data.device_status & 5) != 0) {
    ++counters_.device_errors;
    problem_ = "the scanner reports a fault or a dirty front screen";
  }
  if (!take_time(data, now)) return false;
  ++counters_.lines;
  constexpr double degree = std::numbers::pi / 180.0;
  line_.first_bearing_rad = static_cast<float>((data.start_angle_deg - ahead_deg) * degree);
  line_.bearing_step_rad = static_cast<float>(data.step_deg * degree);
  line_.ranges_m = std::span(ranges_m_).first(data.count);
  return true;
}

bool Session::take_time(const ScanData& data, const scanner::Now& now) {
  const auto device_ns = stamps_.unwrap(data.start_us);
  if (!device_ns) {
    ++counters_.stamps_back;
    if (stamps_.lost()) restart(now);  // the scanner has restarted while the connection stayed up
    return false;
  }
  const std::int64_t duration_ns =
      static_cast<std::int64_t>(data.transmission_us - data.start_us) * 1000;  // modulo 2^32
  clock_.anchor(*device_ns + duration_ns, now.steady_ns);
  line_.device_ns = *device_ns;
  line_.host_ns = now.to_host(clock_.to_steady(*device_ns));
  return true;
}

}  // namespace curbline::cola
