// Telegrams and numbers as printed in the manufacturers' manuals.
#include <catch2/catch.hpp>
#include <cmath>

#include "cola/scan_data.hpp"
#include "cola/session.hpp"
#include "cola/telegram.hpp"
#include "lms200/scan_data.hpp"
#include "lms200/session.hpp"
#include "lms200/telegram.hpp"
#include "scanner_support.hpp"
#include "scip2/codec.hpp"
#include "scip2/decoder.hpp"

namespace curbline::test {
namespace {

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// Hokuyo C-42-03320B, chapter 6, with its example of a checksum.
TEST_CASE("scip2: numbers of 2, 3 and 4 characters and the sum are those of the manual") {
  CHECK(scip2::decode("CB") == 1234);
  CHECK(scip2::decode("1Dh") == 5432);
  CHECK(scip2::decode("m2@0") == 16'000'000);
  std::string text(3, ' ');
  scip2::encode(5432, text);
  CHECK(text == "1Dh");
  CHECK(scip2::sum_of("Hokuyo") == 'o');
  CHECK(scip2::sum_is_right("00P"));
  CHECK(scip2::sum_is_right("99b"));
  CHECK(scip2::sum_is_right("0Ee"));
  CHECK_FALSE(scip2::sum_is_right("00Q"));
}

// As a UTM-30LX-EW sends them.
TEST_CASE("scip2: the parameters of a UTM-30LX are read, sums behind semicolons") {
  scanner::Counters counters;
  scip2::Decoder decoder(counters);
  auto bytes = bytes_of(
      "PP\n00P\nMODL:UTM-30LX-EW;I\nDMIN:23;7\nDMAX:60000;J\nARES:1440;^\nAMIN:0;?\nAMAX:1080;Z\nAFRT:540;0\nSCAN:2400;"
      "U\n\n");
  REQUIRE(decoder.take(bytes) == scip2::Decoder::Event::reply);
  CHECK(decoder.reply().echo == "PP");
  CHECK(decoder.reply().status == "00");
  CHECK(decoder.reply().body.find("AMAX:1080;\n") != std::string_view::npos);
  CHECK(dropped(counters) == 0);
}

TEST_CASE("scip2: ranges of two characters (MS) are read as those of three (MD)") {
  scanner::Counters counters;
  scip2::Decoder decoder(counters);
  for (const std::string_view text :
       {"MS0000000200000\n99b\nm2@0?\nCBCB00Z\n\n", "MD0000000200000\n99b\nm2@0?\n0CB0CB000j\n\n"}) {
    INFO(text);
    auto bytes = bytes_of(text);
    REQUIRE(decoder.take(bytes) == scip2::Decoder::Event::scan);
    CHECK(decoder.scan().stamp_ms == 16'000'000);
    CHECK(std::vector<std::uint32_t>(decoder.scan().ranges_mm.begin(), decoder.scan().ranges_mm.end()) ==
          std::vector<std::uint32_t>{1234, 1234, 0});
  }
}

TEST_CASE("scip2: clustered steps are not taken for single ones") {
  scanner::Counters counters;
  scip2::Decoder decoder(counters);
  auto bytes = bytes_of("MD0000000202000\n99b\nm2@0?\n0CB0CB000j\n\n");
  CHECK(decoder.take(bytes) == scip2::Decoder::Event::none);
  CHECK(counters.unsupported == 1);
}

// From SICK 8014631 and 8023198.
TEST_CASE("cola: telegrams are framed and summed as in the manual") {
  const auto framed = [](std::string_view content, const Bytes& data = {}) {
    Bytes telegram(cola::Format::header + content.size() + data.size() + 1);
    std::copy(content.begin(), content.end(), telegram.begin() + 8);
    std::copy(data.begin(), data.end(), telegram.begin() + 8 + static_cast<std::ptrdiff_t>(content.size()));
    cola::frame(telegram, content.size() + data.size());
    return telegram;
  };
  CHECK(framed("sRN LMDscandata") ==
        from_hex("02 02 02 02 00 00 00 0F 73 52 4E 20 4C 4D 44 73 63 61 6E 64 61 74 61 05"));
  CHECK(framed("sMN Run") == from_hex("02 02 02 02 00 00 00 07 73 4D 4E 20 52 75 6E 19"));
  CHECK(framed("sMN SetAccessMode ", {0x03, 0xF4, 0x72, 0x47, 0x44}) ==
        from_hex("02 02 02 02 00 00 00 17 73 4D 4E 20 53 65 74 41 63 63 65 73 73 4D 6F 64 65 20 03 F4 72 47 44 B3"));
  cola::Session session;
  session.restart({});
  const auto start_stream = session.to_send({});
  CHECK(Bytes(start_stream.begin(), start_stream.end()) ==
        from_hex("02 02 02 02 00 00 00 11 73 45 4E 20 4C 4D 44 73 63 61 6E 64 61 74 61 20 01 33"));
}

TEST_CASE("cola: the scan of 21 values that the manual prints is read, the scanner's 10 to 20 degrees") {
  Bytes telegram = from_hex(
      "02 02 02 02 00 00 00 83 73 52 41 20 4C 4D 44 73 63 61 6E 64 61 74 61 20 00 01 00 01 00 89 A2 7F 00 00 03 43 03 "
      "47 27 47 "
      "7B A9 27 47 81 3B 00 00 07 00 00 00 00 00 13 88 00 00 01 68 00 00 00 01 44 49 53 54 31 3F 80 00 00 00 00 00 00 "
      "00 01 86 "
      "A0 13 88 00 15 08 93 08 95 08 AF 08 B3 08 B0 08 A4 08 B0 08 BF 08 B9 08 BA 08 D0 08 D3 08 CF 08 DE 08 EB 08 E3 "
      "08 FE 08 "
      "EC 09 03 08 FD 08 FD 00 00 00 00 00 00 00 00 00 00 00 00 2B");
  cola::Session session;
  session.restart({});
  std::span<const std::uint8_t> bytes(telegram);
  CHECK_FALSE(
      session.take(bytes, {1'000'000'000'000, 0}));  // the printed checksum, 2B, is not that of the printed bytes
  CHECK(session.counters().bad_checksum == 1);
  telegram.back() = 0xCB;
  bytes = telegram;
  REQUIRE(session.take(bytes, {1'000'000'000'000, 0}));
  const scanner::Line& line = session.line();
  CHECK(line.device_ns == 0x27477BA9LL * 1000);
  CHECK(line.host_ns == 1'000'000'000'000 - (0x2747813B - 0x27477BA9) * 1000);  // it arrived when it was sent
  REQUIRE(line.ranges_m.size() == 21);
  CHECK(line.ranges_m[0] == 2.195f);
  CHECK(line.ranges_m[20] == 2.301f);
  CHECK(line.first_bearing_rad == Approx(-80.0 * 3.14159265 / 180.0));
  CHECK(line.bearing_step_rad == Approx(0.5 * 3.14159265 / 180.0));
}

TEST_CASE("cola: values below 16 are no returns, the scale multiplies, other channels are passed over") {
  Bytes content(38, 0);  // header without encoders
  const auto put = [&content](std::initializer_list<int> bytes) {
    for (const int byte : bytes) content.push_back(static_cast<std::uint8_t>(byte));
  };
  put({0, 2});  // channels
  put({'R', 'S', 'S', 'I', '1', 0x3F, 0x80, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x13, 0x88, 0, 1, 0xFF, 0xFF});
  put({'D',  'I',  'S',  'T',  '1',  0x40, 0x00, 0, 0,  0, 0,  0,    0,   0xFF,
       0xF9, 0x22, 0x30, 0x13, 0x88, 0,    3,    0, 15, 0, 16, 0x03, 0xE8});
  cola::ScanData data;
  std::array<float, 8> ranges_m{};
  REQUIRE(cola::parse_scan_data(content, data, ranges_m) == cola::ScanResult::ok);
  CHECK(data.count == 3);
  CHECK(data.start_angle_deg == Approx(-45.0));
  CHECK(std::isnan(ranges_m[0]));
  CHECK(ranges_m[1] == 0.032f);
  CHECK(ranges_m[2] == 2.0f);
  CHECK(cola::parse_scan_data(content, data, std::span(ranges_m).first(2)) == cola::ScanResult::too_many);
  for (std::size_t size = 0; size < content.size(); ++size) {
    CHECK(cola::parse_scan_data(std::span(content).first(size), data, ranges_m) == cola::ScanResult::malformed);
  }
}

TEST_CASE("cola: a scale that is no number above 0 is malformed, a range below 0 no return") {
  const auto read = [](std::uint32_t scale, std::uint32_t offset, float& range_m) {
    Bytes content(38, 0);
    for (const int byte : std::initializer_list<int>{0, 1, 'D', 'I', 'S', 'T', '1'})
      content.push_back(static_cast<std::uint8_t>(byte));
    for (const std::uint32_t number : {scale, offset, 0u}) {
      for (const int shift : {24, 16, 8, 0}) content.push_back(static_cast<std::uint8_t>(number >> shift));
    }
    for (const int byte : {0x13, 0x88, 0, 1, 0x03, 0xE8}) content.push_back(static_cast<std::uint8_t>(byte));
    cola::ScanData data;
    return cola::parse_scan_data(content, data, std::span(&range_m, 1));
  };
  constexpr std::uint32_t one = 0x3F800000, minus_one = 0xBF800000, infinite = 0x7F800000, no_number = 0x7FC00000;
  float range_m = 0.0f;
  REQUIRE(read(one, 0, range_m) == cola::ScanResult::ok);
  CHECK(range_m == 1.0f);
  for (const std::uint32_t scale : {0u, minus_one, infinite, no_number})
    CHECK(read(scale, 0, range_m) == cola::ScanResult::malformed);
  for (const std::uint32_t offset : {infinite, no_number})
    CHECK(read(one, offset, range_m) == cola::ScanResult::malformed);
  REQUIRE(read(one, 0xC5000000, range_m) == cola::ScanResult::ok);  // 2048 mm nearer than 1 m
  CHECK(std::isnan(range_m));
}

TEST_CASE("cola: a scanner that answers in CoLa A, or refuses, is a problem that says so") {
  cola::Session session;
  session.restart({});
  auto text = bytes_of("\x02sEA LMDscandata 1\x03");
  CHECK_FALSE(session.take(text, {}));
  CHECK(session.problem().find("CoLa A") != std::string_view::npos);
  session.restart({});
  Bytes refusal(8 + 6 + 1);
  const auto error = from_hex("73 46 41 20 00 01");  // sFA 1
  std::copy(error.begin(), error.end(), refusal.begin() + 8);
  cola::frame(refusal, 6);
  std::span<const std::uint8_t> bytes(refusal);
  CHECK_FALSE(session.take(bytes, {}));
  CHECK(session.counters().refused == 1);
  CHECK(session.problem().find("refuses") != std::string_view::npos);
}

// From SICK 8007954 and the LMS200 quick manual.
TEST_CASE("lms200: telegrams and sums are those of the manual") {
  const auto framed = [](const std::string& content, std::uint8_t address = 0) {
    const Bytes bytes = from_hex(content);
    Bytes telegram(bytes.size() + 6);
    lms200::frame(address, bytes, telegram);
    return telegram;
  };
  CHECK(framed("31") == from_hex("02 00 01 00 31 15 12"));
  CHECK(framed("20 24") == from_hex("02 00 02 00 20 24 34 08"));
  CHECK(framed("20 25") == from_hex("02 00 02 00 20 25 35 08"));
  CHECK(framed("20 40") == from_hex("02 00 02 00 20 40 50 08"));
  CHECK(framed("30 01") == from_hex("02 00 02 00 30 01 31 18"));
  CHECK(framed("74") == from_hex("02 00 01 00 74 50 12"));
  CHECK(framed("3B B4 00 32 00") == from_hex("02 00 05 00 3B B4 00 32 00 3B 1F"));
  CHECK(framed("20 00 53 49 43 4B 5F 4C 4D 53") == from_hex("02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5"));
  CHECK(framed("A0 00 10", 0x80) == from_hex("02 80 03 00 A0 00 10 16 0A"));
  CHECK(framed("A0 00 10", 0x81) == from_hex("02 81 03 00 A0 00 10 36 1A"));
}

/// A telegram B0h of `count` values, all equal to `value`.
Bytes scan_content(std::uint16_t count, std::uint16_t flags, std::uint16_t value) {
  Bytes content{0xB0, static_cast<std::uint8_t>(count), static_cast<std::uint8_t>((count | flags) >> 8)};
  for (int i = 0; i < count; ++i) {
    content.push_back(static_cast<std::uint8_t>(value));
    content.push_back(static_cast<std::uint8_t>(value >> 8));
  }
  content.push_back(0x10);
  return content;
}

TEST_CASE("lms200: the manual's scan of 361 values has 732 bytes") {
  const Bytes content = scan_content(361, 1 << 14, 1000);
  Bytes telegram(content.size() + 6);
  CHECK(lms200::frame(0x80, content, telegram) == 732);
  CHECK(telegram[2] == 0xD6);
  CHECK(telegram[3] == 0x02);
  CHECK(telegram[5] == 0x69);  // a recorded one begins 02 80 d6 02 b0 69 41
  CHECK(telegram[6] == 0x41);
}

TEST_CASE("lms200: millimetres, centimetres, flags of fields and error numbers") {
  std::array<float, lms200::most_beams> ranges_m{};
  std::size_t count = 0;
  const auto range_of = [&](std::uint16_t flags, std::uint16_t value, int bits) {
    REQUIRE(lms200::parse_scan_data(scan_content(181, flags, value), bits, ranges_m, count) == lms200::ScanResult::ok);
    CHECK(count == 181);
    return ranges_m[180];
  };
  CHECK(range_of(1 << 14, 2500, 13) == 2.5f);
  CHECK(range_of(0, 123, 13) == 1.23f);
  CHECK(range_of(1 << 14, 2500 | 1 << 13, 13) == 2.5f);
  CHECK(range_of(1 << 14, 8182, 13) == 8.182f);
  for (const int error : {8183, 8187, 8190, 8191})
    CHECK(std::isnan(range_of(1 << 14, static_cast<std::uint16_t>(error), 13)));
  for (const int bits : {14, 15, 16}) {
    const int first_error = (1 << bits) - 9;
    CHECK(range_of(1 << 14, static_cast<std::uint16_t>(first_error - 1), bits) ==
          static_cast<float>(first_error - 1) / 1000.0f);
    CHECK(std::isnan(range_of(1 << 14, static_cast<std::uint16_t>(first_error), bits)));
  }
}

TEST_CASE("lms200: interlaced partial scans, other units and other counts are refused by name") {
  std::array<float, lms200::most_beams> ranges_m{};
  std::size_t count = 0;
  CHECK(lms200::parse_scan_data(scan_content(101, 1 << 14 | 1 << 13, 1000), 13, ranges_m, count) ==
        lms200::ScanResult::partial);
  CHECK(lms200::parse_scan_data(scan_content(101, 2 << 14, 1000), 13, ranges_m, count) ==
        lms200::ScanResult::other_unit);
  CHECK(lms200::parse_scan_data(scan_content(100, 1 << 14, 1000), 13, ranges_m, count) ==
        lms200::ScanResult::wrong_length);
  Bytes cut = scan_content(181, 1 << 14, 1000);
  while (!cut.empty()) {
    cut = Bytes(cut.begin(), cut.end() - 1);  // no byte after the end: a sanitizer would see reads beyond it
    CHECK(lms200::parse_scan_data(cut, 13, ranges_m, count) == lms200::ScanResult::wrong_length);
  }
}

}  // namespace
}  // namespace curbline::test
