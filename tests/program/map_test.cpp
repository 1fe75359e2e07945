// map: from one cloud to labels, curbs, a picture and a summary.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "formats/csv.hpp"
#include "program.hpp"

namespace curbline::tools::testing {
namespace {

const Words window{"--origin", "0", "-2", "--size", "4", "4"};

struct Files {
  explicit Files(const TemporaryDirectory& dir) : labels(dir.path("labels.csv")), curbs(dir.path("curbs.csv")) {}
  Words options() const { return {"--labels", labels, "--curbs", curbs}; }
  std::string labels, curbs;
};

void check_done(const Outcome& outcome) {
  INFO("standard error: " << outcome.err);
  REQUIRE(outcome.status == 0);
}

//                 _______________ 0.12
//                |
//  ______________|
//  0             2                4 m
TEST_CASE("program: map finds a step of 12 cm within 5 mm at its place") {
  const TemporaryDirectory dir;
  const Files files(dir);
  const std::string cloud = cloud_with_a_step(dir);
  const Outcome outcome = curbline(Words{"map", cloud, "--json"} + window + files.options());
  check_done(outcome);
  CHECK(outcome.err.empty());

  CHECK(lines_of(read_file(files.curbs))[0] == "x0_m,y0_m,x1_m,y1_m,height_m,height_sd_m,probability,kind");
  const std::vector<MapCurb> curbs = read_curbs(files.curbs);
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].height_m == Approx(0.12).margin(0.005));
  CHECK(curbs[0].kind == "step_up");
  for (const double x_m : {curbs[0].x0_m, curbs[0].x1_m}) CHECK(x_m == Approx(2.0).margin(0.05));
  CHECK(std::abs(curbs[0].y1_m - curbs[0].y0_m) > 3.8);
}

TEST_CASE("program: map writes a row of labels for each valid cell") {
  const TemporaryDirectory dir;
  const Files files(dir);
  const Outcome outcome = curbline(Words{"map", cloud_with_a_step(dir), "--json"} + window + files.options());
  check_done(outcome);

  CHECK(lines_of(read_file(files.labels))[0] == "x_m,y_m,height_m,variance_m2,points,label,probability");
  const std::vector<LabelledCell> cells = read_labels(files.labels);
  REQUIRE(cells.size() == 1600);  // 40 x 40 cells, 16 points in each
  int near = -1, far = -1;
  for (const LabelledCell& cell : cells) {
    CHECK(cell.cell.points == 16);
    CHECK(cell.cell.height_m == Approx(cell.x_m < 2.0 ? 0.0 : 0.12).margin(0.006));
    (cell.x_m < 2.0 ? near : far) = cell.cell.label;
  }
  CHECK(cells.front().x_m == Approx(0.05));
  CHECK(cells.front().y_m == Approx(-1.95));
  CHECK(near != far);

  const nlohmann::json summary = nlohmann::json::parse(outcome.out);  // throws unless it is one object and nothing else
  CHECK(summary.at("cells") == 1600);
  CHECK(summary.at("points") == 25600);
  CHECK(summary.at("curbs") == 1);
  CHECK(summary.at("planes") == 2);
  CHECK(lines_of(outcome.out).size() == 1);
}

TEST_CASE("program: map without a window takes the robot's, with a valid cell for what lies in it") {
  const TemporaryDirectory dir;
  const Files files(dir);
  check_done(curbline(Words{"map", cloud_with_a_step(dir)} + files.options()));
  CHECK(read_labels(files.labels).size() == 1600);
  CHECK(read_curbs(files.curbs).size() == 1);
}

TEST_CASE("program: map gives curbs as JSON lines on standard output") {
  const TemporaryDirectory dir;
  const std::string cloud = cloud_with_a_step(dir);
  for (const std::string method : {"curbline", "crf-em"}) {
    const Outcome outcome = curbline(Words{"map", cloud, "--curbs", "-", "--method", method} + window);
    check_done(outcome);
    const Words lines = lines_of(outcome.out);
    REQUIRE_FALSE(lines.empty());
    for (const std::string& line : lines)
      CHECK(nlohmann::json::parse(line).at("height_m").get<double>() == Approx(0.12).margin(0.005));
  }
}

TEST_CASE("program: each of the paper's steps finds the two planes") {
  const TemporaryDirectory dir;
  const Files files(dir);
  const std::string cloud = cloud_with_a_step(dir);
  for (const std::string method : {"segment", "em", "crf-em"}) {
    INFO(method);
    const Outcome outcome = curbline(Words{"map", cloud, "--json", "--method", method} + window + files.options());
    check_done(outcome);
    CHECK(nlohmann::json::parse(outcome.out).at("cells") == 1600);
    double length = 0;
    for (const MapCurb& c : read_curbs(files.curbs)) {
      if (std::abs(c.height_m - 0.12) < 0.005 && std::abs(c.x0_m - 2.0) < 0.05) length += std::abs(c.y1_m - c.y0_m);
    }
    CHECK(length > 3.8);
  }
}

