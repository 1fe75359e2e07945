#include <sstream>
#include <vector>

#include "candump/candump.hpp"
#include "curbline/can/servo_presets.hpp"
#include "curbline/can/signal.hpp"
#include "formats/can_log.hpp"
#include "formats_support.hpp"

using namespace curbline;
using namespace curbline::tools;
using namespace curbline::tools::testing;

namespace {

std::string formatted(const can::Frame& frame, std::string_view interface_name) {
  std::array<char, candump::max_line> line{};
  return {line.data(), candump::format_line(frame, interface_name, line)};
}

std::string error_in(std::string_view line) {
  return std::string(candump::parse_line(line).error);
}

}  // namespace

TEST_CASE("candump: a classic frame is read with time, interface, id and data") {
  const auto line = candump::parse_line("(1290682980.025000) can0 181#3706D317FDFF");
  REQUIRE(line.ok());
  CHECK(line.frame.time_ns == 1290682980025000000);
  CHECK(line.interface_name == "can0");
  CHECK(line.frame.id == 0x181);
  CHECK_FALSE(line.frame.extended);
  CHECK(line.frame.length == 6);
  CHECK(line.frame.data[2] == 0xD3);
}

TEST_CASE("candump: eight digits are an extended id, bit 29 an error message") {
  const auto extended = candump::parse_line("(0.0) vcan0 1FFFFFFF#");
  REQUIRE(extended.ok());
  CHECK((extended.frame.extended && !extended.frame.error && extended.frame.id == 0x1FFFFFFF));
  const auto error = candump::parse_line("(0.0) vcan0 20000004#0011000000000000");
  REQUIRE(error.ok());
  CHECK((!error.frame.extended && error.frame.error && error.frame.id == 4));
}

TEST_CASE("candump: remote requests and CAN FD frames are read") {
  const auto remote = candump::parse_line("(0.0) can0 123#R5");
  CHECK((remote.ok() && remote.frame.remote && remote.frame.length == 5));
  CHECK(candump::parse_line("(0.0) can0 123#R").frame.remote);
  const auto fd = candump::parse_line("(0.0) can0 123##3" + std::string(24, 'A'));
  CHECK((fd.ok() && fd.frame.fd && fd.frame.fd_flags == 3 && fd.frame.length == 12 && fd.frame.data[11] == 0xAA));
}

TEST_CASE("candump: of a classic frame of 8 bytes a length code above 8 is passed over") {
  const auto line = candump::parse_line("(0.0) can0 123#1122334455667788_F R");
  REQUIRE(line.ok());
  CHECK(line.frame.length == 8);
  CHECK(line.frame.data[7] == 0x88);
  CHECK(candump::parse_line("(0.0) can0 123#R8_9").frame.length == 8);
  for (const char* bad : {"123#1122334455667788_8", "123#1122334455667788_G", "123#1122334455667788_",
                          "123#11223344556677_9", "123#R7_9", "123##011223344556677_9", "123#1122334455667788_9_9"})
    CHECK_FALSE(candump::parse_line("(0.0) can0 " + std::string(bad)).ok());
}

TEST_CASE("candump: the direction that newer versions append is passed over") {
  CHECK(candump::parse_line("(0.0) can0 123#11 R").ok());
  CHECK(candump::parse_line("(0.0) can0 123#R T").ok());
  CHECK_FALSE(candump::parse_line("(0.0) can0 123#11 X").ok());
}

TEST_CASE("candump: blanks at the end are passed over, however many") {
  for (const std::string frame : {"123#11", "123#11 R", "123#R", "123#", "123##3"}) {
    for (const std::size_t blanks : {1u, 2u, 7u}) {
      const std::string text = "(0.0) can0 " + frame, with_blanks = text + std::string(blanks, ' ');
      const auto line = candump::parse_line(with_blanks);
      INFO(text << " and " << blanks);
      CHECK(line.ok());
      CHECK(formatted(line.frame, line.interface_name) == formatted(candump::parse_line(text).frame, "can0"));
    }
  }
  CHECK(error_in("   ").starts_with("no time"));
  CHECK(error_in("(0.0) can0  123#11").starts_with("no frame"));
}

