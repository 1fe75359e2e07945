// Regions, labels and curbs, written and read.
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/csv.hpp"
#include "formats/regions.hpp"
#include "formats_support.hpp"

using namespace curbline::tools;
using namespace curbline::tools::testing;

TEST_CASE("regions: polygons are apart by blank lines, millimetres become metres") {
  const TemporaryDirectory dir;
  const auto regions = read_regions(dir.write("a.gt", "1406 1159\n11345 1859\n11979 -310\n\n\n0 0\n1 0\n1 1\n0 1"));
  REQUIRE(regions.size() == 2);
  CHECK(regions[0].size() == 3);
  CHECK(regions[0][2].x == 11.979);
  CHECK(regions[0][2].y == -0.310);
  CHECK(regions[1].size() == 4);
}

TEST_CASE("regions: what is no polygon is refused with its line") {
  const TemporaryDirectory dir;
  const auto error = [&](const std::string& text) { return error_of([&] { read_regions(dir.write("a.gt", text)); }); };
  CHECK(error("0 0\n1 0\n\n0 0\n") == "a.gt:3: the polygon ends after 2 corners; expected at least 3");
  CHECK(error("0 0\n1 0\n1\n") == "a.gt:3: the line ends before y; expected one field more");
  CHECK(error("0 0\n1 0\n1 1 1\n").starts_with("a.gt:3: more fields"));
  CHECK(error("0 0\nx 0\n") == "a.gt:2: x is \"x\"; expected a number");
  CHECK(error("\n").starts_with("a.gt: no region"));
}

TEST_CASE("regions: what is written is read back") {
  const TemporaryDirectory dir;
  std::ostringstream text;
  write_regions(text, {{{1.5, -2.25}, {3, 4}, {0.0005, 1}}, {{0, 0}, {1, 0}, {1, 1}}});
  const auto back = read_regions(dir.write("a.gt", text.str()));
  REQUIRE(back.size() == 2);
  CHECK(back[0][0].y == -2.25);
  CHECK(back[0][2].x == 0.0005);
}

TEST_CASE("labels: one row a valid cell, at its centre, and back") {
  const TemporaryDirectory dir;
  Map map;
  map.grid = {-1.0, 2.0, 0.1, 0.2, 2, 2};
  map.cells.resize(4);
  map.cells[map.grid.at(0, 1)] = {0, 0, -0.123456, 4.9e-5, 17, 3, 0.875};
  map.cells[map.grid.at(1, 0)] = {0, 0, 0.5, 1e-6, 1, -1, 0.0};
  std::ostringstream text;
  write_labels(text, map);
  CHECK(text.str() ==
        "x_m,y_m,height_m,variance_m2,points,label,probability\n"
        "-0.950000,2.300000,-0.123456,0.000049000,17,3,0.875000\n"
        "-0.850000,2.100000,0.500000,0.000001000,1,-1,0.000000\n");
  const auto rows = read_labels(dir.write("l.csv", text.str()));
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].y_m == 2.3);
  CHECK(rows[0].cell.variance_m2 == 4.9e-5);
  CHECK(rows[0].cell.points == 17);
  CHECK(rows[1].cell.label == -1);
}

TEST_CASE("curbs: a row a piece, and back") {
  const TemporaryDirectory dir;
  std::ostringstream text;
  write_curbs(text, {{1, 2, 3.5, -4, 0.12, 0.004, 0.97, "step_up"}});
  CHECK(text.str() ==
        "x0_m,y0_m,x1_m,y1_m,height_m,height_sd_m,probability,kind\n"
        "1.000000,2.000000,3.500000,-4.000000,0.120000,0.004000,0.970000,step_up\n");
  const auto curbs = read_curbs(dir.write("c.csv", text.str()));
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].y1_m == -4.0);
  CHECK(curbs[0].kind == "step_up");
  std::ostringstream none;
  write_curbs(none, {});
  CHECK(read_curbs(dir.write("c.csv", none.str())).empty());
}

TEST_CASE(
    "curbs: a JSON line bears the names of the columns, in their order, the deviation of the place, the width of the "
    "face and the number") {
  std::ostringstream text;
  write_curb_json(text, {1, 2, 3.5, -4, static_cast<double>(0.12f), 0.004, 0.97, "step_up", 0.02, 0.03, 12});
  CHECK(
      text.str() ==
      R"({"x0_m":1.0,"y0_m":2.0,"x1_m":3.5,"y1_m":-4.0,"position_sd_m":0.02,"height_m":0.12,"height_sd_m":0.004,"probability":0.97,"kind":"step_up","face_width_m":0.03,"id":12})"
      "\n");
}

TEST_CASE("labels and curbs: other columns and bad values are refused") {
  const TemporaryDirectory dir;
  const std::string labels = "x_m,y_m,height_m,variance_m2,points,label,probability\n";
  const auto label_error = [&](const std::string& text) {
    return error_of([&] { read_labels(dir.write("l.csv", text)); });
  };
  CHECK(label_error("x,y\n").starts_with("l.csv:1: other columns; expected"));
  CHECK(label_error(labels + "0,0,0,0,0,1,0.5\n").starts_with("l.csv:2: points is \"0\""));
  CHECK(label_error(labels + "0,0,0,0,1,1,1.5\n") == "l.csv:2: probability is \"1.500000\"; expected 0 to 1");
  CHECK(label_error(labels + "0,0,0,-1,1,1,0.5\n") ==
        "l.csv:2: variance_m2 is \"-1.000000\"; expected a number of 0 or more");
  CHECK(label_error(labels + "0,0,0,0,1,1\n") == "l.csv:2: the line ends before probability; expected one field more");
  CHECK(label_error(labels + "0,0,0,0,1,1,1,1\n").starts_with("l.csv:2: more fields"));
  const std::string curbs = "x0_m,y0_m,x1_m,y1_m,height_m,height_sd_m,probability,kind\n";
  const auto curb_error = [&](const std::string& text) {
    return error_of([&] { read_curbs(dir.write("c.csv", text)); });
  };
  CHECK(curb_error(curbs + "0,0,0,0,0,0,0.5,kerb\n") ==
        "c.csv:2: kind is \"kerb\"; expected step_up, step_down, crease or ramp_edge");
  CHECK(curb_error(curbs + "0,0,1,0,0.1,-0.01,0.5,crease\n") ==
        "c.csv:2: height_sd_m is \"-0.010000\"; expected a number of 0 or more");
  CHECK(
      curb_error(curbs + "0,0,1e10,0,0,0,0.5,crease\n").starts_with("c.csv:2: x1_m is \"10000000000.000\"; expected"));
  CHECK(curb_error(curbs + "0,0,1,0,0,0,0.5,crease\n-9e3,0,9e3,0,0,0,0.5,crease\n") ==
        "c.csv:3: the length is \"18000.000\"; expected a piece of curb of 10 km at most");
  CHECK(label_error(labels + "0,-1e10,0,0,1,1,0.5\n").starts_with("l.csv:2: y_m is \"-10000000000.000\"; expected"));
  survive_damage(
      curbs + "1.0,2.0,3.5,-4.0,0.12,0.004,0.97,step_up\n", "c.csv", [](const std::string& path) { read_curbs(path); },
      1000);
  survive_damage(
      labels + "1.0,2.0,3.5,0.0001,12,4,0.97\n", "l.csv", [](const std::string& path) { read_labels(path); }, 1000);
  survive_damage(
      "0 0\n1 0\n1 1\n\n0 0\n1000 0\n1 1\n", "a.gt", [](const std::string& path) { read_regions(path); }, 1000);
}