TEST_CASE("program: the paper's peers find the curb, and no labels") {
  const TemporaryDirectory dir;
  const Files files(dir);
  const std::string cloud = cloud_with_a_step(dir);
  for (const std::string method : {"canny", "gradient"}) {
    INFO(method);
    check_done(curbline(Words{"map", cloud, "--method", method} + window + files.options()));
    double length = 0;
    for (const MapCurb& c : read_curbs(files.curbs)) {
      if (c.kind == "step_up" && std::abs(c.x0_m - 2.0) < 0.06) length += std::abs(c.y1_m - c.y0_m);
    }
    CHECK(length > 3.5);
    for (const LabelledCell& cell : read_labels(files.labels)) CHECK(cell.cell.label == -1);
  }
}

TEST_CASE("program: map takes --edge and --segment-scale, and a larger scale gives no more planes") {
  const TemporaryDirectory dir;
  const std::string cloud = cloud_with_a_step(dir);
  check_done(curbline(Words{"map", cloud, "--method", "crf-em", "--edge", "eq10"} + window));
  for (const std::string method : {"crf-em", "em", "segment"})
    check_done(curbline(Words{"map", cloud, "--method", method, "--edge", "potts"} + window));
  const auto planes = [&](const std::string& scale) {
    const Outcome outcome =
        curbline(Words{"map", cloud, "--json", "--method", "segment", "--segment-scale", scale} + window);
    check_done(outcome);
    return nlohmann::json::parse(outcome.out).at("planes").get<int>();
  };
  CHECK(planes("100") <= planes("0.01"));
  CHECK(planes("0.01") > 2);
}

TEST_CASE(
    "program: the paper's steps refuse more cells and planes than memory has room for, segment takes any window") {
  const TemporaryDirectory dir;
  std::string text;
  std::mt19937 random(3);
  std::normal_distribution<double> noise_m(0, 0.01);
  for (int i = 0; i < 512; ++i) {
    for (int j = 0; j < 512; ++j) {
      for (int k = 0; k < 2; ++k) {
        text += std::to_string(0.1 * i + 0.05) + ' ' + std::to_string(0.1 * j + 0.05) + ' ' +
                std::to_string(noise_m(random)) + '\n';
      }
    }
  }
  const std::string cloud = dir.write("rough.xyz", text);
  const Words whole{"--origin", "0", "0", "--size", "51.2", "51.2"};
  for (const std::string method : {"crf-em", "em"}) {
    check_refused(curbline(Words{"map", cloud, "--method", method} + whole),
                  "--method " + method + ": 262144 cells and ",
                  " planes; expected a product of at most 33554432: a smaller window, larger cells or a larger "
                  "--segment-scale");
  }
  check_done(curbline(Words{"map", cloud, "--method", "segment"} + whole));
}

TEST_CASE("program: a cell may have two sides") {
  const TemporaryDirectory dir;
  const Files files(dir);
  check_done(curbline(Words{"map", cloud_with_a_step(dir), "--cell", "0.2", "0.1"} + window + files.options()));
  const std::vector<LabelledCell> cells = read_labels(files.labels);
  REQUIRE(cells.size() == 800);
  CHECK(cells.front().x_m == Approx(0.1));
  CHECK(cells.front().y_m == Approx(-1.95));
  CHECK(cells.front().cell.points == 32);
}

TEST_CASE("program: a point on the line between two cells is of the same one by curbline and by the paper's steps") {
  const TemporaryDirectory dir;
  const Files files(dir);
  std::string text;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const double x_m = (3500 + 100 * i) / 1000.0, y_m = (-9500 + 100 * j) / 1000.0;
      text += std::to_string(x_m) + " " + std::to_string(y_m) + " -0.9\n";
    }
  }
  const std::string cloud = dir.write("cloud.xyz", text);
  const auto points_by = [&](const std::string& method) {
    check_done(curbline(Words{"map", cloud, "--origin", "3.5", "-9.5", "--size", "4", "4", "--method", method} +
                        files.options()));
    std::map<std::array<long, 2>, double> points;
    for (const LabelledCell& cell : read_labels(files.labels))
      points[{std::lround(100 * cell.x_m), std::lround(100 * cell.y_m)}] = cell.cell.points;
    return points;
  };
  CHECK(points_by("curbline") == points_by("segment"));
}

