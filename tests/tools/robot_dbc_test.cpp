// Conversion of a robot's description to DBC and back, and the shipped DBC of the curb frames.
#include <cmath>
#include <numbers>
#include <sstream>

#include "curbline/can/curb_frames.hpp"
#include "formats_support.hpp"
#include "robot/signal_dbc.hpp"

using namespace curbline;
using namespace curbline::tools;
using namespace curbline::tools::testing;

namespace {

std::string text_of(const Dbc& dbc) {
  std::ostringstream text;
  write_dbc(text, dbc);
  return text.str();
}

/// Writes the robot as DBC, converts that to TOML, and reads the TOML.
Robot through_dbc(const Robot& robot) {
  const TemporaryDirectory dir;
  const std::string path = dir.write("r.dbc", text_of(dbc_of(robot)));
  const std::string toml = tilt_toml(find_signal(read_dbc(path), path, "TiltServo", "Tilt"), "TiltServo.Tilt");
  return read_robot(dir.write("r.toml", toml));
}

Robot robot_of(const std::string& toml) {
  const TemporaryDirectory dir;
  return read_robot(dir.write("r.toml", toml));
}

}  // namespace

TEST_CASE("robot dbc: the angle of every servo is the same after DBC and TOML, for every frame") {
  std::mt19937 random(2);
  for (const std::string servo : {"cia402", "odrive", "vesc", "cubemars", "robstride", "mini-cheetah"}) {
    INFO(servo);
    const Robot in = robot_of("[tilt.signal]\nservo = \"" + servo + "\"\n");
    const Robot out = through_dbc(in);
    for (int k = 0; k < 200; ++k) {
      can::Frame frame;
      for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
      can::encode(in.tilt_signal, 0.01 * k - 1.0, frame);
      frame.length = std::min<std::uint8_t>(8, in.tilt_signal.max_bytes);
      const auto angle = can::decode(in.tilt_signal, frame);
      REQUIRE(angle);
      REQUIRE(can::decode(out.tilt_signal, frame) == angle);
    }
  }
}

TEST_CASE("robot dbc: ids, lengths and SYNC of every servo are the same after DBC and TOML") {
  for (const std::string keys : {"servo = \"robstride\"\n", "servo = \"mini-cheetah\"\n", "servo = \"cubemars\"\n",
                                 "sync_id = 0x80\n", "sync_id = 0\nid_mask = 0x7F0\nmin_bytes = 7\nmax_bytes = 12\n"}) {
    INFO(keys);
    const Robot in = robot_of("[tilt.signal]\n" + keys), out = through_dbc(in);
    CHECK(out.tilt_signal.id == in.tilt_signal.id);
    CHECK(out.tilt_signal.id_mask == in.tilt_signal.id_mask);
    CHECK(out.tilt_signal.min_bytes == in.tilt_signal.min_bytes);
    CHECK(out.tilt_signal.max_bytes == in.tilt_signal.max_bytes);
    CHECK(out.tilt_sync_id == in.tilt_sync_id);
  }
}

TEST_CASE("robot dbc: a message is as long as the shortest frame that counts") {
  CHECK(text_of(dbc_of(robot_of("[tilt.signal]\nservo = \"mini-cheetah\"\n"))).find("BO_ 0 TiltServo: 6 ") !=
        std::string::npos);
}

TEST_CASE("robot dbc: a multiplexed signal keeps its multiplexor") {
  const Robot out =
      through_dbc(robot_of("[tilt.signal]\nstart_bit = 8\nlength = 16\n[tilt.signal.multiplexor]\nstart_bit = "
                           "7\nlength = 5\nbyte_order = \"big\"\nvalue = 17\n"));
  REQUIRE(out.tilt_signal.multiplexor);
  CHECK(out.tilt_signal.multiplexor->start_bit == 7);
  CHECK(out.tilt_signal.multiplexor->length == 5);
  CHECK(out.tilt_signal.multiplexor->order == can::ByteOrder::big);
  CHECK(out.tilt_signal.multiplexor->value == 17);
}

TEST_CASE("robot dbc: what DBC has no word for is said in a comment") {
  CHECK(text_of(dbc_of(robot_of("[tilt.signal]\nservo = \"robstride\"\n")))
            .find("\"Angle of the tilt servo of robot. Any id that agrees with this one in the bits 0x1f00ff00.\"") !=
        std::string::npos);
  const Dbc synced = dbc_of(robot_of("[tilt.signal]\nsync_id = 0x80\n"));
  REQUIRE(synced.size() == 2);
  CHECK(synced[1].name == "Sync");
  CHECK(synced[1].id == 0x80);
  CHECK(text_of(synced).find("BO_ 128 Sync: 0 ") != std::string::npos);
}

TEST_CASE("robot dbc: degrees and turns become radians, and a unit that is no angle is said") {
  const auto toml = [](const std::string& unit) {
    return tilt_toml({{.id = 1, .scale = 0.5, .offset = 2.0}, unit}, "A.B of a.dbc");
  };
  const auto scale = [&](const std::string& unit) { return robot_of(toml(unit)).tilt_signal.scale; };
  CHECK(scale("rad") == 0.5);
  CHECK(scale("deg") == Approx(0.5 * std::numbers::pi / 180).epsilon(1e-15));
  for (const char* degrees : {"Deg", "degree", "degrees", "\xB0", "\xC2\xB0"}) CHECK(scale(degrees) == scale("deg"));
  CHECK(scale("mrad") == Approx(0.0005).epsilon(1e-15));
  for (const char* turns : {"rev", "turn"}) CHECK(scale(turns) == scale("turns"));
  CHECK(scale("turns") == Approx(std::numbers::pi).epsilon(1e-15));
  CHECK(robot_of(toml("deg")).tilt_signal.offset == Approx(2 * std::numbers::pi / 180).epsilon(1e-15));
  CHECK(toml("rad").find("Not known") == std::string::npos);
  CHECK(toml("inc").find("# Not known as an angle: multiply") != std::string::npos);
  CHECK(scale("inc\n[laser]\nbeams = 3") == 0.5);  // a unit cannot become a key
}

TEST_CASE("robot dbc: curb_ahead.dbc, which ships, is that of the code (curbline dbc --curbs)") {
  CHECK(read_file(CURBLINE_SOURCE_DIR "/tools/robots/curb_ahead.dbc") == text_of(curb_dbc()));
}

TEST_CASE("robot dbc: a receiver that knows curb_ahead.dbc alone reads what is sent") {
  const std::string path = CURBLINE_SOURCE_DIR "/tools/robots/curb_ahead.dbc";
  const Dbc dbc = read_dbc(path);
  const can::Frame frame = can::curb_ahead_frame(CurbAhead{1.25f, -0.3f, 0.12f, 0.004f, CurbKind::step_down, 0.96f});
  const auto value = [&](const std::string& name) {
    return can::decode(find_signal(dbc, path, "CurbAhead", name).signal, frame).value();
  };
  CHECK(value("Distance") == Approx(1.25));
  CHECK(value("Lateral") == Approx(-0.3));
  CHECK(value("Height") == Approx(0.12));
  CHECK(value("HeightSd") == Approx(0.004));
  CHECK(value("Kind") == 2.0);
  CHECK(value("Probability") == Approx(0.96));
}
