#include "formats/cloud.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <limits>
#include <thread>

#include "formats_support.hpp"

using namespace curbline::tools;
using namespace curbline::tools::testing;

namespace {

template <typename T>
std::string bytes_of(std::initializer_list<T> values) {
  std::string bytes;
  for (const T value : values) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), &value, sizeof(T));
    bytes.append(raw.data(), raw.size());
  }
  return bytes;
}

std::string pcd_header(const std::string& fields, int points, const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\n" + fields + "WIDTH " + std::to_string(points) +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " + data + "\n";
}

const std::string xyz_fields = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

bool is(const Point3& p, double x, double y, double z) {
  return p.x == x && p.y == y && p.z == z;
}

}  // namespace

TEST_CASE("cloud: text is read by blanks or commas, with a header or columns to spare") {
  const TemporaryDirectory dir;
  for (const char* text : {"1 2 3\n-4 5e-1 6\n", "  1\t2  3 9 9\n# note\n\n-4 .5 6\n", "1,2,3\n-4, 0.5 ,6,7\n",
                           "x,y,z\n1,2,3\n-4,0.5,6", "i,z_m,Y,\"x\"\n0,3,2,1\n0,6,0.5,-4\r\n",
                           "info,x,y,z\n7,1,2,3\n7,-4,0.5,6\n", "//X Y Z R\n1 2 3 0\n-4 0.5 6 0\n",
                           ",x,y,z\n0,1,2,3\n1,-4,0.5,6\n", "\"\",\"x\",\"y\",\"z\"\n\"1\",1,2,3\n\"2\",-4,0.5,6\n"}) {
    INFO(text);
    const auto points = read_cloud(dir.write("a.csv", text));
    REQUIRE(points.size() == 2);
    CHECK(is(points[0], 1, 2, 3));
    CHECK(is(points[1], -4, 0.5, 6));
  }
}

TEST_CASE("cloud: bad text is refused with line and field") {
  const TemporaryDirectory dir;
  const auto error = [&](const std::string& text) { return error_of([&] { read_cloud(dir.write("a.xyz", text)); }); };
  CHECK(error("1 2 3\n1 2\n") == "a.xyz:2: the line ends before z; expected one field more");
  CHECK(error("1 2 3\n1 2 3x\n") == "a.xyz:2: z is \"3x\"; expected a number");
  CHECK(error("1 2 1e999\n") == "a.xyz:1: z is \"1e999\"; expected a number");
  CHECK(error("1,,3\n") == "a.xyz:1: y is \"\"; expected a number");
  for (const char* header : {"a,b,c\n", "x;y;z\n"}) {
    CHECK(error(header + std::string("1 2 3\n")) ==
          "a.xyz:1: no such columns; expected numbers, or names with x, y and z among them, apart by commas or blanks");
  }
  CHECK(error("x y z\n") == "a.xyz: no points; expected at least one");
  CHECK(error("") == "a.xyz: the file is empty; expected at least one line");
  CHECK(error_of([&] { read_cloud(dir.path("a.las")); }).starts_with("a.las: unknown kind of cloud"));
  CHECK(error_of([&] { read_cloud(dir.path("b.xyz")); }).starts_with("b.xyz: cannot be opened"));
}

TEST_CASE("cloud: KITTI records are float32 x y z intensity") {
  const TemporaryDirectory dir;
  const std::string good = bytes_of<float>({1, 2, 3, 0.5f, -4, 0.5f, 6, 0.1f});
  const auto points = read_cloud(dir.write("a.bin", good));
  REQUIRE(points.size() == 2);
  CHECK(is(points[1], -4, 0.5, 6));
  const auto error = [&](const std::string& text) { return error_of([&] { read_cloud(dir.write("a.bin", text)); }); };
  CHECK(error(good + "x").starts_with("a.bin: 33 bytes; expected a multiple of 16"));
  CHECK(error("").starts_with("a.bin: no points"));

  const std::string pipe = dir.path("pipe.bin");  // has no size
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << good << "x"; });
  CHECK(error_of([&] { read_cloud(pipe); }).starts_with("pipe.bin: 33 bytes; expected a multiple of 16"));
  writer.join();
}

