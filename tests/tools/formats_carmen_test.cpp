#include "formats/carmen.hpp"

#include <cmath>
#include <limits>
#include <sstream>

#include "formats_support.hpp"

using namespace curbline;
using namespace curbline::tools;
using namespace curbline::tools::testing;

namespace {

const std::string scan = "RAWLASER1 0 -1.0 2.0 1.0 60.00 0.03 0 3 1.5 60.0 0.0 0 12.025 robot 12.030\n";

std::string error_in(const TemporaryDirectory& dir, const std::string& text) {
  return error_of([&] {
    CarmenReader reader(dir.write("s.carmen", text));
    while (reader.next()) {
    }
  });
}

}  // namespace

TEST_CASE("carmen: a scan line is read with its header, its returns and its sensor's time") {
  const TemporaryDirectory dir;
  CarmenReader reader(dir.write("s.carmen", "# CARMEN\nPARAM robot_width 0.5\n" + scan));
  const auto line = reader.next();
  REQUIRE(line);
  CHECK(line->time_ns == 12025000000);
  CHECK(line->start_angle_rad == -1.0);
  CHECK(line->field_of_view_rad == 2.0);
  CHECK(line->angular_resolution_rad == 1.0);
  CHECK(line->maximum_range_m == 60.0);
  REQUIRE(line->ranges_m.size() == 3);
  CHECK(line->ranges_m[0] == 1.5f);
  CHECK(std::isnan(line->ranges_m[1]));
  CHECK(std::isnan(line->ranges_m[2]));
  CHECK(reader.line() == 3);
  CHECK_FALSE(reader.next());
}

TEST_CASE("carmen: remissions are passed over") {
  const TemporaryDirectory dir;
  CarmenReader reader(dir.write("s.carmen", "RAWLASER1 0 0 1 1 9 0.03 1 2 1 2 2 0.5 0.7 3.0 robot 3.0\n"));
  CHECK(reader.next()->time_ns == 3000000000);
}

TEST_CASE("carmen: a cut line is refused with its line number") {
  const TemporaryDirectory dir;
  for (std::size_t length = 10; length < scan.find(" robot"); length += 3) {
    CHECK(error_in(dir, scan + scan.substr(0, length)).starts_with("s.carmen:2: "));
  }
  CHECK(error_in(dir, scan + scan.substr(0, scan.find(" 60.0 0.0"))) ==
        "s.carmen:2: the line ends before a range; expected one field more (the file ends within this line)");
}

TEST_CASE("carmen: a count that is not that of the ranges is refused") {
  const TemporaryDirectory dir;
  const auto with_count = [](const std::string& count) {
    return std::string(scan).replace(scan.find(" 3 "), 3, " " + count + " ");
  };
  CHECK(error_in(dir, with_count("2")).starts_with("s.carmen:1: "));
  CHECK(error_in(dir, with_count("4")).starts_with("s.carmen:1: "));
  CHECK(error_in(dir, with_count("0")) ==
        "s.carmen:1: the number of ranges is \"0\"; expected a whole number from 1 to 100000");
  CHECK(error_in(dir, with_count("1e3")).starts_with("s.carmen:1: the number of ranges is \"1e3\""));
}

TEST_CASE("carmen: a range that is not a number, or infinite, is no return, as in lines of ROS") {
  const TemporaryDirectory dir;
  for (const std::string none : {"nan", "inf", "-inf"}) {
    CarmenReader reader(dir.write("s.carmen", std::string(scan).replace(scan.find("60.0 0.0"), 4, none)));
    const auto line = reader.next();
    REQUIRE(line);
    CHECK(line->ranges_m[0] == 1.5f);
    CHECK(std::isnan(line->ranges_m[1]));
  }
}

