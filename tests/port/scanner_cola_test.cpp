// A scripted LMS1xx, for what the simulated one never sends: faults, encoders, offsets, other channels, no
// confirmation.
#include <bit>
#include <catch2/catch.hpp>

#include "cola/session.hpp"
#include "scanner_simulator/cola_content.hpp"
#include "scanner_support.hpp"

namespace curbline::test {
namespace {

using tools::ColaContent;

constexpr std::int64_t ms = 1'000'000;

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

/// A scan telegram, with the default values of its fields.
struct Scan {
  std::uint16_t status = 0;
  std::vector<std::uint16_t> encoders{};
  std::string channel = "DIST1";
  float offset_mm = 0.0f;
  std::vector<std::uint16_t> values{1000, 1001};

  Bytes telegram() const {
    ColaContent content("sSN LMDscandata ");
    content.number(0, 8).number(status, 2).number(0, 4).number(1000, 4).number(1000, 4);
    content.number(0, 6).number(0, 8).number(encoders.size(), 2);
    for (const std::uint16_t speed : encoders) content.number(0xFFFFFFFF, 4).number(speed, 2);
    content.number(1, 2).text(channel).number(std::bit_cast<std::uint32_t>(1.0f), 4);
    content.number(std::bit_cast<std::uint32_t>(offset_mm), 4).number(900'000, 4).number(5000, 2);
    content.number(values.size(), 2);
    for (const std::uint16_t value : values) content.number(value, 2);
    return content.number(0, 8).number(0, 4).telegram();
  }
};

struct Sick {
  std::int64_t now_ns = 0;
  cola::Session session{};

  Sick() { session.restart({}); }
  bool hear(const Bytes& bytes) {
    std::span<const std::uint8_t> left(bytes);
    return session.take(left, {now_ns, now_ns});
  }
  bool asks() { return !session.to_send({now_ns, now_ns}).empty(); }
};

TEST_CASE("cola: a fault and a front screen too dirty to measure are told, dirt alone is not") {
  for (std::uint16_t status = 0; status < 8; ++status) {
    INFO(status);
    Sick sick;
    CHECK(sick.hear(Scan{.status = status}.telegram()));
    const bool fault = status != 0 && status != 2;
    CHECK(has(sick.session.problem(), "fault") == fault);
    CHECK(sick.session.counters().device_errors == fault);
  }
}

TEST_CASE("cola: the channel's offset shifts the ranges, and encoders are passed over") {
  Sick sick;
  REQUIRE(sick.hear(Scan{.encoders = {7, 8, 9}, .offset_mm = 500.0f}.telegram()));
  const auto ranges_m = sick.session.line().ranges_m;
  CHECK(std::vector<float>(ranges_m.begin(), ranges_m.end()) == std::vector<float>{1.5f, 1.501f});
}

TEST_CASE("cola: a scanner that sends no distances is told as such, and such lines are counted") {
  Sick sick;
  CHECK_FALSE(sick.hear(Scan{.channel = "RSSI1"}.telegram()));
  CHECK(has(sick.session.problem(), "DIST1"));
  CHECK(sick.session.counters().unsupported == 1);
  CHECK(sick.session.counters().malformed == 0);
}

TEST_CASE("cola: telegrams without values, or with more than a scan has, are dropped and counted") {
  Sick sick;
  CHECK_FALSE(sick.hear(Scan{.values = {}}.telegram()));
  CHECK(sick.session.counters().malformed == 1);
  CHECK_FALSE(sick.hear(Scan{.values = std::vector<std::uint16_t>(cola::most_beams + 1, 1000)}.telegram()));
  CHECK(sick.session.counters().malformed == 2);
  CHECK(sick.hear(Scan{}.telegram()));
}

TEST_CASE("cola: a scanner is asked for its scans every half second until it confirms that it sends them") {
  Sick sick;
  CHECK(sick.asks());
  for (const Bytes& answer : {Bytes{}, ColaContent("sEA LMDscandata ").number(0, 1).telegram(),
                              ColaContent("sFA ").number(1, 2).telegram()}) {
    sick.hear(answer);
    sick.now_ns += 499 * ms;
    CHECK_FALSE(sick.asks());
    sick.now_ns += ms;
    CHECK(sick.asks());
  }
  CHECK(sick.session.counters().resent == 3);
  CHECK(sick.session.counters().refused == 1);
  CHECK(has(sick.session.problem(), "refuses"));
  sick.hear(ColaContent("sEA LMDscandata ").number(1, 1).telegram());
  CHECK(sick.session.problem().empty());
  sick.now_ns += 500 * ms;
  CHECK_FALSE(sick.asks());
}

TEST_CASE("cola: what was refused is forgotten with its connection") {
  Sick sick;
  sick.hear(ColaContent("sFA ").number(1, 2).telegram());
  sick.session.restart({});
  CHECK(sick.session.problem().empty());
}

}  // namespace
}  // namespace curbline::test
