// A scripted Hokuyo, for what the simulated one never does (refusals, faults, steps that do not begin at 0), and for
// the times of its lines to the nanosecond.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "scanner_support.hpp"
#include "scip2/codec.hpp"
#include "scip2/session.hpp"

namespace curbline::test {
namespace {

constexpr std::int64_t ms = 1'000'000, s = 1000 * ms;
constexpr std::int64_t host_ahead_ns = 1'700'000'000 * s;  // ahead of the steady clock
constexpr std::int64_t least_delay_ns = 2 * ms;
constexpr std::int64_t first_step_ns = 100 * 50 * ms / 1440;
constexpr double step_rad = 2 * 3.14159265358979 / 1440;

scanner::Now at(std::int64_t steady_ns) {
  return {host_ahead_ns + steady_ns, steady_ns};
}

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

std::string summed(const std::string& line) {
  return line + scip2::sum_of(line) + "\n";
}

std::string reply(const std::string& command, const std::string& status, const std::string& body = {}) {
  return command + "\n" + summed(status) + body + "\n";
}

/// Encodes each number in `width` characters.
std::string encoded(const std::vector<std::uint32_t>& numbers, std::size_t width) {
  std::string text(width * numbers.size(), '0');
  for (std::size_t i = 0; i < numbers.size(); ++i) scip2::encode(numbers[i], std::span(text).subspan(i * width, width));
  return text;
}

/// Steps 100 to 103 of 1440, 20 turns a second. It replies with status 00 unless `status` has another one for the
/// command.
struct Hokuyo {
  std::map<std::string, std::string> status{};
  std::map<std::string, int> parameters{{"DMIN", 20},  {"DMAX", 5600}, {"ARES", 1440}, {"AMIN", 100},
                                        {"AMAX", 103}, {"AFRT", 540},  {"SCAN", 1200}};
  std::string measure = "MD0100010300000";
  std::int64_t now_ns = 60 * s, power_on_ns = 10 * s;  ///< of the steady clock
  std::vector<std::int64_t> delays_ns{9 * ms, 7 * ms, 4 * ms, least_delay_ns, 5 * ms};
  scip2::Session session{};

  Hokuyo() { session.restart(at(now_ns)); }

  std::uint32_t clock_ms() const { return static_cast<std::uint32_t>((now_ns - power_on_ns) / ms); }

  std::string answer(const std::string& command) const {
    const auto found = status.find(command.substr(0, command.starts_with("MD") ? 2 : 7));
    std::string body;
    if (command == "TM1") body = summed(encoded({clock_ms()}, 4));
    if (command == "PP") {
      for (const auto& [name, value] : parameters) body += summed(name + ":" + std::to_string(value));
    }
    return reply(command, found == status.end() ? "00" : found->second, body);
  }

  std::string scan(std::uint32_t stamp_ms,
                   const std::vector<std::uint32_t>& ranges_mm = {1000, 1001, 1002, 1003}) const {
    return reply(measure, "99", summed(encoded({stamp_ms}, 4)) + summed(encoded(ranges_mm, 3)));
  }

  bool hear(const std::string& text) {
    std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    return session.take(bytes, at(now_ns));
  }

  std::string command() {
    const auto bytes = session.to_send(at(now_ns));
    return {bytes.begin(), bytes.empty() ? bytes.end() : bytes.end() - 1};  // without the line end
  }

  /// Exchanges commands and replies until the session has nothing to send. Returns the commands.
  std::vector<std::string> talk() {
    std::vector<std::string> said;
    for (std::string text = command(); !text.empty() && said.size() < 40; text = command()) {
      const std::string reply = answer(text);
      now_ns += delays_ns[said.size() % delays_ns.size()];
      hear(reply);
      said.push_back(text);
    }
    return said;
  }
};

std::vector<std::string> whole_talk() {
  std::vector<std::string> said{"QT", "SCIP2.0", "PP", "TM0"};
  said.insert(said.end(), 8, "TM1");
  said.insert(said.end(), {"TM2", "BM", "MD0100010300000"});
  return said;
}

TEST_CASE("scip2: a scanner that refuses its laser or to measure is told as such, and asked again until it does") {
  for (const auto& [command, words] :
       {std::pair{"BM", "refuses to switch its laser on"}, {"MD", "refuses to measure"}}) {
    INFO(command);
    Hokuyo hokuyo;
    hokuyo.status[command] = "01";
    CHECK(hokuyo.talk().back().starts_with(command));
    CHECK(has(hokuyo.session.problem(), words));
    CHECK(hokuyo.session.counters().refused == 1);
    CHECK_FALSE(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms())));
    hokuyo.status.clear();
    hokuyo.now_ns += 490 * ms;
    CHECK(hokuyo.talk().empty());
    hokuyo.now_ns += 10 * ms;
    CHECK(hokuyo.talk().back() == hokuyo.measure);
    CHECK(hokuyo.session.problem().empty());
    CHECK(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms())));
  }
}

