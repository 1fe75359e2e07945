// A scripted LMS200, for what the simulated one never does (refusals, errors, other measuring modes, power-on), and for
// the times of its lines to the nanosecond.
#include <catch2/catch.hpp>

#include "lms200/session.hpp"
#include "scanner_support.hpp"

namespace curbline::test {
namespace {

using lms200::turn_ns;

constexpr std::int64_t ms = 1'000'000, s = 1000 * ms;
constexpr std::int64_t host_ahead_ns = 1'700'000'000 * s;  // ahead of the steady clock
constexpr unsigned millimetres = 1u << 14, partial = 1u << 13, other_unit = 2u << 14;
constexpr int reflectivity = 0x3F;  // a measuring mode

scanner::Now at(std::int64_t steady_ns) {
  return {host_ahead_ns + steady_ns, steady_ns};
}

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

Bytes telegram_of(Bytes content, std::uint8_t status = 0x10) {
  content.push_back(status);
  Bytes telegram(content.size() + 6);
  lms200::frame(0x80, content, telegram);
  return telegram;
}

Bytes scan_of(std::size_t count, std::uint8_t status = 0x10, unsigned flags = millimetres, unsigned value = 1000) {
  Bytes content{0xB0, static_cast<std::uint8_t>(count), static_cast<std::uint8_t>((count | flags) >> 8)};
  for (std::size_t i = 0; i < count; ++i)
    content.insert(content.end(), {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8)});
  return telegram_of(content, status);
}

/// Every byte but the measuring mode is a mode that is refused, so that reading a wrong byte shows.
Bytes configuration_of(int measuring_mode) {
  Bytes content(36, reflectivity);
  content[0] = 0xF4;
  content[6] = static_cast<std::uint8_t>(measuring_mode);
  return content;
}

std::int64_t wire_ns(std::size_t values, int baud) {
  return 10 * s * static_cast<std::int64_t>(2 * values + 10) / baud;
}

/// Understands one speed. It obeys every command, but its reply to the command `scripted` is `reply`.
struct Sick {
  int baud = 500'000;
  Bytes scripted{}, reply{};
  std::int64_t now_ns = 60 * s;  ///< of the steady clock
  lms200::Session session;

  explicit Sick(std::size_t beams = 181) : session(beams) { session.restart(at(now_ns)); }

  Bytes answer(const Bytes& command) {
    if (command == scripted) return reply;
    if (command == Bytes{0x20, 0x40}) baud = 38'400;
    if (command[0] == 0x74) return configuration_of(0);
    if (command[0] == 0x3B) return {0xBB, 1, command[1], command[2], command[3], command[4]};
    return {0xA0, 0};
  }

  bool hear(const Bytes& bytes) {
    std::span<const std::uint8_t> left(bytes);
    return session.take(left, at(now_ns));
  }

  /// Exchanges commands and replies until the session has nothing to send. Returns the contents of the commands.
  std::vector<Bytes> talk() {
    std::vector<Bytes> said;
    while (said.size() < 40) {
      const auto command = session.to_send(at(now_ns));
      if (command.empty()) break;
      said.emplace_back(command.begin() + 4, command.end() - 2);
      const int spoken = baud;
      if (session.baud() == baud) hear(telegram_of(answer(said.back())));
      now_ns += session.baud() == spoken ? ms : 500 * ms;
    }
    return said;
  }

