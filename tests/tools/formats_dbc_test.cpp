// DBC files: what is read from them, what is refused and where, and that written files read back unchanged.
#include "formats/dbc.hpp"

#include <bit>
#include <cmath>
#include <random>
#include <sstream>

#include "formats_support.hpp"

using namespace curbline;
using namespace curbline::tools;
using namespace curbline::tools::testing;

namespace {

/// As Vector's editor writes one: every section, comments over several lines, a signal that belongs to no message.
const std::string good = R"(VERSION "1.0 \"beta\""


NS_ :
	NS_DESC_
	CM_
	BA_DEF_
	FILTER
	SG_MUL_VAL_

BS_: 500000 : 1,2

BU_: Servo Head
VAL_TABLE_ States 1 "on; and on" 0 "off" ;


BO_ 385 Tilt: 8 Servo
 SG_ Status : 0|16@1+ (1,0) [0|65535] "" Head
 SG_ Position : 16|32@1- (5.992112452678286E-06,-0.5) [-3.2|+3.2] "rad"  Head,Servo

BO_ 2147487754 Vesc: 8 Servo
 SG_ PidPosition : 55|16@0- (0.02,0) [0|0] "deg" Vector__XXX

BO_ 512 Mixed: 8 Servo
 SG_ Selector M : 7|8@0+ (1,0) [0|0] "" Head
 SG_ Angle m3 : 15|12@0+ (0.1,-180) [0|0] "deg" Head
 SG_ Speed m4 : 15|12@0+ (1,0) [0|0] "rpm" Head

BO_ 105 Odrive: 8 Vector__XXX
 SG_ Turns : 0|32@1- (1,0) [0|0] "turns" Head
 SG_ Wide : 0|64@1- (1,0) [0|0] "turns" Head

BO_ 513 Nested: 8 Servo
 SG_ S0 M : 0|4@1+ (1,0) [0|0] "" Head
 SG_ S1 m0M : 4|4@1+ (1,0) [0|0] "" Head
 SG_ Flat m1 : 8|8@1+ (1,0) [0|0] "" Head
 SG_ Deep m2 : 8|8@1+ (1,0) [0|0] "" Head
 SG_ Ranged m3 : 8|8@1+ (1,0) [0|0] "" Head
 SG_ Vague m3 : 8|8@1+ (1,0) [0|0] "" Head
 SG_ Beyond : 56|16@1+ (1,0) [0|0] "" Head

BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX
 SG_ Orphan : 0|8@1- (1,0) [0|0] "" Vector__XXX
 SG_ Orphan : 0|8@1- (1,0) [0|0] "" Vector__XXX

CM_ SG_ 385 Position "From the axis;
SG_ is no signal here \"quoted\"";
BA_DEF_ SG_  "Start" FLOAT 0 100000;
BA_DEF_DEF_  "Start" 0;
BA_ "Start" SG_ 385 Position 1;
VAL_ 385 Status 1 "on" 0 "off" ;
SIG_VALTYPE_ 105 Turns : 1;
SIG_VALTYPE_ 105 Wide : 2;
SIG_VALTYPE_ 3221225472 Orphan : 1;
SG_MUL_VAL_ 513 S1 S0 0-0;
SG_MUL_VAL_ 513 Flat S0 1-1;
SG_MUL_VAL_ 513 Deep S1 2-2;
SG_MUL_VAL_ 513 Ranged S0 3-3, 5-7;
)";

Dbc parsed(const std::string& text) {
  const TemporaryDirectory dir;
  return read_dbc(dir.write("a.dbc", text));
}

DbcTiltSignal found(const std::string& message, const std::string& signal) {
  return find_signal(parsed(good), "a.dbc", message, signal);
}

std::string not_found(const std::string& message, const std::string& signal) {
  return error_of([&] { found(message, signal); });
}

std::string error_in(const std::string& text) {
  return error_of([&] { parsed(text); });
}

/// The good file with the first occurrence of `part` replaced.
std::string changed(const std::string& part, const std::string& by) {
  std::string text = good;
  const std::size_t at = text.find(part);
  REQUIRE(at != std::string::npos);
  return text.replace(at, part.size(), by);
}

bool same(const can::Signal& a, const can::Signal& b) {
  const bool multiplexed = a.multiplexor && b.multiplexor && a.multiplexor->start_bit == b.multiplexor->start_bit &&
                           a.multiplexor->length == b.multiplexor->length &&
                           a.multiplexor->order == b.multiplexor->order && a.multiplexor->value == b.multiplexor->value;
  return a.id == b.id && a.extended == b.extended && a.start_bit == b.start_bit && a.length == b.length &&
         a.order == b.order && (a.is_signed == b.is_signed || a.is_float) && a.is_float == b.is_float &&
         a.scale == b.scale && a.offset == b.offset && (multiplexed || (!a.multiplexor && !b.multiplexor));
}

}  // namespace