TEST_CASE("program: points above --max-height are ignored") {
  const TemporaryDirectory dir;
  const Files files(dir);
  check_done(curbline(Words{"map", cloud_with_a_step(dir), "--max-height", "0.06"} + window + files.options()));
  CHECK(read_labels(files.labels).size() == 800);
  CHECK(read_curbs(files.curbs).empty());
}

TEST_CASE("program: a cloud without a point in the window is refused with the extent of both") {
  const TemporaryDirectory dir;
  const std::string cloud = dir.write("a.xyz", "1 -2 0.5\n3.25 4 0.25\n");
  const auto refused = [&](const Words& options, const std::string& window_text) {
    check_refused(curbline(Words{"map", cloud, "--labels", dir.path("l.csv")} + options),
                  cloud + ": no point within " + window_text,
                  "the cloud has x 1.000 to 3.250, y -2.000 to 4.000, z 0.250 to 0.500\n");
    CHECK(names_in(dir.path("")) == Words{"a.xyz"});
  };
  for (const std::string method : {"curbline", "crf-em", "canny"}) {
    INFO(method);
    refused({"--method", method, "--origin", "1000", "2000", "--size", "4", "6"},
            "x 1000.000 to 1004.000, y 2000.000 to 2006.000 m; expected some: ");
    refused({"--method", method, "--origin", "0", "-2", "--size", "4", "8", "--max-height", "-100"},
            "x 0.000 to 4.000, y -2.000 to 6.000, z up to -100.000 m; expected some: ");
  }
}

TEST_CASE("program: where a cloud lies is told in few digits, however far away it is") {
  const TemporaryDirectory dir;
  const Outcome outcome = curbline({"map", dir.write("far.xyz", "1e300 1e300 -1e300\n")});
  check_refused(outcome, dir.path("far.xyz") + ": no point within ",
                "the cloud has x 1e+300 to 1e+300, y 1e+300 to 1e+300, z -1e+300 to -1e+300\n");
}

TEST_CASE("program: a cloud in coordinates of a national grid gives its map there") {
  const TemporaryDirectory dir;
  const Files files(dir);
  const std::string cloud = cloud_with_a_step(dir);
  check_done(curbline(Words{"map", cloud} + window + files.options()));
  const std::vector<LabelledCell> here = read_labels(files.labels);
  const std::vector<MapCurb> curbs_here = read_curbs(files.curbs);
  REQUIRE(curbs_here.size() == 1);

  constexpr double east_m = 465400, north_m = 5247000, high_m = 3600;
  std::string text;
  for (const std::string& point : lines_of(read_file(cloud))) {
    double x = 0, y = 0, z = 0;
    REQUIRE(std::sscanf(point.c_str(), "%lf %lf %lf", &x, &y, &z) == 3);
    text += std::to_string(x + east_m) + " " + std::to_string(y + north_m) + " " + std::to_string(z + high_m) + "\n";
  }
  check_done(curbline(Words{"map", dir.write("grid.xyz", text), "--origin", "465400", "5246998", "--size", "4", "4",
                            "--max-height", "3600.5", "--picture", dir.path("map.svg")} +
                      files.options()));
  const std::vector<LabelledCell> there = read_labels(files.labels);
  REQUIRE(there.size() == here.size());
  for (std::size_t k = 0; k < here.size(); ++k) {
    CHECK(there[k].x_m - east_m == Approx(here[k].x_m).margin(1e-6));
    CHECK(there[k].y_m - north_m == Approx(here[k].y_m).margin(1e-6));
    CHECK(there[k].cell.height_m - high_m == Approx(here[k].cell.height_m).margin(5e-4));
    CHECK(there[k].cell.label == here[k].cell.label);
  }
  const std::vector<MapCurb> curbs = read_curbs(files.curbs);
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].kind == "step_up");
  CHECK(curbs[0].height_m == Approx(curbs_here[0].height_m).margin(5e-4));
  for (const double x_m : {curbs[0].x0_m, curbs[0].x1_m}) CHECK(x_m - east_m == Approx(2.0).margin(0.05));
  for (const double y_m : {curbs[0].y0_m, curbs[0].y1_m}) CHECK(std::abs(y_m - north_m) == Approx(2.0).margin(0.1));
}

