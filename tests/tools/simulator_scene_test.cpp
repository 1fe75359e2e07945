// Scene files, the ground that they describe, and its truth.
#include "formats/bad_input.hpp"
#include "simulator/boundary.hpp"
#include "simulator/ray_caster.hpp"
#include "simulator/robot_motion.hpp"
#include "simulator/truth.hpp"
#include "tools/simulator_support.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>

using namespace curbline::tools;
using Catch::Matchers::Contains;

namespace {

double length_m(const TruthCurb& curb) {
  return std::hypot(curb.to.x - curb.from.x, curb.to.y - curb.from.y);
}

double cast(const Scene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double time_s = 0) {
  RayCaster world(scene);
  world.move_to(time_s);
  return world.cast(from, direction);
}

// A road whose crown lies on x = y, seen from a robot that is turned.
const std::string cambered =
    "[ground]\nz = 0.1\nslope = [0.02, 0.0]\ncamber = 0.04\ncrown = [[0, 0], [1, 1]]\n"
    "[robot]\nat = [2.0, 0.0]\nyaw_deg = 45\n";
const std::string bump = "[ground]\nz = 0\n[[region]]\nname = 'bump'\nrectangle = [2, -1, 4, 1]\nz = 0.12\n";

}  // namespace

TEST_CASE("scene: every scene that ships can be read and stood on") {
  const std::vector<std::string> names = shipped_scenes();
  CHECK(names.size() >= 22);
  for (const std::string& name : names) {
    INFO(name);
    const Scene scene = in_map_frame(find_scene(name));
    CHECK_FALSE(make_truth(scene, 0).curbs.empty());
    CHECK_NOTHROW(RobotMotion(scene));
  }
}

TEST_CASE("scene: a random street is one for all its seeds, can be stood on and has a curb through the window") {
  CHECK(find_scene("random:7").source == find_scene("random:7").source);
  CHECK(find_scene("random:7").source != find_scene("random:8").source);
  int low = 0, bends = 0;
  for (int seed = 0; seed < 60; ++seed) {
    INFO("random:" << seed);
    const Scene scene = in_map_frame(find_scene("random:" + std::to_string(seed)));
    CHECK_NOTHROW(RobotMotion(scene));
    for (const Obstacle& obstacle : scene.obstacles) CHECK_FALSE(contains(obstacle.outline, {0, 0}));
    double inside_m = 0, lowest_m = 1;
    for (const TruthCurb& curb : make_truth(scene, 0).curbs) {
      const Point2 middle{(curb.from.x + curb.to.x) / 2, (curb.from.y + curb.to.y) / 2};
      if (curb.kind != "step" || !crosses({0, -2, 4, 2}, curb.from, curb.to)) continue;
      inside_m += length_m(curb);
      if (std::hypot(middle.x - 2, middle.y) < 2) lowest_m = std::min(lowest_m, curb.height_m);
    }
    CHECK(inside_m > 1);
    CHECK(lowest_m < 0.16);
    low += lowest_m < 0.04;
    bends += scene.source.find("bends") != std::string::npos;
  }
  CHECK(low > 10);
  CHECK(bends > 10);
}

TEST_CASE("scene: a name that is not known is refused with those that are") {
  REQUIRE_THROWS_WITH(find_scene("atlantis"), Contains("atlantis") && Contains("straight_curb"));
  REQUIRE_THROWS_WITH(find_scene("random:x"), Contains("random:x") && Contains("expected random:"));
}

