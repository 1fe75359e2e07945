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
  const SourceWatch watch;
  const TiltLatency latency;
  const can::TiltDecoderCounters frames{~0u, ~0u, ~0u, ~0u, ~0u, ~0u};
  const ScannerState scanner;
  status.tilt = &watch, status.tilt_frames = &frames, status.tilt_latency = &latency, status.bus = BusReport{},
  status.scanner = &scanner, status.sight = &watch;
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

TEST_CASE("reports: a status has each counter under its name") {
  const LatencyHistogram none;
  Report s;
  s.scan_line_s = 0.025, s.work = &none;
  s.lines = {.pushed = 1, .covered = 2, .overdue = 3, .crowded = 4, .dropped = 5, .too_long = 6, .bad_time = 7};
  s.pipeline.lines = 11, s.pipeline.lines_dropped = 12, s.pipeline.points = 61, s.pipeline.no_returns = 62;
  s.pipeline.beams_without_tilt = 13, s.pipeline.beams_extrapolated = 14, s.pipeline.tilt_dropped = 15;
  s.curbs = 16, s.curbs_left_out = 17, s.lines_without_tilt = 18, s.lines_without_pose = 19;
  s.clients = 21, s.server.accepted = 22, s.server.too_slow = 23, s.server.refused = 24;
  s.heap_calls_before = 31, s.heap_calls_since = 32;
  const SourceWatch watch;
  const TiltLatency latency;
  const can::TiltDecoderCounters frames{
      .frames = 41, .readings = 42, .others = 43, .syncs = 44, .malformed = 45, .without_sync = 46};
  s.angles_in_doubt = true, s.angles_beyond = 47;
  s.tilt = s.nod = &watch, s.tilt_frames = &frames, s.tilt_latency = &latency, s.sight = &watch;
  ScannerState scanner;
  scanner.connections = 51, scanner.damaged = 52, scanner.other_beams = 53, scanner.device_errors = 54;
  s.scanner = &scanner;
  s.poses = {.watch = &watch, .taken = 71, .damaged = 72}, s.pipeline.poses_dropped = 73;
  s.bus = {.link = socketcan::LinkState::gone, .state = socketcan::BusState::passive};
  socketcan::Counters& can = s.bus->counters;
  can.frames = 81, can.frames_lost = 82, can.sent = 83, can.not_sent = 84, can.error_messages = 85, can.bus_errors = 86;
  can.controller_overruns = 87, can.times_passive = 88, can.times_bus_off = 89, can.restarts = 90;
  can.times_down = 91, can.times_gone = 92, can.times_back = 93;
  std::array<char, 8192> buffer{};
  const nlohmann::json status = nlohmann::json::parse(status_line(s, buffer)).at("status");
  const auto check = [&](const char* part, const nlohmann::json& wanted) {
    for (const auto& [name, value] : wanted.items()) {
      INFO(part << "." << name);
      REQUIRE(status.at(part).contains(name));
      CHECK(status.at(part).at(name) == value);
    }
  };
  check("scans", {{"lines", 1},
                  {"covered", 2},
                  {"overdue", 3},
                  {"crowded", 4},
                  {"dropped", 5},
                  {"too_long", 6},
                  {"bad_time", 7},
                  {"connected", false},
                  {"connections", 51},
                  {"damaged", 52},
                  {"other_beams", 53},
                  {"device_errors", 54}});
  check("pipeline", {{"lines", 11},
                     {"points", 61},
                     {"no_returns", 62},
                     {"lines_dropped", 12},
                     {"lines_without_tilt", 18},
                     {"lines_without_pose", 19},
                     {"beams_without_tilt", 13},
                     {"beams_extrapolated", 14},
                     {"curbs", 16},
                     {"curbs_left_out", 17}});
  check("sight", {{"state", "never"}, {"times_lost", 0}, {"longest_silence_s", 0}});
  check("clients", {{"connected", 21}, {"accepted", 22}, {"too_slow", 23}, {"refused", 24}});
  check("heap_calls", {{"before_start", 31}, {"since_start", 32}});
  check("tilt", {{"frames", 41},
                 {"readings", 42},
                 {"others", 43},
                 {"malformed", 45},
                 {"without_sync", 46},
                 {"dropped", 15},
                 {"beyond_a_turn", 47},
                 {"times_lost", 0},
                 {"times_rested", 0}});
  check("poses", {{"taken", 71}, {"damaged", 72}, {"dropped", 73}});
  check("can", {{"link", "gone"},
                {"bus", "passive"},
                {"frames", 81},
                {"frames_lost", 82},
                {"sent", 83},
                {"not_sent", 84},
                {"error_messages", 85},
                {"bus_errors", 86},
                {"controller_overruns", 87},
                {"times_passive", 88},
                {"times_bus_off", 89},
                {"restarts", 90},
                {"times_down", 91},
                {"times_gone", 92},
                {"times_back", 93}});
  CHECK(status.at("microseconds").at("scan_line") == 25'000);
}

TEST_CASE("reports: the reported state is the worst of all problems") {
  Report s;
  CHECK(state_of(s) == "ok");
  ScannerState scanner;
  s.scanner = &scanner;
  CHECK(state_of(s) == "scanner_lost");
  SourceWatch watch;
  watch.init(0.5f, false);
  s.tilt = &watch;
  CHECK(state_of(s) == "tilt_missing");
  watch.update(0, 0);
  CHECK(state_of(s) == "scanner_lost");
  watch.update(0, 1'000'000'000);
  CHECK(state_of(s) == "tilt_stale");
  watch.update(1'000'000'000, 1'000'000'000);
  scanner.connected = true;
  CHECK(state_of(s) == "ok");
  SourceWatch sight;
  sight.init(10.0f, false);
  s.sight = &sight;
  CHECK(state_of(s) == "ok");  // no line yet
  sight.update(0, 0);
  CHECK(state_of(s) == "ok");
  sight.update(0, 10'000'000'001);
  CHECK(state_of(s) == "laser_blind");
  sight.update(10'000'000'001, 10'000'000'001);
  SourceWatch nod;
  nod.init(6.0f, false);
  s.nod = &nod;
  CHECK(state_of(s) == "ok");
  nod.update(0, 6'000'000'001);
  CHECK(state_of(s) == "tilt_resting");
  s.angles_in_doubt = true;
  CHECK(state_of(s) == "tilt_not_radians");
  sight.update(10'000'000'001, 30'000'000'001);
  CHECK(state_of(s) == "tilt_not_radians");  // where a laser is taken to look if its angles are degrees
  scanner.connected = false;
  CHECK(state_of(s) == "scanner_lost");
  s.bus = BusReport{.link = socketcan::LinkState::up, .state = socketcan::BusState::off};
  CHECK(state_of(s) == "bus_off");
  s.bus->link = socketcan::LinkState::down;
  CHECK(state_of(s) == "can_down");
}

}  // namespace
}  // namespace curbline::daemon
