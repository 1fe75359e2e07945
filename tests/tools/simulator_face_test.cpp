// Faces of steps that lean, in the truth about a scene.
#include "simulator/truth.hpp"
#include "tools/simulator_support.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

using namespace curbline::tools;

namespace {

double length_m(const TruthCurb& curb) {
  return std::hypot(curb.to.x - curb.from.x, curb.to.y - curb.from.y);
}

}  // namespace

//               ______ 12 cm
//              /          8 cm wide; or upright for 2 cm and 5 cm wide above
//  ___________/
TEST_CASE("truth: the face of a splayed or battered curb is one step, along its middle, and no ground") {
  const auto [face, middle_m] =
      GENERATE(std::pair{"rectangle = [1.92, -3, 2, 3]\ncorner_z = [0.0, 0.12, 0.12]\n", 1.96},
               std::pair{"rectangle = [1.95, -3, 2, 3]\ncorner_z = [0.02, 0.12, 0.12]\n", 1.975});
  const std::string pavement = "[[region]]\nrectangle = [2, -3, 6, 3]\nz = 0.12\n";
  const Truth truth = make_truth(scene_of("[ground]\nz = 0\n" + pavement + "[[region]]\n" + face), 0);
  REQUIRE(truth.curbs.size() == 4);
  for (const TruthCurb& curb : truth.curbs) CHECK(curb.kind == "step");
  const TruthCurb& along = truth.curbs.back();
  CHECK(along.from.x == Approx(middle_m));
  CHECK(along.to.x == Approx(middle_m));
  CHECK(length_m(along) == Approx(6));
  CHECK(along.height_m == Approx(0.12));
  CHECK((along.to.y > along.from.y ? along.left_z_m : along.right_z_m) == Approx(0).margin(1e-9));
  CHECK(truth.plane_at(middle_m, 0) == -1);
  CHECK(truth.plane_at(2.01, 0) >= 0);
  CHECK(truth.terrain_height(middle_m, 0) > 0.05);
}

TEST_CASE("truth: the face of a curb that climbs with its street is one step, too") {
  const Truth truth =
      make_truth(scene_of("[ground]\nz = 0\nslope = [0, 0.05]\n"
                          "[[region]]\nrectangle = [2, -12, 6, 12]\ncorner_z = [-0.48, -0.48, 0.72]\n"
                          "[[region]]\nrectangle = [1.92, -12, 2, 12]\ncorner_z = [-0.6, -0.48, 0.72]\n"),
                 0);
  CHECK(truth.plane_at(1.96, 0) == -1);
  CHECK(std::any_of(truth.curbs.begin(), truth.curbs.end(), [](const TruthCurb& c) {
    return c.kind == "step" && length_m(c) > 23 && std::abs(c.height_m - 0.12) < 1e-3;
  }));
}

TEST_CASE("truth: a face may be drawn wider than it is seen, and the road over it") {
  const Truth truth = make_truth(scene_of("[[region]]\nrectangle = [0, 0, 4, 4]\nz = 0.12\nslope = [0, 0.02]\n"
                                          "[[region]]\nrectangle = [0, 0, 2, 4]\ncorner_z = [-2.88, 0.12, 0.12]\n"
                                          "[[region]]\nrectangle = [0, 0, 1.92, 4]\nz = 0.0\n"),
                                 0);
  REQUIRE(truth.curbs.size() == 1);
  CHECK(truth.curbs[0].from.x == Approx(1.96));
  CHECK(truth.curbs[0].height_m == Approx(0.16));  // in the middle
  CHECK(std::max(std::abs(truth.curbs[0].from_step_m), std::abs(truth.curbs[0].to_step_m)) == Approx(0.2));
}

//    y 3 _______________
//       | |_____ 0.12         the pavement falls to a crossing, the road to a gutter
//       | |_____ 0.06
//      0|_|_____
TEST_CASE("truth: a step across a face is cut where the ground at its foot or its top changes") {
  const Truth truth = make_truth(scene_of("[ground]\nz = 0\n[[region]]\nrectangle = [-5, 2, 0, 9]\nz = -0.03\n"
                                          "[[region]]\nrectangle = [0, 0, 0.08, 3]\ncorner_z = [0.0, 0.12, 0.12]\n"
                                          "[[region]]\nrectangle = [0.08, 0, 4, 1]\nz = 0.06\n"
                                          "[[region]]\nrectangle = [0.08, 1, 4, 3]\nz = 0.12\n"),
                                 0);
  double lengths_m[3] = {0, 0, 0};
  for (const TruthCurb& curb : truth.curbs) {
    if (std::abs(curb.from.x - 0.04) > 1e-6 || std::abs(curb.to.x - 0.04) > 1e-6) continue;
    lengths_m[curb.height_m < 0.1 ? 0 : curb.height_m < 0.14 ? 1 : 2] += length_m(curb);
  }
  for (const double length : lengths_m) CHECK(length == Approx(1));
  for (const TruthCurb& curb : truth.curbs) CHECK(length_m(curb) > 0.01);
}

TEST_CASE("truth: a bank wider than a curb stone and a rolled curb of 1 in 3 are ground between creases") {
  const std::string wide =
      GENERATE("[1.69, -3, 2, 3]\ncorner_z = [0.0, 0.31, 0.31]\n", "[1.7, -3, 2, 3]\ncorner_z = [0.0, 0.1, 0.1]\n");
  const std::string top = wide.find("0.31") != std::string::npos ? "0.31" : "0.1";
  const Truth truth = make_truth(scene_of("[ground]\nz = 0\n[[region]]\nrectangle = [2, -3, 6, 3]\nz = " + top +
                                          "\n[[region]]\nrectangle = " + wide),
                                 0);
  CHECK(std::count_if(truth.curbs.begin(), truth.curbs.end(), [](const TruthCurb& c) { return c.kind == "crease"; }) ==
        2);
  CHECK(truth.plane_at(1.9, 0) >= 0);
}