TEST_CASE("carmen: fields that are no finite numbers are refused by name") {
  const TemporaryDirectory dir;
  const auto with = [](const std::string& from, const std::string& to) {
    return std::string(scan).replace(scan.find(from), from.size(), to);
  };
  CHECK(error_in(dir, with("-1.0", "nan")) == "s.carmen:1: start_angle is \"nan\"; expected a finite number");
  CHECK(error_in(dir, with("60.00", "1e300")).starts_with("s.carmen:1: maximum_range is \"1e+300\"; expected"));
  CHECK(error_in(dir, with("1.5", "1.5m")) == "s.carmen:1: a range is \"1.5m\"; expected a number");
  CHECK(error_in(dir, with("-1.0", "left")) == "s.carmen:1: start_angle is \"left\"; expected a number");
  CHECK(error_in(dir, with("60.00", "-1")).starts_with("s.carmen:1: maximum_range is "));
  CHECK(error_in(dir, with("12.025", "now")) == "s.carmen:1: ipc_timestamp is \"now\"; expected a time in seconds");
  CHECK(error_in(dir, with("12.025", "9223372036.85")) ==
        "s.carmen:1: ipc_timestamp is \"9223372036.85\"; expected a time in seconds");
  CHECK(error_in(dir, with("12.030", "12.030 5")).starts_with("s.carmen:1: more fields, from"));
}

TEST_CASE("carmen: a time that goes back is for the caller to judge") {
  const TemporaryDirectory dir;
  const std::string earlier = std::string(scan).replace(scan.find("12.025"), 6, "12.024");
  CarmenReader reader(dir.write("s.carmen", scan + scan + earlier));
  for (const std::int64_t time_ns : {12025000000, 12025000000, 12024000000}) {
    const auto line = reader.next();
    REQUIRE(line);
    CHECK(line->time_ns == time_ns);
  }
}

TEST_CASE("carmen: a file without scan lines, or of another kind, is refused") {
  const TemporaryDirectory dir;
  CHECK(error_in(dir, "# nothing\nODOM 0 0 0\n").starts_with("s.carmen: no scan line"));
  CHECK(error_in(dir, "(1.0) can0 181#00\n").starts_with("s.carmen:1: message is \"(1.0)\"; expected RAWLASER1"));
}

TEST_CASE("carmen: what is written is read back") {
  const TemporaryDirectory dir;
  CarmenLine line;
  line.time_ns = 1290682980025000000;
  line.start_angle_rad = -2.3561945;
  line.field_of_view_rad = 4.712389;
  line.angular_resolution_rad = 0.004363323;
  line.maximum_range_m = 30.0;
  line.ranges_m = {1.234f, std::numeric_limits<float>::quiet_NaN(), 29.999f};
  std::ostringstream text;
  write_carmen(text, line);
  CarmenReader reader(dir.write("s.carmen", text.str()));
  const auto back = reader.next();
  REQUIRE(back);
  CHECK(back->time_ns == line.time_ns);
  CHECK(back->angular_resolution_rad == line.angular_resolution_rad);
  CHECK(back->maximum_range_m == 30.0);
  CHECK(back->ranges_m[0] == 1.234f);
  CHECK(std::isnan(back->ranges_m[1]));
  CHECK(back->ranges_m[2] == 29.999f);
}

TEST_CASE("carmen: a scan of other beams than the robot's laser is refused") {
  LaserSettings laser;
  CarmenLine line;
  line.start_angle_rad = -2.356194;
  line.angular_resolution_rad = 0.00436332;
  line.ranges_m.resize(1081);
  const auto error = [&] { return error_of([&] { check_geometry(line, laser, "s.carmen", 7); }); };
  REQUIRE(error().empty());
  SECTION("another number of beams") {
    line.ranges_m.resize(541);
    CHECK(error() == "s.carmen:7: 541 ranges; expected 1081, the beams of the robot's laser");
  }
  SECTION("another first bearing") {
    line.start_angle_rad += 0.0044;
    CHECK(error().starts_with("s.carmen:7: start_angle is -2.351794; expected -2.356194"));
  }
  SECTION("another step") {
    line.angular_resolution_rad *= 1.001;
    CHECK(error().starts_with("s.carmen:7: angular_resolution is "));
  }
}

TEST_CASE("carmen: damaged logs are read or refused, and nothing worse") {
  survive_damage("# CARMEN\n" + scan + "ODOM 1 2 3 4\n" + scan, "s.carmen", [](const std::string& path) {
    CarmenReader reader(path);
    while (const auto line = reader.next()) {
      try {
        check_geometry(*line, LaserSettings{}, path, reader.line());
      } catch (const BadInput&) {
      }
    }
  });
}