TEST_CASE("scene: bad files are refused with line and key") {
  const auto refused = [](const std::string& text, const std::string& at, const std::string& what) {
    INFO(text);
    REQUIRE_THROWS_AS(scene_of(text), BadInput);
    REQUIRE_THROWS_WITH(scene_of(text), Contains(".toml" + at) && Contains(what) && Contains("expected"));
  };
  refused("[ground]\nz = 0\nhight = 1\n", ":3:", "hight");
  refused("[ground]\nz = 'low'\n", ":2:", "z");
  refused("[ground]\nz = nan\n", ":2:", "z");
  refused("[ground]\nslope = [0, 0]\n", ":1:", "ground.z is missing");
  refused("[ground]\nz = 0\n[[region]]\nz = 1\npolygon = [[0, 0], [1, 1], [1, 0], [0, 1]]\n", ":5:", "crosses");
  refused("[[region]]\nz = 1\npolygon = [[0, 0], [1, 1]]\n", ":3:", "at least 3");
  refused("[[region]]\nz = 1\nrectangle = [0, 0, 1, 1]\ncircle = [0, 0, 1]\n", ":1:", "exactly one");
  refused("[[region]]\nz = 1\ncircle = [0, 0, -1]\n", ":3:", "circle");
  refused("[[region]]\nz = 1\nrectangle = [2, 0, 1, 1]\n", ":3:", "rectangle");
  refused("[[region]]\npolygon = [[0, 0], [0.1, 0.3], [0.2, 0.6], [2, 0]]\ncorner_z = [0, 0, 0.1]\n",
          ":3:", "on one line");
  refused(bump + "[[cylinder]]\nat = [0, 0]\nradius = 0\nheight = 1\n", ":9:", "radius");
  refused(bump + "[[box]]\nat = [0, 0]\nsize = [1, 1]\nheight = 1\nrepeat = { count = [0, 1], step = [1, 1] }\n",
          ":11:", "count");
  for (const char* step : {"[0, 0]", "[0, 1]", "[1, 0]"}) {
    refused(
        "[[region]]\nz = 0\nrectangle = [0, 0, 1, 1]\nrepeat = { count = [2, 2], step = " + std::string(step) + " }\n",
        ":4:", "region.repeat.step puts copies in one place");
  }
  refused(bump + "[robot]\npath = [[0, 0], [0, 0]]\n", ":8:", "path");
  refused(bump + "[robot]\nat = [0, 0]\nspeed = 1\n", ":9:", "speed");
  refused(bump + "[robot]\npath = [[0, 0], [1e5, 0]]\nspeed = 0.001\n", ":8:", "robot.path takes 100000000 s");
  refused(bump + "[robot]\npath = [[0, 0], [0, 1], [1, 1]]\nturn_rate_deg_s = 1e-3\n",
          ":8:", "robot.path takes 90002 s");
  refused("[ground]\nz = 0\ncamber = 0.01\n", ":1:", "ground.crown is missing");
  refused("[ground]\nz = 0\ncamber = 0.01\ncrown = [[0, 0], [0, 0]]\n", ":4:", "crown is no line");
  refused("[ground\n", ":1:", "");
  refused("[robot]\n", ":1:", "no ground");
}

TEST_CASE("scene: a robot over the void is refused") {
  const Scene nowhere = scene_of("[[region]]\nz = 0\nrectangle = [5, 5, 6, 6]\n");
  REQUIRE_THROWS_WITH(in_map_frame(nowhere), Contains("stands on nothing"));
}

TEST_CASE("scene: repeat shifts a sloping region with its plane") {
  const Scene scene = scene_of(
      "[[region]]\nrectangle = [0, 0, 1, 1]\ncorner_z = [0.0, 0.1, 0.1]\nrepeat = { count = [2, 2], step = [5, 7] }\n");
  REQUIRE(scene.regions.size() == 4);
  const int last = GroundPlan(scene.regions).region_at({5.5, 7.5});
  REQUIRE(last == 3);
  CHECK(scene.regions[3].plane.height_m({5.5, 7.5}) == Approx(0.05));
}