TEST_CASE("candump: names of a log of several interfaces are set to the right, as wide as the longest") {
  const auto line = candump::parse_line("(1290682980.025000)  can0 181#3706D317FDFF");
  REQUIRE(line.ok());
  CHECK(line.interface_name == "can0");
  CHECK(line.frame.id == 0x181);
  CHECK(candump::parse_line("(1290682980.025000)           can0 181#3706D317FDFF T").ok());
  CHECK(error_in("(1290682980.025000)   ").starts_with("bad interface name"));
}

TEST_CASE("candump: times are exact to the nanosecond") {
  CHECK(candump::parse_time("1290682980.123456789") == 1290682980123456789);
  CHECK(candump::parse_time("1290682980.1234567899") == 1290682980123456789);
  CHECK(candump::parse_time("0.1") == 100000000);
  CHECK(candump::parse_time("7") == 7000000000);
  CHECK(candump::parse_time("9223372036.854775807") == INT64_MAX);
  for (const char* bad : {"", "-1.0", "+1", "1.", ".5", "1.2.3", "1e9", "nan", "9223372036.854775808", "9223372037.0",
                          "99999999999999999999"}) {
    CHECK_FALSE(candump::parse_time(bad));
  }
}

TEST_CASE("candump: what candump does not write is refused with what was expected") {
  CHECK(error_in("").starts_with("no time"));
  CHECK(error_in("can0 123#11").starts_with("no time"));
  CHECK(error_in("(x) can0 123#11").starts_with("bad time"));
  CHECK(error_in("(1699999999) can0 123#11") == "bad time; expected (SECONDS.DECIMALS)");
  CHECK(error_in("(0.0)").starts_with("bad interface name"));
  CHECK(error_in("(0.0) name_of_16_bytes 123#").starts_with("bad interface name"));
  CHECK(error_in("(0.0) name_of_fifteen 123#").empty());
  CHECK(error_in("(0.0) can0").starts_with("no frame"));
  CHECK(error_in("(0.0) can0 123").starts_with("no frame"));
  CHECK(error_in("(0.0) can0 1234#11").starts_with("bad id"));
  CHECK(error_in("(0.0) can0 12G#11").starts_with("bad id"));
  CHECK(error_in("(0.0) can0 800#11").starts_with("id out of range"));
  CHECK(error_in("(0.0) can0 40000000#11").starts_with("id out of range"));
  CHECK(error_in("(0.0) can0 123#1").starts_with("odd number"));
  CHECK(error_in("(0.0) can0 123#1G").starts_with("bad data"));
  CHECK(error_in("(0.0) can0 123#112233445566778899").starts_with("too much data"));
  CHECK(error_in("(0.0) can0 123##0" + std::string(130, '0')).starts_with("too much data"));
  CHECK(error_in("(0.0) can0 123##0" + std::string(18, '0')).starts_with("no CAN FD length"));
  CHECK(error_in("(0.0) can0 123##").starts_with("no CAN FD flags"));
  CHECK(error_in("(0.0) can0 123#R9").starts_with("bad remote length"));
  CHECK(error_in("(0.0) can0 123#11 R R").starts_with("text behind"));
}

TEST_CASE("candump: what candump writes for the screen is told as such") {
  for (const char* text : {"  can0  181   [6]  37 06 D3 17 FD FF", "can0  181   [6]  37 06 D3 17 FD FF",
                           " (1290682980.025000)  can0  181   [6]  37 06 D3 17 FD FF",
                           "(000.025000)  can0  00001005   [8]  00 11 22 33 44 55 66 77   '..\"3DUfw'",
                           "  can0  123  [12]  00 00 00 00 00 00 00 00 00 00 00 00"}) {
    INFO(text);
    CHECK(error_in(text) == "what candump writes for the screen; expected a log of candump -L");
  }
}

TEST_CASE("candump: what is formatted is read back, and is what was read") {
  for (const char* text :
       {"(1290682980.025000) can0 181#3706D317FDFF", "(0.000001) vcan0 1FFFFFFF#", "(5.000000) can1 7FF#R8",
        "(5.000000) can1 12345678#R", "(9223372036.854775) a 20000080#0000000000000000",
        "(1.500000) can0 00000123##F0011223344556677001122334455667700112233445566770011223344556677"
        "0011223344556677001122334455667700112233445566770011223344556677"}) {
    const auto line = candump::parse_line(text);
    REQUIRE(line.ok());
    CHECK(formatted(line.frame, line.interface_name) == text);
  }
}

