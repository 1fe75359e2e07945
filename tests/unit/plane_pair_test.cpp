// The planes on both sides of a border: from which height on they meet at a step, and where at the edge of a ramp.
#include "curbline/curbs/plane_pair.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace curbline {
namespace {

/// Two planes that lean, at a border whose normal is at an angle to x.
struct Meeting {
  double first_lean = 0.0, second_lean = 0.0;  ///< across the border
  double first_fit_m2 = 1e-6, second_fit_m2 = 1e-6;

  CurbKind kind(double angle, const MeasuredStep& step) const {
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    const auto leaning = [&](double lean, double fit_m2) {
      Plane plane;
      plane.slope_x = static_cast<float>(lean) * c;
      plane.slope_y = static_cast<float>(lean) * s;
      plane.fit_variance_m2 = static_cast<float>(fit_m2);
      return plane;
    };
    const Plane first = leaning(first_lean, first_fit_m2), second = leaning(second_lean, second_fit_m2);
    return PlanePair{first, second}.kind({0.0f, 0.0f, 1.0f, 1.0f, c, s}, step);
  }
  /// The height, up or down, from which it is a step.
  double least_step_m(double angle, MeasuredStep step) const {
    for (int mm10 = 1; mm10 < 2000; ++mm10) {
      step.height_m = static_cast<float>(mm10) * 1e-4f;
      const bool up = kind(angle, step) == CurbKind::step_up;
      step.height_m = -step.height_m;
      CHECK((kind(angle, step) == CurbKind::step_up) == up);
      if (up) return mm10 * 1e-4;
    }
    return 1.0;
  }
};

TEST_CASE("plane pair: a step exceeds two deviations of its height, of its cells and of its position") {
  const double angle = GENERATE(0.0, 0.8, 1.5708, 2.6, -1.5708);
  const float half_gap_m = 0.05f;
  const auto about = [](double m) { return Approx(m).margin(1.5e-4); };
  CHECK(Meeting{}.least_step_m(angle, {0.0f, 0.0f, half_gap_m, 0.0f, 2.5e-5f}) == about(0.01));  // texture of 5 mm
  CHECK(Meeting{}.least_step_m(angle, {0.0f, 0.004f, half_gap_m, 0.0f, 9e-6f}) == about(0.01));
  // The cells' errors exceed the texture: the mean of both sides' variances counts.
  CHECK((Meeting{.first_fit_m2 = 1e-5, .second_fit_m2 = 4e-5}.least_step_m(
            angle, {0.0f, 0.0f, half_gap_m, 0.0f, 1e-6f})) == about(0.01));
  // Slopes differ by 1 in 5, and the position is known to 2 cm.
  const MeasuredStep step{0.0f, 0.0f, half_gap_m, 4e-4f, 9e-6f};
  CHECK((Meeting{.first_lean = 0.1, .second_lean = -0.1}.least_step_m(angle, step)) == about(0.01));
  CHECK((Meeting{.first_lean = -0.1, .second_lean = 0.1}.least_step_m(angle, step)) == about(0.01));
  CHECK((Meeting{.first_lean = 0.1, .second_lean = 0.1}.least_step_m(angle, step)) == about(0.006));
}

TEST_CASE("plane pair: a face, steeper than ground, begins anywhere in half a gap, but a ramp does not") {
  const MeasuredStep step{0.0f, 0.0f, 0.05f, 0.0f, 9e-6f};
  const auto about = [](double m) { return Approx(m).margin(1.5e-4); };
  CHECK((Meeting{.second_lean = 0.4}.least_step_m(0.3, step)) == about(0.4 * 0.05 + 0.006));
  CHECK((Meeting{.first_lean = -0.4}.least_step_m(0.3, step)) == about(0.4 * 0.05 + 0.006));
  CHECK((Meeting{.second_lean = 0.35}.least_step_m(0.3, step)) == about(0.006));
}

TEST_CASE(
    "plane pair: planes that meet part at the edge of a ramp if one alone leans by more than 1 in 20, else at "
    "a crease") {
  const double angle = GENERATE(0.0, 0.8, 1.5708, 2.6, -1.5708);
  const MeasuredStep step{0.0f, 0.0f, 0.05f, 0.0f, 9e-6f};
  for (const double sign : {-1.0, 1.0}) {
    CHECK((Meeting{.second_lean = sign * 0.053}.kind(angle, step)) == CurbKind::ramp_edge);
    CHECK((Meeting{.first_lean = sign * 0.053}.kind(angle, step)) == CurbKind::ramp_edge);
    CHECK((Meeting{.second_lean = sign * 0.047}.kind(angle, step)) == CurbKind::crease);
    CHECK((Meeting{.first_lean = sign * 0.06, .second_lean = sign * 0.1}.kind(angle, step)) == CurbKind::crease);
    CHECK((Meeting{.first_lean = sign * 0.06, .second_lean = -sign * 0.1}.kind(angle, step)) == CurbKind::crease);
  }
}

}  // namespace
}  // namespace curbline