TEST_CASE("cloud: a point that is not finite is no point, whatever the format, as organised clouds have them") {
  const TemporaryDirectory dir;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::string text = "nan nan nan\n1 2 3\n-inf 0 0\n0 nan 0\n-4 0.5 6\n";
  std::string commas = "x,y,z\n" + text;
  std::ranges::replace(commas, ' ', ',');
  const std::string records =
      bytes_of<float>({nan, nan, nan, 0, 1, 2, 3, 0, -inf, 0, 0, 0, 0, nan, 0, 0, -4, 0.5f, 6, nan});
  for (const std::string& path : {dir.write("a.xyz", text), dir.write("a.csv", commas), dir.write("a.bin", records),
                                  dir.write("a.pcd", pcd_header(xyz_fields, 5, "ascii") + text)}) {
    INFO(path);
    const auto points = read_cloud(path);
    REQUIRE(points.size() == 2);
    CHECK(is(points[0], 1, 2, 3));
    CHECK(is(points[1], -4, 0.5, 6));
  }
  CHECK(error_of([&] { read_cloud(dir.write("a.xyz", "nan nan nan\n")); }) ==
        "a.xyz: no points; expected at least one");
}

TEST_CASE("cloud: an ascii PCD is read by the names of its fields") {
  const TemporaryDirectory dir;
  const std::string fields = "FIELDS normal z x rgb y\nSIZE 4 4 4 4 8\nTYPE F F F U F\nCOUNT 3 1 1 1 1\n";
  const auto points = read_cloud(
      dir.write("a.pcd", pcd_header(fields, 3, "ascii") + "0 0 1 3 1 255 2\n0 0 1 nan 1 255 2\n0 0 1 6 -4 255 0.5\n"));
  REQUIRE(points.size() == 2);
  CHECK(is(points[0], 1, 2, 3));
  CHECK(is(points[1], -4, 0.5, 6));
}

TEST_CASE("cloud: a binary PCD is read at the offsets of its fields") {
  const TemporaryDirectory dir;
  const std::string fields = "FIELDS _ z x i y\nSIZE 1 4 8 2 4\nTYPE U F F U F\nCOUNT 3 1 1 1 1\n";
  std::string data;
  for (const auto& [x, y, z] :
       {std::array{1.0, 2.0, 3.0}, {0.0, 0.0, std::numeric_limits<double>::infinity()}, {-4.0, 0.5, 6.0}}) {
    data += "abc" + bytes_of<float>({static_cast<float>(z)}) + bytes_of<double>({x}) + bytes_of<std::uint16_t>({7}) +
            bytes_of<float>({static_cast<float>(y)});
  }
  const auto points = read_cloud(dir.write("a.pcd", pcd_header(fields, 3, "binary") + data));
  REQUIRE(points.size() == 2);
  CHECK(is(points[0], 1, 2, 3));
  CHECK(is(points[1], -4, 0.5, 6));
}

TEST_CASE("cloud: a PCD that is not what its header says is refused") {
  const TemporaryDirectory dir;
  const auto error = [&](const std::string& text) { return error_of([&] { read_cloud(dir.write("a.pcd", text)); }); };
  CHECK(error(pcd_header(xyz_fields, 1, "binary_compressed"))
            .starts_with("a.pcd:11: DATA is \"binary_compressed\"; expected ascii or binary"));
  CHECK(error(pcd_header(xyz_fields, 2, "ascii") + "1 2 3\n") == "a.pcd: the file ends after 1 points; expected 2");
  CHECK(error(pcd_header(xyz_fields, 1, "ascii") + "1 2 3\n1 2 3\n") ==
        "a.pcd:13: more points; expected 1 as the header has it");
  CHECK(error(pcd_header(xyz_fields, 1, "binary") + bytes_of<float>({1, 2, 3, 4, 5, 6})) ==
        "a.pcd: more points; expected 1 as the header has it");
  CHECK(
      read_cloud(dir.write("a.pcd", pcd_header(xyz_fields, 1, "binary") + bytes_of<float>({1, 2, 3}) + "\n")).size() ==
      1);
  CHECK(error(pcd_header(xyz_fields, 1, "ascii") + "1 2\n") ==
        "a.pcd:12: the line ends before z; expected one field more");
  CHECK(error(pcd_header(xyz_fields, 1, "ascii") + "1 2 3 4\n").starts_with("a.pcd:12: more fields"));
  CHECK(error(pcd_header(xyz_fields, 1000000000, "binary") + "abc") ==
        "a.pcd: the file ends after 0 points; expected 1000000000");
  CHECK(error(pcd_header(xyz_fields, 1, "ascii") + "nan nan nan\n") == "a.pcd: no points; expected at least one");
  CHECK(error(pcd_header("FIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\n", 1, "ascii")).find("lacks a field") !=
        std::string::npos);
  const auto layout = [&](const std::string& size, const std::string& type, const std::string& count) {
    return error(pcd_header("FIELDS x y z\nSIZE " + size + "\nTYPE " + type + "\nCOUNT " + count + "\n", 1, "ascii"));
  };
  CHECK(layout("4 4 2", "F F F", "1 1 1") == "a.pcd:4: SIZE of z is \"2\"; expected 4 or 8, a float");
  CHECK(layout("4 4 4", "F U F", "1 1 1") == "a.pcd:5: TYPE of y is \"U\"; expected F");
  CHECK(layout("4 4 4", "F F F", "3 1 1") == "a.pcd:6: COUNT of x is \"3\"; expected 1");
  CHECK(error(pcd_header("FIELDS x y z\nSIZE 4 4\n", 1, "ascii")) ==
        "a.pcd:4: the line ends before SIZE; expected one field more");
  CHECK(error("VERSION 0.5\n") == "a.pcd:1: VERSION is \"0.5\"; expected 0.7");
  CHECK(error("VERSION 0.7\nPONTS 3\n").starts_with("a.pcd:2: a key of the header is \"PONTS\""));
  CHECK(error("VERSION 0.7\n") == "a.pcd: the header has no DATA line; expected PCD 0.7");
  CHECK(error("VERSION 0.7\n" + xyz_fields + "WIDTH 2\nHEIGHT 2\nPOINTS 3\nDATA ascii\n")
            .starts_with("a.pcd:9: POINTS is 3; expected WIDTH x HEIGHT, 4"));
}