TEST_CASE("candump: what no bus carries is not formatted") {
  can::Frame frame;
  CHECK(formatted(frame, "can0") == "(0.000000) can0 000#");
  CHECK(formatted(frame, "").empty());
  CHECK(formatted(frame, "a name").empty());
  SECTION("an id of 12 bits") {
    frame.id = 0x800;
  }
  SECTION("nine bytes") {
    frame.length = 9;
  }
  SECTION("nine bytes of CAN FD") {
    frame.fd = true;
    frame.length = 9;
  }
  SECTION("a time before 1970") {
    frame.time_ns = -1;
  }
  CHECK(formatted(frame, "can0").empty());
}

TEST_CASE("can log: frames of every id come in order, comments are passed over") {
  const TemporaryDirectory dir;
  CanLogReader log(dir.write("c.log", "# bus\n(1.0) can0 181#00\n\n(1.0) can1 182#00\n"));
  CHECK(log.next()->id == 0x181);
  CHECK(log.next()->id == 0x182);
  CHECK(log.interface_name() == "can1");
  CHECK(log.line() == 4);
  CHECK_FALSE(log.next());
}

TEST_CASE("can log: what candump -d says of frames that it has lost is counted") {
  const TemporaryDirectory dir;
  CanLogReader log(dir.write("c.log",
                             "(1.0) can0 181#00\n"
                             "DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)\n"
                             "(2.0) can0 182#00\n"
                             "DROPCOUNT: dropped 1 CAN frame on 'can0' socket (total drops 4)\n"));
  CHECK(log.next()->id == 0x181);
  CHECK(log.frames_lost() == 0);
  CHECK(log.next()->id == 0x182);
  CHECK_FALSE(log.next());
  CHECK(log.frames_lost() == 4);
}

TEST_CASE("can log: bad lines are refused with their line") {
  const TemporaryDirectory dir;
  const auto error = [&](const std::string& text) {
    return error_of([&] {
      CanLogReader log(dir.write("c.log", text));
      while (log.next()) {
      }
    });
  };
  CHECK(error("(1.0) can0 181#00\n(1.0) can0 181#0").starts_with("c.log:2: odd number of data digits"));
  CHECK(error("(1.0) can0 181#00\n(1.0) can0 181#0").ends_with("(the file ends within this line)"));
  CHECK(error("junk\n").starts_with("c.log:1: no time"));
  CHECK(error("(4000000000.0) can0 181#00\n(4000000000.000001) can0 181#00\n") ==
        "c.log:2: the time is more than 126 years from 1970; expected seconds");
  CHECK(error("# nothing\n") == "c.log: no CAN frame; expected at least one line of candump -L");
}

TEST_CASE("can log: a time that goes back is for the reader to judge") {
  const TemporaryDirectory dir;
  CanLogReader log(dir.write("c.log", "(1.0) can0 181#00\n(0.9) can0 181#00\n"));
  CHECK(log.next());
  CHECK(log.next()->time_ns == 900'000'000);
}

TEST_CASE("can log: what is written is read back") {
  const TemporaryDirectory dir;
  std::ostringstream text;
  can::Frame frame;
  encode(can::vesc_status_4(7), 0.5, frame);
  frame.time_ns = 1290682980000001000;
  write_can_frame(text, frame, "can0");
  CanLogReader log(dir.write("c.log", text.str()));
  const auto back = log.next();
  REQUIRE(back);
  CHECK(back->time_ns == frame.time_ns);
  CHECK(back->data == frame.data);
  CHECK(*decode(can::vesc_status_4(7), *back) == Approx(0.5).margin(2e-4));
}

TEST_CASE("can log: damaged logs are read or refused, and nothing worse") {
  survive_damage(
      "(1.000000) can0 181#3706D317FDFF\n(1.5) can0 00001005##1001122334455667788990011 R\n(2.0) can0 123#R4\n",
      "c.log", [](const std::string& path) {
        CanLogReader log(path);
        while (log.next()) {
        }
      });
}