TEST_CASE("dbc: a byte order mark is passed over") {
  const TemporaryDirectory dir;
  CHECK(read_dbc(dir.write("a.dbc", "\xEF\xBB\xBF" + good)).size() == read_dbc(dir.write("b.dbc", good)).size());
}

TEST_CASE("dbc: a little-endian signal has the words of its line") {
  const DbcTiltSignal position = found("Tilt", "Position");
  CHECK(position.unit == "rad");
  CHECK(same(position.signal,
             {.id = 0x181, .start_bit = 16, .length = 32, .scale = 5.992112452678286e-06, .offset = -0.5}));
}

TEST_CASE("dbc: bit 31 of an id says that it is extended, @0 that the byte order is big") {
  CHECK(same(
      found("Vesc", "PidPosition").signal,
      {.id = 0x100A, .extended = true, .start_bit = 55, .length = 16, .order = can::ByteOrder::big, .scale = 0.02}));
}

TEST_CASE("dbc: a multiplexed signal brings its multiplexor's bits and value") {
  const can::Signal angle = found("Mixed", "Angle").signal;
  CHECK(same(angle, {.id = 512,
                     .start_bit = 15,
                     .length = 12,
                     .order = can::ByteOrder::big,
                     .is_signed = false,
                     .scale = 0.1,
                     .offset = -180,
                     .multiplexor = can::Multiplexor{7, 8, can::ByteOrder::big, 3}}));
  can::Frame frame;
  frame.id = 512;
  frame.length = 8;
  frame.data = {3, 0x70, 0x80};  // 0x708 = 1800
  CHECK(can::decode(angle, frame) == 0.0);
  frame.data[0] = 4;
  CHECK_FALSE(can::decode(angle, frame));
  CHECK(found("Mixed", "Selector").signal.multiplexor == std::nullopt);
}

TEST_CASE("dbc: SIG_VALTYPE_ makes a float of 32 bits, and one of 64 is refused") {
  CHECK(same(found("Odrive", "Turns").signal, {.id = 105, .is_float = true}));
  CHECK(not_found("Odrive", "Wide") ==
        "a.dbc:31: signal Wide is a float of 64 bits; expected a whole number or a float of 32 bits");
}

TEST_CASE("dbc: SG_MUL_VAL_ tells which multiplexor, what one number cannot say is refused") {
  const auto multiplexor = found("Nested", "Flat").signal.multiplexor;
  REQUIRE(multiplexor);
  CHECK((multiplexor->start_bit == 0 && multiplexor->length == 4 && multiplexor->value == 1));
  CHECK(not_found("Nested", "Deep").find("depends on several multiplexors; expected") != std::string::npos);
  CHECK(not_found("Nested", "Ranged").find("several values of its multiplexor; expected") != std::string::npos);
  CHECK(not_found("Nested", "Vague").find("several multiplexors; expected SG_MUL_VAL_") != std::string::npos);
}

TEST_CASE("dbc: what is not there is refused with what there is") {
  CHECK(not_found("Tlit", "Position") == "a.dbc: no message Tlit; expected Tilt, Vesc, Mixed, Odrive, Nested");
  CHECK(not_found("Tilt", "position") == "a.dbc:17: no signal position in Tilt; expected Status, Position");
  CHECK(not_found("Nested", "Beyond") ==
        "a.dbc:40: signal Beyond has the bits 56|16; expected them within the 8 bytes of its message");
}

TEST_CASE("dbc: signals that no decoder can take are refused when they are asked for") {
  const auto error = [&](const std::string& text) {
    return error_of([&] { find_signal(parsed(text), "a.dbc", "Tilt", "Position"); });
  };
  CHECK(error(changed("16|32@1-", "16|65@1-")).find("length from 1 to 64") != std::string::npos);
  CHECK(error(changed("16|32@1-", "16|0@1-")).find("length from 1 to 64") != std::string::npos);
  CHECK(error(changed("16|32@1-", "65000|32@1-")).find("within the 8 bytes") != std::string::npos);
  CHECK(error(changed("(5.992112452678286E-06", "(0")).find("factor 0") != std::string::npos);
  CHECK(error(changed("SG_ Position ", "SG_ Position m1 ")).find("no multiplexor") != std::string::npos);
  CHECK(error(changed("SIG_VALTYPE_ 105 Turns", "SIG_VALTYPE_ 385 Position : 1;\nSIG_VALTYPE_ 105 Turns")).empty());
  CHECK(error(changed("SIG_VALTYPE_ 105 Turns", "SIG_VALTYPE_ 385 Status : 1;\nSIG_VALTYPE_ 105 Turns")).empty());
}

