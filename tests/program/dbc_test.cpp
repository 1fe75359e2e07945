// dbc: converts a signal of a DBC file to TOML, and a robot's signal to DBC.
#include "program.hpp"

namespace curbline::tools::testing {
namespace {

TEST_CASE("program: dbc gives a robot's DBC, and of that the tilt signal to paste into a description") {
  const TemporaryDirectory dir;
  const Outcome dbc = curbline({"dbc", "--robot", shipped_robot("lms200")});
  CHECK(dbc.status == 0);
  CHECK(dbc.err.empty());
  const std::string file = dir.write("servo.dbc", dbc.out);
  const Outcome toml = curbline({"dbc", file, "TiltServo", "Tilt"});
  CHECK(toml.status == 0);
  CHECK(toml.err.empty());
  CHECK(toml.out.find("[tilt.signal]\nid = 0x100a\nextended = true\n") != std::string::npos);
  const std::string robot = dir.write("r.toml", "name = \"lms200\"\n" + toml.out);
  CHECK(curbline({"dbc", "--robot", robot}).out == dbc.out);
}

TEST_CASE("program: dbc refuses a damaged file with its line, and a signal that it has not") {
  const TemporaryDirectory dir;
  const std::string bad = dir.write("bad.dbc", "VERSION \"\"\nBO_ 1 A: 8 B\n SG_ S : 0:8@1+ (1,0) [0|0] \"\" C\n");
  check_refused(curbline({"dbc", bad, "A", "S"}), bad + ":3: ", "expected '|'");
  const std::string good = dir.write("good.dbc", curbline({"dbc", "--curbs"}).out);
  check_refused(curbline({"dbc", good, "CurbAhead", "Distnace"}), good + ":", "expected Distance, Lateral");
  check_refused(curbline({"dbc", dir.path("none"), "A", "S"}), dir.path("none") + ": ", "expected a DBC file");
  check_refused(curbline({"dbc", "--robot", dir.path("none")}), dir.path("none") + ": ", "expected a robot file");
}

TEST_CASE("program: dbc requires exactly one complete request") {
  check_wrong_usage(curbline({"dbc"}), "FILE MESSAGE SIGNAL");
  check_wrong_usage(curbline({"dbc", "a.dbc"}), "FILE MESSAGE SIGNAL");
  check_wrong_usage(curbline({"dbc", "a.dbc", "M"}), "FILE MESSAGE SIGNAL");
  check_wrong_usage(curbline({"dbc", "a.dbc", "M", "S", "--robot", "r.toml"}), "excludes");
  check_wrong_usage(curbline({"dbc", "--robot", "r.toml", "--curbs"}), "excludes");
}

}  // namespace
}  // namespace curbline::tools::testing