TEST_CASE("scip2: what was refused is forgotten with its connection") {
  Hokuyo hokuyo;
  hokuyo.status["BM"] = "01";
  hokuyo.talk();
  hokuyo.session.restart(at(hokuyo.now_ns));
  CHECK(hokuyo.session.problem().empty());
}

TEST_CASE("scip2: a laser that is on, and a clock that is told already, are no refusals") {
  Hokuyo hokuyo;
  hokuyo.status = {{"BM", "02"}, {"TM0", "02"}};
  CHECK(hokuyo.talk() == whole_talk());
  CHECK(hokuyo.session.counters().refused == 0);
  CHECK(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms())));
}

TEST_CASE("scip2: a fault while it measures is told, and the scanner is set up anew") {
  Hokuyo hokuyo;
  hokuyo.talk();
  CHECK_FALSE(hokuyo.hear(reply(hokuyo.measure, "50")));
  CHECK(has(hokuyo.session.problem(), "fault"));
  CHECK(hokuyo.session.counters().device_errors == 1);
  CHECK_FALSE(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms())));
  CHECK(hokuyo.talk() == whole_talk());
  CHECK(hokuyo.session.problem().empty());
  CHECK(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms())));
}

TEST_CASE("scip2: late replies to commands do not stop a scanner that measures") {
  Hokuyo hokuyo;
  hokuyo.talk();
  CHECK_FALSE(hokuyo.hear(reply("BM", "02")));
  CHECK_FALSE(hokuyo.hear(reply(hokuyo.measure, "00")));
  CHECK(hokuyo.session.counters().malformed == 1);
  CHECK(hokuyo.session.counters().device_errors == 0);
  CHECK(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms())));
}

TEST_CASE("scip2: a command is repeated after half a second, and a second reply to it does not answer the next") {
  Hokuyo hokuyo;
  CHECK(hokuyo.command() == "QT");
  hokuyo.now_ns += 499 * ms;
  CHECK(hokuyo.command().empty());
  hokuyo.now_ns += ms;
  CHECK(hokuyo.command() == "QT");
  CHECK(hokuyo.session.counters().resent == 1);
  hokuyo.hear(reply("QT", "00") + reply("QT", "00"));
  CHECK(hokuyo.command() == "SCIP2.0");
  hokuyo.hear(reply("QT", "00"));
  CHECK(hokuyo.command().empty());
}

TEST_CASE("scip2: a scanner left with its clock being told is brought out of it, and set up from the beginning") {
  Hokuyo hokuyo;
  hokuyo.status["QT"] = "0E";
  std::vector<std::string> said = whole_talk();
  said.insert(said.begin() + 1, "TM2");
  for (const int connection : {1, 2}) {
    INFO(connection);
    hokuyo.session.restart(at(hokuyo.now_ns));
    CHECK(hokuyo.talk() == said);
    CHECK(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms())));
  }
}

TEST_CASE("scip2: a line bears the time of its first step, by the scanner's own clock, however late it comes") {
  Hokuyo hokuyo;
  for (const std::int64_t power_on_ns : {10 * s, 55 * s}) {  // switched off and on
    hokuyo.power_on_ns = power_on_ns;
    hokuyo.session.restart(at(hokuyo.now_ns));
    hokuyo.talk();
    for (const std::int64_t late_ns : {90 * ms, 31 * ms, 250 * ms}) {
      const std::uint32_t stamp_ms = hokuyo.clock_ms();
      const std::int64_t step_0_ns = hokuyo.now_ns + least_delay_ns;
      hokuyo.now_ns += late_ns;
      REQUIRE(hokuyo.hear(hokuyo.scan(stamp_ms)));
      CHECK(hokuyo.session.line().host_ns == host_ahead_ns + step_0_ns + first_step_ns);
      CHECK(hokuyo.session.line().device_ns == stamp_ms * ms + first_step_ns);
    }
  }
  CHECK(hokuyo.session.line().first_bearing_rad == Approx(-440 * step_rad));
  CHECK(hokuyo.session.line().bearing_step_rad == Approx(step_rad));
}

