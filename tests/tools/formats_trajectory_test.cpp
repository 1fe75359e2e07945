#include "formats/trajectory.hpp"

#include <cmath>
#include <sstream>

#include "formats_support.hpp"

using namespace curbline::tools;
using namespace curbline::tools::testing;

namespace {

std::string error_in(const TemporaryDirectory& dir, const std::string& text) {
  return error_of([&] {
    TrajectoryReader reader(dir.write("p.tum", text));
    while (reader.next()) {
    }
  });
}

}  // namespace

TEST_CASE("trajectory: a pose is read with its time to the nanosecond") {
  const TemporaryDirectory dir;
  TrajectoryReader reader(
      dir.write("p.tum", "# time tx ty tz qx qy qz qw\n1290682980.000000001 1 -2 0.5 0 0 0.6 0.8\n"));
  const auto pose = reader.next();
  REQUIRE(pose);
  CHECK(pose->time_ns == 1290682980000000001);
  CHECK(pose->y_m == -2.0);
  CHECK(pose->qz == 0.6);
  CHECK(pose->qw == 0.8);
  CHECK_FALSE(reader.next());
}

TEST_CASE("trajectory: times with an exponent are read to a microsecond") {
  const TemporaryDirectory dir;
  TrajectoryReader reader(dir.write("p.tum", "1.290682980025000095e+09 0 0 0 0 0 0 1\n"));
  CHECK(std::abs(reader.next()->time_ns - 1290682980025000000) < 1000);
}

TEST_CASE("trajectory: a quaternion near norm 1 is normalised, another one refused") {
  const TemporaryDirectory dir;
  TrajectoryReader reader(dir.write("p.tum", "1 0 0 0 0 0 0 0.995\n"));
  CHECK(reader.next()->qw == 1.0);
  CHECK(error_in(dir, "1 0 0 0 0 0 0 0.98\n") == "p.tum:1: the quaternion's norm is \"0.980\"; expected 1 within 0.01");
  CHECK(error_in(dir, "1 0 0 0 0 0 0 0\n").starts_with("p.tum:1: the quaternion's norm"));
  CHECK(error_in(dir, "1 0 0 0 1e200 0 0 0\n").starts_with("p.tum:1: the quaternion's norm"));
}

TEST_CASE("trajectory: a robot that lies on its back is refused, as poses with qw first have it") {
  const TemporaryDirectory dir;
  CHECK(error_in(dir, "1 0 0 0 0 0 0 1\n2 0 0 0 0.995 0 0 0.0998\n") ==
        "p.tum:2: the robot's tilt is \"169 deg\"; expected at most 90 deg, by qx qy qz qw in this order, z up");
  CHECK(error_in(dir, "1 0 0 0 0.6 0 0 0.8\n").empty());
}

TEST_CASE("trajectory: positions in coordinates of a national grid are refused, with their field") {
  const TemporaryDirectory dir;
  CHECK(error_in(dir, "1 465000.5 -1e6 400 0 0 0 1\n2 465000.5 5247000.25 400 0 0 0 1\n") ==
        "p.tum:2: ty is \"5247000.250\"; expected metres within 1000 km, better 1 km, of the map's origin");
}

TEST_CASE("trajectory: a number of 300 digits is told in few") {
  const TemporaryDirectory dir;
  CHECK(error_in(dir, "1 1e300 0 0 0 0 0 1\n").starts_with("p.tum:1: tx is \"1e+300\"; expected metres"));
}

TEST_CASE("trajectory: cut lines, junk and times that go back are refused") {
  const TemporaryDirectory dir;
  CHECK(error_in(dir, "1 0 0 0 0 0 0\n") == "p.tum:1: the line ends before qw; expected one field more");
  CHECK(error_in(dir, "1 0 0 0 0 0 0 1 1\n").starts_with("p.tum:1: more fields, from"));
  CHECK(error_in(dir, "1 0 nan 0 0 0 0 1\n") == "p.tum:1: ty is \"nan\"; expected a finite number");
  CHECK(error_in(dir, "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n").starts_with("p.tum:2: the time goes back"));
  for (const std::string late : {"9223372036.85", "9.3e9"})
    CHECK(error_in(dir, late + " 0 0 0 0 0 0 1\n") == "p.tum:1: time is \"" + late + "\"; expected a time in seconds");
  CHECK(error_in(dir, "# none\n").starts_with("p.tum: no pose"));
}

TEST_CASE("trajectory: what is written is read back") {
  const TemporaryDirectory dir;
  std::ostringstream text;
  write_trajectory_pose(text, {1290682980123456789, 1.25, -2.5, 0.125, 0.5, -0.5, 0.5, 0.5});
  TrajectoryReader reader(dir.write("p.tum", text.str()));
  const auto pose = reader.next();
  REQUIRE(pose);
  CHECK(pose->time_ns == 1290682980123456789);
  CHECK(pose->z_m == 0.125);
  CHECK(pose->qy == -0.5);
}

TEST_CASE("trajectory: damaged files are read or refused, and nothing worse") {
  survive_damage("# tum\n1290682980.5 1 -2 0.5 0 0 0.6 0.8\n1.3e9 1 -2 0.5 0 0 0.6 0.8\n", "p.tum",
                 [](const std::string& path) {
                   TrajectoryReader reader(path);
                   while (reader.next()) {
                   }
                 });
}