  /// When the line's first beam was measured, if the scan ended and its telegram was sent just now.
  std::int64_t line_time_ns() const { return session.line().host_ns - host_ahead_ns; }
};

const Bytes stop{0x20, 0x25}, start{0x20, 0x24}, configuration{0x74}, speed_up{0x20, 0x40},
    variant{0x3B, 180, 0, 100, 0};

TEST_CASE("lms200: a scanner that refuses a command is told as such, and asked again until it does not") {
  struct Case {
    Bytes command, reply;
    int baud;
    std::string words;
  };
  for (const Case& c : {Case{stop, {0xA0, 1}, 500'000, "operating mode"},
                        {start, {0xA0, 2}, 500'000, "operating mode"},
                        {speed_up, {0xA0, 1}, 9'600, "operating mode"},
                        {variant, {0xBB, 0, 100, 0, 100, 0}, 500'000, "field and step"},
                        {configuration, configuration_of(reflectivity), 500'000, "reflectivity"},
                        {configuration, configuration_of(7), 500'000, "measuring mode"}}) {
    Sick sick;
    sick.baud = c.baud;
    sick.scripted = c.command;
    sick.reply = c.reply;
    CHECK(sick.talk().back() == c.command);
    INFO(c.words);
    CHECK(has(sick.session.problem(), c.words));
    CHECK(sick.session.counters().refused == 1);
    CHECK_FALSE(sick.hear(scan_of(181)));
    sick.scripted.clear();
    sick.now_ns += 490 * ms;
    CHECK(sick.talk().empty());
    sick.now_ns += 10 * ms;
    CHECK(sick.talk().back() == start);
    CHECK(sick.session.problem().empty());
    CHECK(sick.hear(scan_of(181)));
  }
}

TEST_CASE("lms200: a reply to another command is not taken for that to the last, which is sent again") {
  const Bytes variant_reply{0xBB, 1, 180, 0, 100, 0}, mode_reply{0xA0, 0};
  for (const auto& [command, reply] : {std::pair{start, variant_reply},
                                       {start, configuration_of(0)},
                                       {variant, mode_reply},
                                       {configuration, mode_reply},
                                       {stop, variant_reply}}) {
    INFO(int{command[0]} << " answered by " << int{reply[0]});
    Sick sick;
    sick.scripted = command;
    sick.reply = reply;
    CHECK(sick.talk().back() == command);
    CHECK_FALSE(sick.hear(scan_of(181)));
    sick.scripted.clear();
    sick.now_ns += 500 * ms;
    CHECK(sick.talk().front() == command);
    CHECK(sick.hear(scan_of(181)));
  }
}

TEST_CASE("lms200: what was refused is forgotten with its connection") {
  Sick sick;
  sick.scripted = start;
  sick.reply = {0xA0, 1};
  sick.talk();
  sick.session.restart(at(sick.now_ns));
  CHECK(sick.session.problem().empty());
}

TEST_CASE("lms200: it is set to the robot's field and step, or left unchanged if it does not have them") {
  CHECK(Sick(181).talk() == std::vector<Bytes>{stop, configuration, variant, start});
  CHECK(Sick(401).talk() == std::vector<Bytes>{stop, configuration, {0x3B, 100, 0, 25, 0}, start});
  CHECK(Sick(541).talk() == std::vector<Bytes>{stop, configuration, start});
}

TEST_CASE("lms200: errors in the status byte are told and counted, information and warnings are not") {
  for (int status = 0; status < 5; ++status) {
    INFO(status);
    Sick sick;
    sick.talk();
    CHECK(sick.hear(scan_of(181, static_cast<std::uint8_t>(0x10 | status))));
    CHECK(has(sick.session.problem(), "error") == (status >= 3));
    CHECK(sick.session.counters().device_errors == (status >= 3));
  }
}

TEST_CASE("lms200: the measuring mode says which bits of a value are its range, up to all 16") {
  for (const auto& [mode, bits] : {std::pair{0, 13}, {1, 13}, {2, 13}, {3, 14}, {4, 14}, {5, 15}, {6, 15}, {15, 16}}) {
    INFO(mode);
    Sick sick;
    sick.scripted = configuration;
    sick.reply = configuration_of(mode);
    sick.talk();
    const unsigned flags = 0xFFFFu << bits, range_mm = 1u << (bits - 1);
    REQUIRE(sick.hear(scan_of(181, 0x10, millimetres, flags | range_mm)));
    CHECK(sick.session.line().ranges_m[0] == static_cast<float>(range_mm) / 1000.0f);
  }
}

TEST_CASE("lms200: scans of a kind that is not read are told as such, those of a wrong length are counted") {
  for (const unsigned flags : {millimetres | partial, other_unit}) {
    Sick sick;
    sick.talk();
    CHECK_FALSE(sick.hear(scan_of(181, 0x10, flags)));
    CHECK(sick.session.counters().unsupported == 1);
    CHECK(has(sick.session.problem(), "expected whole scans"));
  }
  Sick sick;
  sick.talk();
  CHECK_FALSE(sick.hear(scan_of(180)));
  CHECK(sick.session.counters().wrong_length == 1);
}

TEST_CASE("lms200: a line's time is its arrival less the wire, the field's part of a turn and the turns it took") {
  struct Case {
    std::size_t beams;
    int field_deg, turns;
  };
  for (const Case& c : {Case{181, 180, 1}, {361, 180, 2}, {101, 100, 1}, {201, 100, 2}, {401, 100, 4}}) {
    for (const int baud : {38'400, 500'000}) {
      INFO(c.beams << " beams at " << baud << " baud");
      Sick sick(c.beams);
      sick.baud = baud;
      sick.talk();
      const std::int64_t took_ns = wire_ns(c.beams, baud) + (c.turns - 1) * turn_ns + turn_ns * c.field_deg / 360;
      const std::int64_t start_ns = sick.now_ns;
      const std::int64_t wire_turns = (wire_ns(c.beams, baud) + turn_ns - 1) / turn_ns;
      for (int i = 0; i < 4; ++i) {
        const std::int64_t sent_ns = start_ns + i * std::max<std::int64_t>(c.turns, wire_turns) * turn_ns;
        sick.now_ns = sent_ns + (i == 3 ? 5 * ms : 0);  // the last waits in the driver
        REQUIRE(sick.hear(scan_of(c.beams)));
        CHECK(sick.line_time_ns() == sent_ns - took_ns);
      }
    }
  }
}

TEST_CASE("lms200: lines that are lost on the wire leave the times of those after them right") {
  Bytes damaged = scan_of(181);
  damaged.back() ^= 1;
  for (const Bytes& lost : {damaged, scan_of(180)}) {
    Sick sick;
    sick.talk();
    const std::int64_t start_ns = sick.now_ns;
    for (int i = 0; i < 8; ++i) {
      INFO(i);
      const std::int64_t sent_ns = start_ns + i * turn_ns;
      sick.now_ns = sent_ns + (i > 4 ? 5 * ms : 0);
      REQUIRE(sick.hear(i == 3 ? lost : scan_of(181)) == (i != 3));
      if (i != 3) CHECK(sick.line_time_ns() == sent_ns - wire_ns(181, 500'000) - turn_ns / 2);
    }
  }
}

TEST_CASE("lms200: one that is switched off and on is set up again, and its turns are counted anew") {
  Sick sick;
  sick.talk();
  REQUIRE(sick.hear(scan_of(181)));
  sick.now_ns += 100 * turn_ns + ms;
  CHECK_FALSE(sick.hear(telegram_of({0x90, 'L', 'M', 'S'})));
  CHECK_FALSE(sick.hear(scan_of(181)));
  CHECK(sick.talk() == std::vector<Bytes>{stop, configuration, variant, start});
  REQUIRE(sick.hear(scan_of(181)));
  CHECK(sick.line_time_ns() == sick.now_ns - wire_ns(181, 500'000) - turn_ns / 2);
}

}  // namespace
}  // namespace curbline::test
