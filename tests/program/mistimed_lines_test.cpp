// map with a recorded cloud, a scan line of which was joined with a tilt angle of another time.
#include <cmath>
#include <numbers>
#include <random>

#include "formats/csv.hpp"
#include "map/map.hpp"
#include "program.hpp"

namespace curbline::tools::testing {
namespace {

constexpr double degree = std::numbers::pi / 180, step_m = 0.1;

/// A nodding laser 1 m above a street: a line every 0.4 degrees of tilt, with bearings from -75 to 75 degrees.
struct Sweep {
  double across_m = 1e9;         ///< beyond this x, the ground is a step higher
  double aside_m = 1e9;          ///< and beyond this y
  int mistimed = -1;             ///< the line whose tilt is recorded
  double by_rad = 0.3 * degree;  ///< too small by this
  bool clockwise = false, shuffled = false;
  double yaw_rad = 0;  ///< of the laser, in the frame of the cloud

  std::vector<Point3> points() const;

 private:
  /// Where a ray meets the ground, or the face of the step.
  double range_m(const Point3& ray) const {
    const double low_m = -1 / ray.z, high_m = (step_m - 1) / ray.z;
    const auto on_step = [&](double at_m) { return at_m * ray.x > across_m || at_m * ray.y > aside_m; };
    if (!on_step(low_m)) return low_m;
    if (on_step(high_m)) return high_m;
    return low_m * ray.x > across_m ? across_m / ray.x : aside_m / ray.y;
  }
};

std::vector<Point3> Sweep::points() const {
  std::mt19937 random(5);
  std::normal_distribution<double> noise_m(0.0, 0.004);
  std::vector<Point3> points;
  for (int line = 0; line < 75; ++line) {
    const double tilt = (40 - 0.4 * line) * degree, recorded = line == mistimed ? tilt - by_rad : tilt;
    for (int beam = -150; beam <= 150; ++beam) {
      const double bearing = (clockwise ? -0.5 : 0.5) * beam * degree, c = std::cos(bearing), s = std::sin(bearing);
      const double range = range_m({c * std::cos(tilt), s, -c * std::sin(tilt)}) + noise_m(random);
      const double x = range * c * std::cos(recorded), y = range * s;
      points.push_back({x * std::cos(yaw_rad) - y * std::sin(yaw_rad), x * std::sin(yaw_rad) + y * std::cos(yaw_rad),
                        -range * c * std::sin(recorded)});
    }
  }
  if (shuffled) std::shuffle(points.begin(), points.end(), random);
  return points;
}

struct Mapped {
  std::vector<MapCurb> curbs;
  std::vector<LabelledCell> cells;
};

Mapped mapped(const Sweep& sweep, const Words& window) {
  const TemporaryDirectory dir;
  std::string text;
  for (const Point3& p : sweep.points())
    text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  const std::string labels = dir.path("labels.csv"), curbs = dir.path("curbs.csv");
  const Outcome outcome =
      curbline(Words{"map", dir.write("cloud.xyz", text), "--labels", labels, "--curbs", curbs} + window);
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  return {read_curbs(curbs), read_labels(labels)};
}

const Words ahead{"--origin", "1.5", "-2", "--size", "4", "4"};

TEST_CASE("program: a line of a cloud whose tilt is of another time makes no curb across the street") {
  Sweep sound{.aside_m = 1.2};
  const auto check_same_curbs = [&](const Words& window) {
    Sweep sweep = sound;
    sweep.mistimed = 55;  // 3.2 m ahead, 1.7 cm high
    const std::vector<MapCurb> curbs = mapped(sweep, window).curbs, kerb = mapped(sound, window).curbs;
    REQUIRE(curbs.size() == kerb.size());
    REQUIRE_FALSE(kerb.empty());
    for (std::size_t k = 0; k < kerb.size(); ++k) CHECK(curbs[k].height_m == Approx(kerb[k].height_m).margin(0.005));
  };
  SECTION("counter-clockwise") {
    check_same_curbs(ahead);
  }
  SECTION("clockwise") {
    sound.clockwise = true;
    check_same_curbs(ahead);
  }
  SECTION("in the frame of a robot that looks another way") {
    sound.yaw_rad = 130 * degree;
    check_same_curbs({"--origin", "-4.5", "-1", "--size", "4", "4"});
  }
}

TEST_CASE("program: a line of a cloud whose tilt is of another time is put back where it belongs") {
  const Mapped ahead_of_it = mapped({.mistimed = 55}, ahead);
  const Mapped to_the_left =
      mapped({.mistimed = 55, .yaw_rad = 90 * degree}, {"--origin", "-2", "1.5", "--size", "4", "4"});
  for (const Mapped* map : {&ahead_of_it, &to_the_left}) {
    for (const LabelledCell& cell : map->cells) CHECK(cell.cell.height_m == Approx(-1.0).margin(0.005));
  }
}

TEST_CASE("program: a curb across the street is no line whose tilt is of another time") {
  for (const double across_m : {2.6, 2.63, 2.66, 3.4, 3.45, 3.5}) {
    const Sweep sweep{.across_m = across_m}, unordered{.across_m = across_m, .shuffled = true};
    const Mapped map = mapped(sweep, ahead), as_it_is = mapped(unordered, ahead);
    REQUIRE(map.cells.size() == as_it_is.cells.size());
    for (std::size_t k = 0; k < map.cells.size(); ++k)
      CHECK(map.cells[k].cell.height_m == Approx(as_it_is.cells[k].cell.height_m).margin(1e-4));
  }
}

}  // namespace
}  // namespace curbline::tools::testing
