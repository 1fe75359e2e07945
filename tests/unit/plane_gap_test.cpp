// Where within its cells an edge lies.
#include "curbline/borders/plane_gap.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "support/terrain.hpp"

namespace curbline {
namespace {

/// A near plane from 0 to `from` and a far one from `to` on, 1 apart, with equal densities of points, and `face` times
/// that density on the slope between. cell(k) is what the cell from k to k + 1 contains of them.
struct Ground {
  double from, to, face;

  /// Sum over four cells of the slope that they show.
  double sloped_cells() const {
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      const double mean = static_cast<double>(cell(k).far_share);
      double squares = 0;
      constexpr int places = 1000;
      for (int n = 0; n < places; ++n) {
        const double height = std::clamp((k + (n + 0.5) / places - from) / (to - from), 0.0, 1.0);
        squares += (height - mean) * (height - mean);
      }
      sum += static_cast<double>(curbline::sloped_cells(cell(k).far_share, static_cast<float>(squares / places)));
    }
    return sum;
  }
  bool seen(int k) const { return face > 0 || from > k || to < k + 1; }
  CrossedCell cell(int k) const {
    double points = 0, heights = 0, places = 0;
    const auto add = [&](double first, double last, double density, auto&& height) {
      const double a = std::clamp(first - k, 0.0, 1.0), b = std::clamp(last - k, 0.0, 1.0), number = density * (b - a);
      points += number;
      heights += number * height(k + (a + b) / 2);
      places += number * (a + b) / 2;
    };
    add(0, from, 1, [](double) { return 0.0; });
    if (face > 0) add(from, to, face, [&](double x) { return (x - from) / (to - from); });
    add(to, 9, 1, [](double) { return 1.0; });
    return {static_cast<float>(heights / points), static_cast<float>(places / points)};
  }
  /// Sum over three cells.
  double middle() const {
    double before = 0;
    for (int k = 0; k < 3; ++k) before += seen(k) ? before_middle(cell(k)) : 0.5;
    return before;
  }
};

TEST_CASE("plane gap: a sloped face that is seen as the planes are is told by its middle, wherever cells part it") {
  for (const double from : {0.2, 0.5, 0.8, 1.0}) {
    for (const double width : {0.1, 0.5, 1.0, 1.6})
      CHECK((Ground{from, from + width, 1}.middle()) == Approx(from + width / 2).margin(1e-5));
  }
}

TEST_CASE("plane gap: half of what is hidden lies before the middle, within a cell or over several") {
  for (const double from : {0.2, 0.5, 0.8, 1.0}) {
    for (const double shadow : {0.0, 0.3, 0.7, 1.0, 1.6})
      CHECK((Ground{from, from + shadow, 0}.middle()) == Approx(from + shadow / 2).margin(1e-5));
  }
}

TEST_CASE("plane gap: a few readings in what is hidden, a mixture of both sides, do not move its middle") {
  double sum = 0;
  constexpr int phases = 50;
  for (int k = 0; k < phases; ++k) {
    const double from = 0.2 + k / static_cast<double>(phases);
    sum += Ground{from, from + 1.0, 0.15}.middle() - from - 0.5;
  }
  CHECK(sum / phases == Approx(0.0).margin(0.01));
}

TEST_CASE("plane gap: a vertical face stands where it does in a cell, however many points it shows") {
  for (const double edge : {0.05, 0.3, 0.5, 0.8}) {
    for (const double face : {0.5, 3.0}) {
      const double points = 1 + face;  // of a cell, on the ground and the face
      const double share = (1 - edge + face / 2) / points, centroid = (0.5 + face * edge) / points;
      CHECK(before_middle({static_cast<float>(share), static_cast<float>(centroid)}) == Approx(edge).margin(1e-5));
    }
  }
}

TEST_CASE("plane gap: cells of few points have no bias, those wholly on a plane or parted by an edge") {
  test::Noise noise;
  constexpr int draws = 40000;
  for (const double edge : {0.0, 0.3, 0.5, 1.0}) {
    for (int points = 1; points <= 6; ++points) {
      double sum = 0;
      for (int draw = 0; draw < draws; ++draw) {
        float far = 0, place = 0;
        for (int k = 0; k < points; ++k) {
          const double x = noise.uniform();
          far += x > edge ? 1.0f : 0.0f;
          place += static_cast<float>(x);
        }
        sum +=
            static_cast<double>(before_middle({far / static_cast<float>(points), place / static_cast<float>(points)}));
      }
      CHECK(sum / draws == Approx(edge).margin(0.007));  // four standard errors
    }
  }
}

TEST_CASE("plane gap: its cells show how long the slope from plane to plane is, wherever they part it") {
  for (const double from : {0.2, 0.5, 0.8, 1.0}) {
    for (const double length : {0.01, 0.5, 1.0, 1.6, 2.5})
      CHECK((Ground{from, from + length, 1}.sloped_cells()) == Approx(length).margin(0.01));
  }
}

TEST_CASE("plane gap: a vertical edge is no slope, and its face counts as the readings that it has") {
  CHECK(sloped_cells(0.3f, 0.3f * 0.7f) == Approx(0.0f).margin(1e-6));
  CHECK(sloped_cells(0.5f, 1.0f / 12) == Approx(1.0f));            // face alone
  CHECK(sloped_cells(0.25f, 0.5f / 3 - 0.0625f) == Approx(0.5f));  // one half of the readings before its foot
  CHECK(sloped_cells(0.5f, 2.0f) == 0.0f);                         // a post
}

TEST_CASE("plane gap: heights beyond the planes are no part of the step") {
  CHECK(before_middle({-0.3f, 0.5f}) == Approx(1.0));
  CHECK(before_middle({1.3f, 0.5f}) == Approx(0.0));
}

}  // namespace
}  // namespace curbline