TEST_CASE("cloud: a coordinate that two columns bear is refused, since only the file's maker knows which is meant") {
  const TemporaryDirectory dir;
  const auto error = [&](const std::string& name, const std::string& text) {
    return error_of([&] { read_cloud(dir.write(name, text)); });
  };
  CHECK(error("a.csv", "x,y,z,x\n1,2,3,4\n") == "a.csv:1: column x twice; expected it once");
  CHECK(error("a.csv", "X Y_m Z y\n1 2 3 4\n") == "a.csv:1: column y twice; expected it once");
  const std::string twice = "FIELDS x y z x\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n";
  CHECK(error("a.pcd", pcd_header(twice, 1, "ascii") + "1 2 3 4\n") == "a.pcd:3: column x twice; expected it once");
  const std::string padding = "FIELDS _ x y z _\nSIZE 4 4 4 4 4\nTYPE F F F F F\nCOUNT 1 1 1 1 1\n";
  CHECK(is(read_cloud(dir.write("a.pcd", pcd_header(padding, 1, "ascii") + "0 1 2 3 4\n")).at(0), 1, 2, 3));
}

TEST_CASE("cloud: columns of what belongs to a coordinate, as its deviation, stand beside it or before it") {
  const TemporaryDirectory dir;
  for (const char* text : {"x y z z_sd x_n x_vel\n1 2 3 9 9 9\n", "x_sd,x_n,x,y,z [m],z.1\n9,9,1,2,3,9\n",
                           "x_m y_m y_sd z y_n\n1 2 9 3 9\n", "//X Y Z Z_SD\n1 2 3 9\n"}) {
    INFO(text);
    CHECK(is(read_cloud(dir.write("a.csv", text)).at(0), 1, 2, 3));
  }
  CHECK(error_of([&] { read_cloud(dir.write("a.csv", "x y z_sd z_n\n1 2 3 4\n")); }) ==
        "a.csv:1: column z twice; expected it once");
}

TEST_CASE("cloud: damaged clouds are read or refused, and nothing worse") {
  const auto read = [](const std::string& path) { read_cloud(path); };
  survive_damage("x,y,z,i\n1,2,3,4\n-4,0.5,6,1\n", "a.csv", read);
  survive_damage(pcd_header(xyz_fields, 2, "ascii") + "1 2 3\n-4 0.5 6\n", "a.pcd", read);
  survive_damage(pcd_header(xyz_fields, 2, "binary") + bytes_of<float>({1, 2, 3, -4, 0.5f, 6}), "a.pcd", read);
  survive_damage(bytes_of<float>({1, 2, 3, 0.5f, -4, 0.5f, 6, 0.1f}), "a.bin", read);
}