//  laser
//    .           shadow
//  ______________ ..
//  0             2   |________  -0.12
TEST_CASE(
    "program: a step down lies at its edge, whether the cloud is in the frame of the laser or of the robot's base") {
  const TemporaryDirectory dir;
  constexpr double laser_m = 1.1, edge_m = 2, drop_m = 0.12;
  for (const double origin_m : {laser_m, 0.0}) {
    std::string text;
    for (double x = 0.5; x < 4; x += 0.02) {
      if (x > edge_m && x < edge_m * (1 + drop_m / laser_m)) continue;
      for (double y = -2; y < 2; y += 0.04) {
        const double noise_m = 0.002 * std::sin(9177 * x + 4211 * y);
        text += std::to_string(x) + " " + std::to_string(y) + " " +
                std::to_string((x < edge_m ? 0 : -drop_m) - origin_m + noise_m) + "\n";
      }
    }
    const Files files(dir);
    check_done(curbline(Words{"map", dir.write("cloud.xyz", text)} + window + files.options()));
    const std::vector<MapCurb> curbs = read_curbs(files.curbs);
    REQUIRE(curbs.size() == 1);
    CHECK(curbs[0].kind == "step_down");
    for (const double x_m : {curbs[0].x0_m, curbs[0].x1_m}) CHECK(x_m == Approx(edge_m).margin(0.03));
  }
}

TEST_CASE("program: a window of 300 x 300 cells is mapped, and of any size exactly as asked") {
  const TemporaryDirectory dir;
  const Files files(dir);
  const std::string cloud = cloud_with_a_step(dir);
  check_done(curbline(Words{"map", cloud, "--origin", "-13", "-15", "--size", "30", "30"} + files.options()));
  CHECK(read_labels(files.labels).size() == 1600);
  REQUIRE(read_curbs(files.curbs).size() == 1);
  CHECK(read_curbs(files.curbs)[0].height_m == Approx(0.12).margin(0.005));
  check_done(curbline(Words{"map", cloud, "--origin", "1.5", "-0.5", "--size", "1.3", "0.7"} + files.options()));
  CHECK(read_labels(files.labels).size() == 13 * 7);
}

TEST_CASE("program: a strip at the window's edge is recognised by what lies beyond, which is not output") {
  const TemporaryDirectory dir;
  const Files files(dir);
  // One row of cells of the pavement behind the step lies in the window.
  const Words narrow{"--origin", "0.1", "-1", "--size", "2", "1.5"};
  check_done(curbline(Words{"map", cloud_with_a_step(dir)} + narrow + files.options()));
  CHECK(read_labels(files.labels).size() == 20 * 15);
  const std::vector<MapCurb> curbs = read_curbs(files.curbs);
  REQUIRE(curbs.size() == 1);
  CHECK(curbs[0].height_m == Approx(0.12).margin(0.005));
  CHECK(curbs[0].height_sd_m < 0.004);
  CHECK(std::minmax(curbs[0].y0_m, curbs[0].y1_m).first == Approx(-1.0).margin(1e-3));
  CHECK(std::minmax(curbs[0].y0_m, curbs[0].y1_m).second == Approx(0.5).margin(1e-3));
  const Words before{"--origin", "0", "-1", "--size", "1.9", "1.5"};
  check_done(curbline(Words{"map", cloud_with_a_step(dir)} + before + files.options()));
  CHECK(read_curbs(files.curbs).empty());
}

TEST_CASE("program: pictures are SVG or PNG by their ending") {
  const TemporaryDirectory dir;
  const std::string cloud = cloud_with_a_step(dir);
  check_done(curbline({"map", cloud, "--picture", dir.path("map.svg")}));
  const std::string svg = read_file(dir.path("map.svg"));
  CHECK(svg.find("<svg") != std::string::npos);
  CHECK(svg.find("</svg>") != std::string::npos);
  check_done(curbline({"map", cloud, "--picture", dir.path("map.png")}));
  CHECK(read_file(dir.path("map.png")).starts_with("\x89PNG\r\n\x1a\n"));
}

TEST_CASE("program: the kinds of clouds give the same map") {
  const TemporaryDirectory dir;
  const Files files(dir);
  const std::string cloud = cloud_with_a_step(dir);
  check_done(curbline(Words{"map", cloud} + window + files.options()));
  const std::string labels = read_file(files.labels), curbs = read_file(files.curbs);
  const Words points = lines_of(read_file(cloud));
  std::string csv = "x,y,z\n", pcd = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH " +
                                     std::to_string(points.size()) + "\nHEIGHT 1\nPOINTS " +
                                     std::to_string(points.size()) + "\nDATA ascii\n";
  for (std::string point : points) {
    pcd += point + "\n";
    std::replace(point.begin(), point.end(), ' ', ',');
    csv += point + "\n";
  }
  for (const std::string& other : {dir.write("step.csv", csv), dir.write("step.pcd", pcd)}) {
    check_done(curbline(Words{"map", other} + window + files.options()));
    CHECK(read_file(files.labels) == labels);
    CHECK(read_file(files.curbs) == curbs);
  }
}

}  // namespace
}  // namespace curbline::tools::testing
