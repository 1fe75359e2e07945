// Lines of JSON in memory of fixed size.
#include "reports.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "json_line.hpp"

namespace curbline::daemon {
namespace {

Curb curb(float x_m) {
  Curb c{};
  c.x0_m = x_m, c.y0_m = -1.5f, c.x1_m = x_m, c.y1_m = 1.5f;
  c.height_m = 0.1234564f, c.height_sd_m = 0.01f, c.probability = 1.0f, c.kind = CurbKind::step_up;
  c.position_sd_m = 0.02f, c.face_width_m = 0.05f, c.id = 7;
  return c;
}

TEST_CASE("reports: curbs are JSON with the names and the rounding of replay's") {
  std::array<char, 4096> buffer{};
  std::uint32_t left_out = 0;
  const std::array curbs{curb(1.0f), curb(-2.25f)};
  const auto line = nlohmann::json::parse(curbs_line(1'700'000'000'025'000'999, curbs, buffer, left_out));
  CHECK(line.at("time_s") == 1'700'000'000.025);
  REQUIRE(line.at("curbs").size() == 2);
  const nlohmann::json wanted{{"x0_m", 1.0},
                              {"y0_m", -1.5},
                              {"x1_m", 1.0},
                              {"y1_m", 1.5},
                              {"position_sd_m", 0.02},
                              {"height_m", 0.123456},
                              {"height_sd_m", 0.01},
                              {"probability", 1.0},
                              {"kind", "step_up"},
                              {"face_width_m", 0.05},
                              {"id", 7}};
  CHECK(line.at("curbs").at(0) == wanted);
  CHECK(line.at("curbs").at(1).at("x0_m") == -2.25);
  CHECK(left_out == 0);
}

TEST_CASE("reports: curbs that do not fit are left out and counted, and the line is whole JSON at any size") {
  const std::vector<Curb> curbs(20, curb(1.0f));
  for (std::size_t size = 100; size < 4096; size += 7) {
    std::vector<char> buffer(size + 8, '#');
    std::uint32_t left_out = 0;
    const auto text = curbs_line(0, curbs, std::span(buffer).first(size), left_out);
    REQUIRE(nlohmann::json::parse(text).at("curbs").size() + left_out == curbs.size());
    REQUIRE(text.back() == '\n');
    for (std::size_t i = size; i < buffer.size(); ++i) REQUIRE(buffer[i] == '#');
  }
}

TEST_CASE("reports: numbers that JSON does not have are null") {
  std::array<char, 256> buffer{};
  JsonLine json(buffer);
  json.open('[').real(std::numeric_limits<double>::quiet_NaN()).real(std::numeric_limits<double>::infinity());
  const auto line = nlohmann::json::parse(json.real(1e300).real(-0.0000004).close(']').end());
  CHECK(line.at(0).is_null());
  CHECK(line.at(1).is_null());
  CHECK(line.at(2).is_null());
  CHECK(line.at(3) == 0.0);
}

TEST_CASE("reports: the fullest status fits") {
  LatencyHistogram full;
  for (std::size_t i = 0; i < LatencyHistogram::buckets; ++i) {
    for (int k = 0; k < 100; ++k) full.add(static_cast<std::int64_t>(LatencyHistogram::end_us(i) - 1) * 1000);
  }
  Report status;
  const TiltWatch watch;
  const TiltLatency latency;
  const can::TiltDecoderCounters frames{~0u, ~0u, ~0u, ~0u, ~0u, ~0u};
  const auto bus = std::make_unique<socketcan::SocketCan>();
  const ScannerState scanner;
  status.tilt = &watch, status.tilt_frames = &frames, status.tilt_latency = &latency, status.bus = bus.get(),
  status.scanner = &scanner;
  status.latency = status.work = &full;
  std::array<char, 32 << 10> buffer{};
  const auto line = status_line(status, buffer);
  CHECK(line.size() < buffer.size() / 2);
  const nlohmann::json read = nlohmann::json::parse(line);
  CHECK(read.at("status").at("tilt").at("frames") == ~0u);
  CHECK(read.at("status").at("tilt").at("latency_steps") == 0);
  CHECK(read.at("status").at("microseconds").at("pipeline").at("below").size() == LatencyHistogram::buckets);
  CHECK(read.at("status").at("state") == "can_down");
}

}  // namespace
}  // namespace curbline::daemon
