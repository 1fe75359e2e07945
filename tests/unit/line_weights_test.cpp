// What planes owe to scan lines, against fits of planes in which one line after the other errs.
#include "curbline/curbs/line_weights.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace curbline {
namespace {

constexpr double pitch_m = 0.1;

/// A plane fitted to cells of these rows, from first_row on, five of them in each, across the way ahead.
struct Rows {
  int first_row, rows;
  double ahead_rad;

  SinCos ahead() const { return {static_cast<float>(std::sin(ahead_rad)), static_cast<float>(std::cos(ahead_rad))}; }
  /// The row `off` alone errs, by a metre; none if it is not the plane's.
  Plane fit(int off) const {
    PlaneMoments moments;
    for (int row = first_row; row < first_row + rows; ++row) {
      for (int column = 0; column < 5; ++column) {
        const double ahead_m = pitch_m * row, aside_m = pitch_m * column;
        PlaneMoments cell;
        cell.cells = cell.points = cell.weight = 1.0f;
        cell.x = static_cast<float>(ahead_m * std::cos(ahead_rad) - aside_m * std::sin(ahead_rad));
        cell.y = static_cast<float>(ahead_m * std::sin(ahead_rad) + aside_m * std::cos(ahead_rad));
        cell.z = row == off ? 1.0f : 0.0f;
        moments.add_cell(cell);
      }
    }
    PlanePrior prior;
    prior.noise_m2 = 1e-10f;  // so that the prior of slopes does nothing
    return fit_plane_to_means(moments, prior, 1e-10f);
  }
  LineWeights weights(float x_m, float y_m) const { return {fit(-1), ahead(), static_cast<float>(pitch_m), x_m, y_m}; }
};

/// Covariance of both heights there, if each row errs on its own with a variance of 1.
double covariance(const Rows& one, const Rows& other, float x_m, float y_m) {
  double sum = 0.0;
  for (int row = 0; row < 40; ++row)
    sum +=
        static_cast<double>(one.fit(row).height_m(x_m, y_m)) * static_cast<double>(other.fit(row).height_m(x_m, y_m));
  return sum;
}

TEST_CASE("line weights: a plane's height errs by its scan lines as its fit does when each line errs on its own") {
  const double ahead_rad = GENERATE(0.0, 0.7, -2.0);
  const Rows rows{3, GENERATE(1, 2, 8, 30), ahead_rad};
  for (const double ahead_m : {0.3, 0.8, 2.0}) {
    const auto x_m = static_cast<float>(ahead_m * std::cos(ahead_rad));
    const auto y_m = static_cast<float>(ahead_m * std::sin(ahead_rad));
    INFO(rows.rows << " rows, ahead " << ahead_rad << ", at " << ahead_m);
    const LineWeights weights = rows.weights(x_m, y_m);
    const auto times = static_cast<double>(weights.times(weights));
    if (rows.rows == 1) {
      CHECK(times > 0.99);  // where the fit leaves the slope to the prior, at least as much as one line
    } else {
      CHECK(times == Approx(covariance(rows, rows, x_m, y_m)).epsilon(rows.rows == 2 ? 0.5 : 0.05));
    }
  }
}

TEST_CASE("line weights: two planes err alike by the lines that have seen both, and by no others") {
  const double ahead_rad = 0.7;
  const auto x_m = static_cast<float>(1.5 * std::cos(ahead_rad)), y_m = static_cast<float>(1.5 * std::sin(ahead_rad));
  const Rows near{0, 20, ahead_rad}, far{20, 20, ahead_rad}, both{10, 20, ahead_rad};
  CHECK(near.weights(x_m, y_m).times(far.weights(x_m, y_m)) == Approx(0.0f).margin(1e-4));
  for (const Rows& other : {near, far, both}) {
    const float times = both.weights(x_m, y_m).times(other.weights(x_m, y_m));
    CHECK(static_cast<double>(times) == Approx(covariance(both, other, x_m, y_m)).margin(0.003));
  }
}

}  // namespace
}  // namespace curbline