TEST_CASE("dbc: errors name the line and what was expected") {
  CHECK(error_in("") == "a.dbc:1: the file is empty; expected DBC");
  CHECK(error_in("VERSION \"\"\nBOO_ 1 A: 8 B\n") ==
        "a.dbc:2: unknown statement BOO_; expected BO_, SG_ or another of DBC");
  CHECK(error_in(changed("BO_ 385 Tilt: 8", "BO_ 385 Tilt 8")) == "a.dbc:17: 8; expected ':'");
  CHECK(error_in(changed("16|32@1-", "16-32@1-")) == "a.dbc:19: -32@1-; expected '|'");
  CHECK(error_in(changed("16|32@1-", "16|32@2-")) ==
        "a.dbc:19: 2-; expected the byte order, a whole number from 0 to 1");
  CHECK(error_in(changed("16|32@1-", "16|32@1*")) == "a.dbc:19: *; expected '+'");
  CHECK(error_in(changed("(5.992112452678286E-06", "(five")).starts_with("a.dbc:19: five,-0.5); expected the factor"));
  CHECK(error_in(changed("(5.992112452678286E-06", "(nan")).find("expected the factor, a number") != std::string::npos);
  CHECK(error_in(changed("\"rad\"", "rad")) == "a.dbc:19: rad; expected the unit in quotation marks");
  for (const char* word : {"x3", "m", "m3x", "m18446744073709551616"}) {
    CHECK(error_in(changed("Angle m3", std::string("Angle ") + word)) ==
          "a.dbc:26: " + std::string(word) + "; expected ':', M or m and a number");
  }
  CHECK(error_in(changed("BO_ 512", "BO_ 2048")).starts_with("a.dbc:24: id 2048 is none of CAN; expected 11 bits"));
  CHECK(error_in(changed("BO_ 512", "BO_ 385")).starts_with("a.dbc:24: id 385 comes twice; expected"));
  CHECK(error_in(changed(" Mixed:", " Tilt:")).starts_with("a.dbc:24: message Tilt comes twice; expected"));
  CHECK(error_in(changed("SG_ Status", "SG_ Position")).starts_with("a.dbc:19: signal Position comes twice; expected"));
  CHECK(
      error_in(changed("BO_ 385 Tilt: 8 Servo", "")).starts_with("a.dbc:18: a signal outside a message; expected BO_"));
  CHECK(
      error_in(changed("SIG_VALTYPE_ 105 Turns", "SIG_VALTYPE_ 105 Turn")).starts_with("a.dbc:52: no signal Turn in"));
  CHECK(error_in(changed("Wide : 2;", "Wide : 3;")).find("value type 3; expected 0") != std::string::npos);
  CHECK(error_in(good + "CM_ \"no end").starts_with("a.dbc:59: a text is not closed; expected"));
  CHECK(error_in(good + "BA_DEF_ 3").starts_with("a.dbc:59: the statement has no end; expected ';'"));
  CHECK(error_in(good + "BA_ 3;").starts_with("a.dbc:59: 3;; expected an attribute's name in quotation marks"));
}

TEST_CASE("dbc: attributes say what DBC has no words for, and those of others are passed over") {
  const std::string attributes =
      "BA_ \"CurblineIdMask\" BO_ 385 2032;\nBA_ \"CurblineMinBytes\" BO_ 385 7;\n"
      "BA_ \"CurblineMaxBytes\" BO_ 385 8;\nBA_ \"CurblineSyncId\" BO_ 385 128;\n";
  const std::string others =
      "BA_ \"GenMsgCycleTime\" BO_ 385 10.5;\nBA_ \"BusType\" \"CAN\";\nBA_ \"Curb\" SG_ 385 Position 1;\n";
  const DbcTiltSignal found = find_signal(parsed(good + attributes + others), "a.dbc", "Tilt", "Position");
  CHECK(found.signal.id_mask == 0x7F0);
  CHECK(found.signal.min_bytes == 7);
  CHECK(found.signal.max_bytes == 8);
  CHECK(found.sync_id == 0x80);
  const DbcTiltSignal plain = find_signal(parsed(good + others), "a.dbc", "Tilt", "Position");
  CHECK(plain.signal.id_mask == can::highest_id(true));
  CHECK(plain.signal.min_bytes == 0);
  CHECK(plain.signal.max_bytes == 64);
  CHECK_FALSE(plain.sync_id);
}