TEST_CASE("scip2: without its clock a scanner still measures, its lines are dated 25 ms before arrival") {
  for (const auto& [command, questions] : {std::pair{"TM0", 0}, {"TM1", 8}}) {
    INFO(command);
    Hokuyo hokuyo;
    hokuyo.status[command] = "04";
    const auto said = hokuyo.talk();
    CHECK(std::count(said.begin(), said.end(), "TM1") == questions);
    REQUIRE(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms() - 40)));
    CHECK(hokuyo.session.line().host_ns == host_ahead_ns + hokuyo.now_ns - 25 * ms + first_step_ns);
  }
}

TEST_CASE("scip2: a reply to TM1 that is no stamp is passed over") {
  Hokuyo hokuyo;
  for (int i = 0; i < 4; ++i) {
    const std::string text = hokuyo.command();
    hokuyo.hear(hokuyo.answer(text));
  }
  CHECK(hokuyo.command() == "TM1");
  hokuyo.hear(reply("TM1", "00", summed("P0000")));
  hokuyo.talk();
  REQUIRE(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms())));
  CHECK(hokuyo.session.line().host_ns == host_ahead_ns + hokuyo.now_ns + least_delay_ns + first_step_ns);
}

TEST_CASE("scip2: a scanner's clock that is 100 ppm fast is followed") {
  Hokuyo hokuyo;
  hokuyo.talk();
  const std::int64_t start_ns = hokuyo.now_ns;
  for (int i = 0; i < 40 * 60; ++i) {
    const std::int64_t step_0_ns = start_ns + i * 25 * ms;
    const auto fast_ns = static_cast<std::int64_t>(1e-4 * static_cast<double>(i * 25 * ms));
    hokuyo.now_ns = step_0_ns + 30 * ms;
    REQUIRE(hokuyo.hear(hokuyo.scan(static_cast<std::uint32_t>((step_0_ns - hokuyo.power_on_ns + fast_ns) / ms))));
    const std::int64_t error_ns = hokuyo.session.line().host_ns - host_ahead_ns - step_0_ns - first_step_ns;
    REQUIRE(std::abs(error_ns - least_delay_ns) <= ms + 1000);  // 6 ms if it were not followed
  }
}

TEST_CASE("scip2: parameters that make no scan are told, and not measured by") {
  using Changes = std::map<std::string, int>;
  for (const Changes& changes : {Changes{{"DMIN", -1}},
                                 {{"DMAX", 20}},
                                 {{"ARES", 0}},
                                 {{"AMIN", -1}},
                                 {{"AMAX", 99}},
                                 {{"AFRT", -1}},
                                 {{"SCAN", 0}},
                                 {{"AMAX", 1541}},
                                 {{"AMIN", 9000}, {"AMAX", 10'000}}}) {
    INFO(changes.begin()->first << ":" << changes.begin()->second);
    Hokuyo hokuyo;
    for (const auto& [name, value] : changes) hokuyo.parameters[name] = value;
    CHECK(hokuyo.talk().back() == "PP");
    CHECK(has(hokuyo.session.problem(), "parameters"));
    CHECK(hokuyo.session.counters().malformed == 1);
  }
  Hokuyo hokuyo;
  hokuyo.status["PP"] = "01";
  CHECK(hokuyo.talk().back() == "PP");
  hokuyo.status.clear();
  hokuyo.parameters["AMAX"] = 1540;
  hokuyo.now_ns += 500 * ms;
  CHECK(hokuyo.talk().back() == "MD0100154000000");
  CHECK(hokuyo.session.problem().empty());
}

TEST_CASE("scip2: ranges of DMIN to DMAX are returns, others none") {
  Hokuyo hokuyo;
  hokuyo.talk();
  REQUIRE(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms(), {20, 5600, 19, 5601})));
  const auto ranges_m = hokuyo.session.line().ranges_m;
  CHECK(ranges_m[0] == 0.02f);
  CHECK(ranges_m[1] == 5.6f);
  CHECK(std::isnan(ranges_m[2]));
  CHECK(std::isnan(ranges_m[3]));
}

TEST_CASE("scip2: a scan of other steps than were asked for is dropped and counted") {
  for (const std::string command : {"MD0101010400000", "MD0099010300000", "MD0100010400000"}) {
    INFO(command);
    Hokuyo hokuyo;
    hokuyo.talk();
    hokuyo.measure = command;
    const std::size_t steps =
        static_cast<std::size_t>(std::stoi(command.substr(6, 4)) - std::stoi(command.substr(2, 4)) + 1);
    CHECK_FALSE(hokuyo.hear(hokuyo.scan(hokuyo.clock_ms(), std::vector<std::uint32_t>(steps, 1000))));
    CHECK(hokuyo.session.counters().malformed == 1);
  }
}

}  // namespace
}  // namespace curbline::test
