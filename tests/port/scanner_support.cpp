#include "scanner_support.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "cola/session.hpp"
#include "lms200/session.hpp"
#include "scip2/session.hpp"

namespace curbline::test {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

CarmenLine geometry(int beams, double start_deg, double step_deg, double maximum_range_m, std::int64_t period_ns) {
  CarmenLine line;
  line.start_angle_rad = start_deg * degree;
  line.angular_resolution_rad = step_deg * degree;
  line.field_of_view_rad = line.angular_resolution_rad * (beams - 1);
  line.maximum_range_m = maximum_range_m;
  line.accuracy_m = static_cast<double>(period_ns) * 1e-9;  // line_of() reads the period from here
  line.ranges_m.assign(static_cast<std::size_t>(beams), 1.0f);
  return line;
}

Scanner scanner_of(tools::Protocol protocol, const CarmenLine& first) {
  switch (protocol) {
    case tools::Protocol::scip2:
      return {"scip2", protocol, first, std::make_shared<scip2::Session>(), tools::make_scip2_device(first, "test")};
    case tools::Protocol::cola:
      return {"cola", protocol, first, std::make_shared<cola::Session>(), tools::make_cola_device(first, "test")};
    case tools::Protocol::lms200:
      break;
  }
  return {"lms200", protocol, first, std::make_shared<lms200::Session>(first.ranges_m.size()),
          tools::make_lms200_device(first, "test")};
}

std::vector<Scanner> scanners(const CarmenLine& scip2, const CarmenLine& cola, const CarmenLine& lms200) {
  std::vector<Scanner> all;
  all.push_back(scanner_of(tools::Protocol::scip2, line_of(scip2, 0)));
  all.push_back(scanner_of(tools::Protocol::cola, line_of(cola, 0)));
  all.push_back(scanner_of(tools::Protocol::lms200, line_of(lms200, 0)));
  return all;
}

}  // namespace

std::vector<Scanner> small_scanners() {
  return scanners(geometry(41, -5, 0.25, 30, 25'000'000), geometry(21, -5, 0.5, 50, 20'000'000),
                  geometry(101, -50, 1, 8, 13'333'333));
}

std::vector<Scanner> whole_scanners() {
  return scanners(geometry(1081, -135, 0.25, 30, 25'000'000), geometry(541, -135, 0.5, 50, 20'000'000),
                  geometry(181, -90, 1, 8, 13'333'333));
}

CarmenLine line_of(const CarmenLine& geometry, int index) {
  CarmenLine line = geometry;
  line.time_ns = 1'700'000'000'000'000'000 + index * std::llround(geometry.accuracy_m * 1e9);
  for (std::size_t i = 0; i < line.ranges_m.size(); ++i) {
    const std::size_t mm = 100 + (static_cast<std::size_t>(index) * 7919 + i * 104'729) % 7800;
    line.ranges_m[i] =
        i % 11 == 10 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(static_cast<double>(mm) / 1000.0);
  }
  return line;
}

void start(Scanner& scanner) {
  scanner::Now now{1'800'000'000'000'000'000, 0};
  scanner.session->restart(now);
  scanner.device->power_on();
  while (true) {
    const auto command = scanner.session->to_send(now);
    if (command.empty()) return;
    const Bytes replies = scanner.device->take(command, scanner.first.time_ns - 100'000'000);
    std::span<const std::uint8_t> left(replies);
    while (scanner.session->take(left, now)) {
    }
    now.host_ns += 1'000'000;
    now.steady_ns += 1'000'000;
  }
}

std::vector<Bytes> telegrams_of(Scanner& scanner, int count, int first) {
  std::vector<Bytes> telegrams;
  for (int i = 0; i < count; ++i) telegrams.push_back(scanner.device->telegram(line_of(scanner.first, first + i)));
  return telegrams;
}

Bytes joined(const std::vector<Bytes>& telegrams) {
  Bytes all;
  for (const Bytes& telegram : telegrams) all.insert(all.end(), telegram.begin(), telegram.end());
  return all;
}

std::vector<int> lines_read(Scanner& scanner, const Bytes& bytes) {
  std::vector<int> lines;
  std::span<const std::uint8_t> left(bytes);
  while (scanner.session->take(left, {1'800'000'000'500'000'000, 500'000'000})) {
    lines.push_back(index_of(scanner.first, scanner.session->line().ranges_m));
  }
  return lines;
}

int index_of(const CarmenLine& geometry, std::span<const float> ranges_m) {
  if (ranges_m.size() != geometry.ranges_m.size()) return -1;
  const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (int index = 0; index < 1000; ++index) {
    const CarmenLine line = line_of(geometry, index);
    if (std::equal(ranges_m.begin(), ranges_m.end(), line.ranges_m.begin(), same)) return index;
  }
  return -1;
}

std::uint64_t dropped(const scanner::Counters& c) {
  return c.bad_checksum + c.wrong_length + c.cut + c.bytes_skipped + c.malformed + c.unsupported + c.stamps_back;
}

std::string carmen_text(const CarmenLine& geometry, int count) {
  std::ostringstream text;
  for (int i = 0; i < count; ++i) write_carmen(text, line_of(geometry, i));
  return text.str();
}

Bytes from_hex(const std::string& text) {
  std::istringstream words(text);
  Bytes bytes;
  for (std::string word; words >> word;) bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  return bytes;
}

}  // namespace curbline::test