TEST_CASE("scene: ten thousand regions take seconds, not minutes") {
  const Scene paved = scene_of(
      "[ground]\nz = 0\n[[region]]\nrectangle = [-15, -15, -14.8, -14.8]\nz = 0.05\n"
      "repeat = { count = [100, 100], step = [0.3, 0.3] }\n");
  REQUIRE(paved.regions.size() == 10'001);
  const std::clock_t start = std::clock();
  const RayCaster world(paved);
  CHECK(make_truth(paved, 0).curbs.size() == 40'000);
  CHECK(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC < 5);
  CHECK(world.ground_height_m({0.1, 0.1}) == Approx(0.05));
  CHECK(world.ground_height_m({0.25, 0.1}) == 0);
}

TEST_CASE("scene: a cambered road falls from its crown to both sides, by the square of the way") {
  const SurfacePlane road = scene_of(cambered).regions[0].plane;
  CHECK(road.height_m({3, 3}) == Approx(0.1 + 0.06));
  for (const Point2 side : {Point2{4, 2}, {2, 4}}) CHECK(road.height_m(side) == Approx(0.1 + 0.02 * side.x - 0.04));
  CHECK(road.slope({4, 2}).x == Approx(0.02 - 0.04));
  CHECK(road.slope({4, 2}).y == Approx(0.04));
  const std::string copies = "[[region]]\nrectangle = [0, 0, 1, 1]\nz = 0.0\ncamber = 0.02\ncrown = [[0, 0], [0, 1]]\n";
  const Scene repeated = scene_of(copies + "repeat = { count = [2, 1], step = [5, 0] }\n");
  CHECK(repeated.regions[1].plane.height_m({6, 0}) == Approx(repeated.regions[0].plane.height_m({1, 0})));
}

TEST_CASE("scene: a round corner leaves the corner itself to the ground") {
  const Scene scene = scene_of("[[region]]\nz = 1\nrectangle = [0, 0, 4, 4]\ncorner_radius = 1\n");
  const GroundPlan plan(scene.regions);
  CHECK(plan.region_at({0.2, 0.2}) == -1);
  CHECK(plan.region_at({0.35, 0.35}) == 0);
  CHECK(signed_area_m2(scene.regions[0].outline) == Approx(16 - 4 + 3.14).margin(0.03));
}

TEST_CASE("scene: the map frame of a robot that stands is its own level base frame") {
  const Scene scene = in_map_frame(scene_of(bump + "[robot]\nat = [3.0, 0.0]\nyaw_deg = 90\n"));
  const Truth truth = make_truth(scene, 0);
  CHECK(truth.terrain_height(0, 0) == Approx(0).margin(1e-9));
  CHECK(truth.terrain_height(0.9, 0.9) == Approx(0).margin(1e-9));  // on the bump: 1 m ahead, 1 m left of its middle
  CHECK(truth.terrain_height(1.1, 0) == Approx(-0.12));
}

//        ____
//  -----|    |------   seen from the left, the near face hides the ground behind the far one
TEST_CASE("ray: it hits ground, face and top of a bump where they are") {
  const Scene scene = scene_of(bump);
  CHECK(cast(scene, {0, 0, 1}, {1, 0, -1}) == Approx(1));         // ground at x = 1
  CHECK(cast(scene, {0, 0, 0.06}, {1, 0, 0}) == Approx(2));       // face
  CHECK(cast(scene, {0, 0, 1.12}, {1, 0, -0.4}) == Approx(2.5));  // top at x = 2.5
  CHECK(cast(scene, {0, 0, 1}, {1, 0, -1 / 4.2}) == Approx(0.88 * 4.2));
  CHECK(cast(scene, {0, 0, 1}, {0, 0, -1}) == Approx(1));  // straight down
  CHECK(cast(scene, {0, 0, 1}, {0, 0, 1}) == RayCaster::nothing);
  CHECK(cast(scene, {0, 0, 1}, {1, 0, 0}) == RayCaster::nothing);  // over everything
  CHECK(cast(scene, {-50, 0, 1}, {1, 0, -0.01}) == Approx(100));   // ground far beyond all outlines
}

TEST_CASE("ray: a cambered road is hit where it is, from above and from beside it, bent up or down") {
  const double bend = GENERATE(0.02, -0.02);
  const std::string road = "[[region]]\nrectangle = [-20, -20, 20, 20]\nz = 0\ncrown = [[0, 0], [1, 0]]\n";
  const Scene scene = scene_of(road + "camber = " + std::to_string(bend) + "\n");
  for (const Eigen::Vector3d& along : {Eigen::Vector3d{1, 0, -0.5}, {0.3, -1, -0.2}, {0, 1, -0.05}, {0, 0.2, -1}}) {
    for (const double y : {-6.0, 0.0, 4.0}) {
      const Eigen::Vector3d from(0, y, 1), hit = from + cast(scene, from, along) * along;
      if (hit.z() < -19) continue;  // beside the region
      CHECK(hit.z() == Approx(scene.regions[0].plane.height_m({hit.x(), hit.y()})).margin(1e-9));
    }
  }
  CHECK(cast(scene, {0, 0, 1}, {1, 0, -0.1}) == Approx(10));  // along the crown
}

TEST_CASE("ray: one along the lines of the grid ends") {
  const Scene scene = scene_of(bump);
  CHECK(cast(scene, {2, -1, 0.06}, {6e-17, 1, 0}) >= 0);
  CHECK(cast(scene, {2.5, -5, 0.06}, {-6e-17, 1, 0}) == Approx(4));
}

TEST_CASE("ray: nothing of it before the hit lies below the true ground") {
  for (const char* name : {"lowered_curb", "roundabout", "inclined_planes", "steps"}) {
    const Scene scene = in_map_frame(find_scene(name));
    const Truth truth = make_truth(scene, 0);
    const RayCaster world(scene);
    int on_ground = 0, on_face = 0;
    for (int k = 0; k < 4000; ++k) {
      const Eigen::Vector3d from(0.01, 0.02, 1), along(std::cos(k * 0.37), std::sin(k * 0.37), -0.1 - 1e-4 * k);
      const double t = world.cast(from, along);
      const Eigen::Vector3d hit = from + t * along, before = from + (t - 1e-3) * along;
      if (t == RayCaster::nothing) continue;
      // No part of the ray before the hit is below the ground, and the hit is on the ground or at a step.
      CHECK_FALSE(before.z() < truth.terrain_height(before.x(), before.y()) - 1e-6);
      std::abs(hit.z() - truth.terrain_height(hit.x(), hit.y())) < 1e-6 ? ++on_ground : ++on_face;
    }
    INFO(name);
    CHECK(on_ground > 3000);
    CHECK(on_face < 1000);
  }
}

TEST_CASE("ray: obstacles stand on the ground, and those that move are elsewhere later") {
  const Scene scene = scene_of(bump +
                               "[[cylinder]]\nat = [3, 0]\nradius = 0.25\nheight = 1\n"
                               "[[box]]\nat = [0, 5]\nsize = [2, 1]\nyaw_deg = 90\nheight = 1\nvelocity = [1, 0]\n"
                               "[[wall]]\nfrom = [-3, -1]\nto = [-3, 1]\nthickness = 0.5\nheight = 2\nz = 1\n");
  CHECK(cast(scene, {0, 0, 1.1}, {1, 0, 0}) == Approx(2.75));
  CHECK(cast(scene, {0, 0, 1.13}, {1, 0, 0}) == RayCaster::nothing);
  CHECK(cast(scene, {0, 0, 0.5}, {0, 1, 0}) == Approx(4));
  CHECK(cast(scene, {0, 0, 0.5}, {0, 1, 0}, 2.0) == RayCaster::nothing);
  CHECK(cast(scene, {2, 0, 0.5}, {0, 1, 0}, 2.0) == Approx(4));
  CHECK(cast(scene, {0, 0, 1.5}, {-1, 0, 0}) == Approx(2.75));
  CHECK(cast(scene, {0, 0, 0.5}, {-1, 0, 0}) == RayCaster::nothing);  // below the wall
}

TEST_CASE("truth: a bump is bounded by four steps of its height, each once") {
  const Truth truth = make_truth(scene_of(bump), 0);
  REQUIRE(truth.curbs.size() == 4);
  for (const TruthCurb& curb : truth.curbs) {
    CHECK(length_m(curb) == Approx(2));
    CHECK(curb.height_m == Approx(0.12));
    CHECK(curb.left_z_m == Approx(0.12));  // outlines run counterclockwise
    CHECK(curb.right_z_m == Approx(0));
    CHECK(curb.kind == "step");
  }
}

//   ______________
//  |  a  |  b | a |   b covers a part of a; where both are equally high there is no curb
TEST_CASE("truth: what a later region covers has no curb, nor has a join of equal planes") {
  const Truth covered = make_truth(scene_of(bump + "[[region]]\nrectangle = [1, -2, 5, 2]\nz = 0.05\n"), 0);
  CHECK(covered.curbs.size() == 4);
  CHECK(covered.curbs[0].height_m == Approx(0.05));

  const Truth joined = make_truth(scene_of(bump + "[[region]]\nrectangle = [4, -1, 6, 1]\nz = 0.12\n"), 0);
  double sum_m = 0;
  for (const TruthCurb& curb : joined.curbs) sum_m += length_m(curb);
  CHECK(sum_m == Approx(2 * (4 + 2)));
  CHECK(joined.planes.size() == 2);
  CHECK(joined.regions.size() == 3);
}

//      ____
//              a board above a corner of the bump, on it, or on the ground beside it
//   _____
//  |     |____
TEST_CASE("truth: what stands on the ground hides it, what hangs above does not") {
  const auto table = [](const char* height) {
    return make_truth(scene_of(bump + "[[box]]\nat = [4, 1]\nsize = [1, 1]\nheight = 0.05\n" + height), 0);
  };
  CHECK(table("").obstacle_at(4, 1));
  CHECK(table("z = 0.0\n").obstacle_at(4, 1));
  CHECK(table("z = 0.12\n").obstacle_at(4, 1));  // half of it over the lower ground
  CHECK_FALSE(table("z = 0.7\n").obstacle_at(4, 1));
}

TEST_CASE("truth: a step that changes its sign is cut where it is nil") {
  const Truth truth = make_truth(scene_of("[[region]]\nrectangle = [0, 0, 4, 1]\nz = 0\n"
                                          "[[region]]\nrectangle = [0, 1, 4, 2]\nz = -0.1\nslope = [0.1, 0]\n"),
                                 0);
  REQUIRE(truth.curbs.size() == 2);
  for (const TruthCurb& curb : truth.curbs) {
    CHECK(curb.from_step_m * curb.to_step_m == Approx(0).margin(1e-9));
    CHECK(std::max(length_m(truth.curbs[0]), length_m(truth.curbs[1])) == Approx(3));
  }
}

TEST_CASE("truth: straight_curb is one step of 12 cm through the window, askew by 1 in 10") {
  const Truth truth = make_truth(in_map_frame(find_scene("straight_curb")), 0);
  double near_m = 0;
  for (const TruthCurb& curb : truth.curbs) {
    CHECK(curb.height_m == Approx(0.12));
    if (std::abs(curb.to.y - curb.from.y) > 0.2 && std::abs(curb.to.x - curb.from.x) > 0.2) {
      CHECK((curb.to.y - curb.from.y) / (curb.to.x - curb.from.x) == Approx(0.1));
      near_m += length_m(curb);
    }
  }
  CHECK(near_m == Approx(std::hypot(24, 2.4)));
  CHECK(truth.terrain_height(2, 0) == Approx(0).margin(1e-9));
  CHECK(truth.terrain_height(2, 1.5) == Approx(0.12));
}

TEST_CASE("truth: t_junction has curbs on either side, round corners and a curb ahead") {
  const Truth truth = make_truth(in_map_frame(find_scene("t_junction")), 0);
  const auto nearest_m = [&](double x, double y) {
    double best = 1e9;
    for (const TruthCurb& c : truth.curbs) {
      const double ex = c.to.x - c.from.x, ey = c.to.y - c.from.y;
      const double t = std::clamp(((x - c.from.x) * ex + (y - c.from.y) * ey) / (ex * ex + ey * ey), 0.0, 1.0);
      best = std::min(best, std::hypot(c.from.x + t * ex - x, c.from.y + t * ey - y));
    }
    return best;
  };
  CHECK(nearest_m(0.5, 1.0) < 1e-6);
  CHECK(nearest_m(0.5, -1.0) < 1e-6);
  CHECK(nearest_m(3.6, 0.3) < 1e-6);
  const double round = 0.8 * (1 - std::sqrt(0.5));  // from the corner to the arc along each axis
  CHECK(nearest_m(2.2 - round, 1.0 + round) < 0.005);
  CHECK(nearest_m(2.2, 1.0) > 0.3);
}

TEST_CASE("truth: a ramp has creases and no step") {
  for (const TruthCurb& curb : make_truth(in_map_frame(find_scene("ramp")), 0).curbs) {
    CHECK(curb.kind == "crease");
    CHECK(curb.height_m == Approx(0).margin(1e-9));
  }
}

TEST_CASE("truth: it is read as it was written") {
  const std::string name = GENERATE("street", "splayed_curbs");
  const Truth truth = make_truth(in_map_frame(find_scene(name)), 1700000000);
  const TemporaryPath temporary("truth");
  const std::filesystem::path& dir = temporary.path;
  std::filesystem::create_directories(dir);
  {
    std::ofstream out(dir / "truth.json");
    write_truth(out, truth);
  }
  const Truth read = read_truth(dir.string());
  CHECK(read.start_time_s == truth.start_time_s);
  REQUIRE(read.curbs.size() == truth.curbs.size());
  CHECK(read.curbs.back().to.x == truth.curbs.back().to.x);
  CHECK(read.curbs.back().kind == truth.curbs.back().kind);
  for (double y = -3; y < 3; y += 0.13) {
    CHECK(read.terrain_height(1, y) == truth.terrain_height(1, y));
    for (double x = 0; x < 4; x += 0.04) CHECK(read.plane_at(x, y) == truth.plane_at(x, y));
  }
  if (name == "street") {
    CHECK(read.obstacle_at(9.40, -1.36));        // the parked car
    CHECK_FALSE(read.obstacle_at(8.57, -3.45));  // the person walks away
  }
  std::ofstream(dir / "truth.json") << "{\"start_time_s\": 1}";
  CHECK_THROWS_AS(read_truth(dir.string()), BadInput);
  std::filesystem::remove_all(dir);
  CHECK_THROWS_AS(read_truth(dir.string()), BadInput);
}

TEST_CASE("truth: a cambered road is one region, as high in the robot's frame as in the scene, and as it was written") {
  const Scene scene = scene_of(cambered);
  const Truth truth = make_truth(in_map_frame(scene), 0);
  const TemporaryPath temporary("camber");
  std::filesystem::create_directories(temporary.path);
  {
    std::ofstream out(temporary.path / "truth.json");
    write_truth(out, truth);
  }
  const Truth read = read_truth(temporary.path.string());
  CHECK(read.planes.size() == 1);
  const double c = std::sqrt(0.5), standing_m = truth.terrain_height(0, 0);
  const SurfacePlane& road = scene.regions[0].plane;
  for (double x = -3; x < 3; x += 0.7) {
    const double y = 0.4 * x + 1;
    const Point2 p{2 + c * x - c * y, c * x + c * y};
    CHECK(truth.terrain_height(x, y) - standing_m == Approx(road.height_m(p) - road.height_m({2, 0})).margin(1e-9));
    CHECK(read.terrain_height(x, y) == Approx(truth.terrain_height(x, y)).margin(1e-12));
  }
}

TEST_CASE("truth: in regions.gt the first polygon that holds a point is its region") {
  const Truth truth = make_truth(scene_of(bump), 0);
  const std::vector<Polygon> drawn = drawn_regions(truth);
  REQUIRE(drawn.size() == 2);
  CHECK(drawn[0][0].x == 2);
  CHECK(drawn[1][0].x == -10);
}

TEST_CASE(
    "motion: the robot drives the legs at its speed, turns between them and goes up a curb one axle after the other") {
  const Scene scene = scene_of(bump + "[robot]\npath = [[0, 0], [3, 0], [3, 5]]\nspeed = 0.5\nturn_rate_deg_s = 45\n");
  const RobotMotion motion(scene);
  CHECK(motion.duration_s() == Approx(6 + 2 + 10).margin(0.03));
  CHECK(motion.T_map_base(2).translation().x() == Approx(1));
  CHECK(motion.T_map_base(2.001).translation().x() == Approx(1.0005));
  const auto z_m = [&](double time_s) { return motion.T_map_base(time_s).translation().z(); };
  CHECK(z_m(3.18) == Approx(0).margin(1e-9));  // 0.41 m before the bump: the wheels reach 0.4 m ahead
  CHECK(z_m(3.5) == Approx(0.06));             // the front wheels are on it
  CHECK(z_m(4.18) == Approx(0.06));
  CHECK(z_m(4.5) == Approx(0.12));
  CHECK(motion.T_map_base(7).linear().col(0).y() == Approx(std::sqrt(0.5)).margin(0.01));
  CHECK(motion.T_map_base(100).translation().y() == Approx(5));
  CHECK(motion.T_map_base(4).linear().col(2).z() == Approx(1));  // level
}

TEST_CASE("motion: a wheel rolls up a curb as its rim does over the edge, and the base leans") {
  const RobotMotion motion(scene_of(bump + "[robot]\npath = [[0, 0], [3, 0]]\nspeed = 0.5\nattitude = 'terrain'\n"));
  for (double to_edge_m = 0.16; to_edge_m >= 0; to_edge_m -= 0.005) {
    const Eigen::Isometry3d T = motion.T_map_base((2 - 0.25 - to_edge_m) / 0.5);
    const double inside = std::max(0.0, 0.15 * 0.15 - to_edge_m * to_edge_m);
    const double wheel_m = std::max(0.0, 0.12 - 0.15 + std::sqrt(inside));  // radius 0.15 m, curb 12 cm high
    INFO(to_edge_m);
    CHECK(T.translation().z() == Approx(wheel_m / 2).margin(0.012));  // the ground is sampled every cm
    CHECK(T.linear()(2, 0) == Approx(wheel_m / 0.5).margin(0.05));
  }
}

TEST_CASE("scene: a street that a robot drives through is the one where it stands, but for what is in its way") {
  for (const std::string seed : {"1", "9", "44"}) {
    const Scene stands = find_scene("random:" + seed), drives = find_scene("random-drive:" + seed);
    REQUIRE(drives.regions.size() == stands.regions.size());
    for (std::size_t r = 0; r < stands.regions.size(); ++r)
      CHECK(drives.regions[r].plane.z0_m == stands.regions[r].plane.z0_m);
    CHECK(drives.path.follows_terrain);
    CHECK(drives.path.waypoints.back().x - drives.path.waypoints.front().x == 6);
    for (const Obstacle& obstacle : drives.obstacles) {
      for (const Point2 p : obstacle.outline) CHECK(std::hypot(p.x - std::clamp(p.x, -3.0, 3.0), p.y) > 0.85);
    }
  }
}

TEST_CASE("motion: with the attitude of the terrain the base leans as the ground does") {
  const RobotMotion motion(
      scene_of("[ground]\nz = 0\nslope = [0.1, 0.05]\n[robot]\npath = [[0, 0], [3, 0]]\nattitude = 'terrain'\n"));
  const Eigen::Vector3d up = motion.T_map_base(1).linear().col(2);
  CHECK((up - Eigen::Vector3d(-0.1, -0.05, 1).normalized()).norm() < 0.001);
}