TEST_CASE("dbc: an attribute that makes no sense is refused with its line") {
  CHECK(error_in(good + "BA_ \"CurblineMinBytes\" BO_ 385 65;") ==
        "a.dbc:59: 65;; expected CurblineMinBytes, a whole number from 0 to 64");
  CHECK(error_in(good + "BA_ \"CurblineMinBytes\" BO_ 386 6;") ==
        "a.dbc:59: no message of id 386; expected one that BO_ describes");
  CHECK(error_in(good + "BA_ \"CurblineMinBytes\" 6;") == "a.dbc:59: 6;; expected BO_, as of a message");
  const Dbc dbc = parsed(good + "BA_ \"CurblineMaxBytes\" BO_ 385 5;");
  CHECK(error_of([&] { find_signal(dbc, "a.dbc", "Tilt", "Position"); }) ==
        "a.dbc:19: signal Position has the attribute CurblineMaxBytes 5; expected 6 or more, which the signal needs");
}

TEST_CASE("dbc: what cannot be read is refused, and a file without end too") {
  const TemporaryDirectory dir;
  CHECK(error_of([&] {
          read_dbc(dir.path("none.dbc"));
        }).starts_with("none.dbc: cannot be read: No such file or directory; expected"));
  CHECK(error_of([&] { read_dbc(dir.path(".")); }).starts_with(".: cannot be read: Is a directory; expected"));
  CHECK(error_of([&] { read_dbc("/dev/zero"); }).find("longer than 16 MiB; expected") != std::string::npos);
}

TEST_CASE("dbc: line ends of any system and of none are read alike") {
  std::string dos = good;
  for (std::size_t at = dos.find('\n'); at != std::string::npos; at = dos.find('\n', at + 2)) dos.insert(at, "\r");
  CHECK(parsed(dos).size() == parsed(good).size());
  CHECK(parsed("BO_ 1 A: 8 B SG_ S : 0|8@1+ (1,0) [0|0] \"\" C").at(0).signals.size() == 1);
}

TEST_CASE("dbc: any signal that is written is read again as it was, and decodes to the same numbers") {
  std::mt19937 random(11);
  const auto below = [&](unsigned n) { return static_cast<unsigned>(random()) % n; };
  const TemporaryDirectory dir;
  for (int trial = 0; trial < 1500; ++trial) {
    can::Signal in{.extended = below(2) == 0};
    in.id = static_cast<std::uint32_t>(random()) & (in.extended ? 0x1FFFFFFFu : 0x7FFu);
    in.is_float = below(5) == 0;
    in.length = static_cast<std::uint8_t>(in.is_float ? 32 : 1 + below(64));
    in.start_bit = static_cast<std::uint16_t>(below(64));
    in.order = below(2) == 0 ? can::ByteOrder::little : can::ByteOrder::big;
    in.is_signed = in.is_float || below(2) == 0;
    in.scale = std::ldexp(static_cast<double>(random()) - 2e9, -static_cast<int>(below(60)));
    in.offset = below(2) == 0 ? 0.0 : std::ldexp(static_cast<double>(random()), -static_cast<int>(below(40)));
    if (below(3) == 0) in.multiplexor = can::Multiplexor{200, 8, can::ByteOrder::little, below(256)};
    DbcSignal signal;
    signal.name = "S";
    signal.start_bit = in.start_bit;
    signal.length = in.length;
    signal.order = in.order;
    signal.is_signed = in.is_signed;
    signal.type = in.is_float ? DbcValueType::float32 : DbcValueType::whole;
    signal.scale = in.scale;
    signal.offset = in.offset;
    signal.unit = "a \"b\" \\";
    signal.comment = "; \"";
    DbcMessage message;
    message.name = "M";
    message.id = in.id;
    message.extended = in.extended;
    message.length = 64;
    if (in.multiplexor) {
      DbcSignal selector;
      selector.name = "X";
      selector.start_bit = 200;
      selector.length = 8;
      selector.is_multiplexor = true;
      message.signals.push_back(selector);
      signal.multiplexed = in.multiplexor->value;
    }
    message.signals.push_back(signal);
    std::ostringstream text;
    write_dbc(text, {message});
    const std::string path = dir.write("a.dbc", text.str());
    const DbcTiltSignal out = find_signal(read_dbc(path), path, "M", "S");
    INFO(text.str());
    REQUIRE(same(in, out.signal));
    REQUIRE(out.unit == signal.unit);
    can::Frame frame;
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    can::encode(in, 0.37, frame);
    REQUIRE(can::decode(in, frame) == can::decode(out.signal, frame));
  }
}

TEST_CASE("dbc: damaged files are read or refused, and nothing worse") {
  const auto use = [](const std::string& path) {
    for (const DbcMessage& message : read_dbc(path)) {
      for (const DbcSignal& signal : message.signals) {
        try {
          const can::Signal found = find_signal({message}, path, message.name, signal.name).signal;
          REQUIRE(can::valid(found));
        } catch (const BadInput&) {
        }
      }
    }
  };
  survive_damage(good, "a.dbc", use, 4000);
}
