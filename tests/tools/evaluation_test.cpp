// Scores of labels, planes and curbs on cases that can be checked by hand.
#include <catch2/catch.hpp>
#include <cmath>

#include "evaluation/curbs.hpp"
#include "evaluation/labels.hpp"

namespace curbline::tools {
namespace {

using Labels = std::vector<int>;
const auto everywhere = [](double, double) { return true; };

MapCurb piece(double x0, double y0, double x1, double y1, double height_m = 0.1) {
  return {x0, y0, x1, y1, height_m, 0.01, 1, "step_up"};
}

TEST_CASE("v-measure: labels may bear any names") {
  CHECK(v_measure(Labels{1, 1, 2, 2, 7}, Labels{40, 40, -1, -1, 0}) == Approx(1));
}

TEST_CASE("v-measure: labels that know nothing of the truth score 0") {
  CHECK(v_measure(Labels{0, 0, 1, 1}, Labels{0, 1, 0, 1}) == Approx(0).margin(1e-12));
}

TEST_CASE("v-measure: one label for everything scores 0, and 1 if that is the truth") {
  CHECK(v_measure(Labels{0, 0, 1, 1}, Labels{5, 5, 5, 5}) == Approx(0).margin(1e-12));
  CHECK(v_measure(Labels{3, 3, 3}, Labels{5, 5, 5}) == Approx(1));
}

TEST_CASE("v-measure: every thing a label of its own is homogeneous but only half complete") {
  // h = 1, c = 1 - (ln 4 - ln 2) / ln 4 = 1/2
  CHECK(v_measure(Labels{0, 0, 1, 1}, Labels{0, 1, 2, 3}) == Approx(2.0 / 3));
}

TEST_CASE("v-measure: one stray of six costs what the entropies say") {
  const double third = -(1.0 / 3) * std::log(1.0 / 3) - (2.0 / 3) * std::log(2.0 / 3);  // entropy of the labels
  const double joint = -0.5 * std::log(0.5) - (1.0 / 6) * std::log(1.0 / 6) - (1.0 / 3) * std::log(1.0 / 3);
  const double h = 1 - (joint - third) / std::log(2.0), c = 1 - (joint - std::log(2.0)) / third;
  CHECK(v_measure(Labels{0, 0, 0, 1, 1, 1}, Labels{0, 0, 0, 0, 1, 1}) == Approx(2 * h * c / (h + c)));
}

TEST_CASE("v-measure: nothing scores 0") {
  CHECK(v_measure(Labels{}, Labels{}) == 0);
}

TEST_CASE("regions of cells: a cell belongs by its centre, to the first region that holds it") {
  const Grid grid{0, 0, 1, 1, 3, 1};
  const Polygon wide{{0, 0}, {1.6, 0}, {1.6, 1}, {0, 1}}, left{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  CHECK(regions_of_cells(grid, std::vector{wide, left}) == Labels{0, 0, -1});
  CHECK(regions_of_cells(grid, std::vector{left, wide}) == Labels{0, 1, -1});
}

/// Cells in a row along x, with the planes of label 0 (z = 0) and label 1 (z = 1 + 0.5 x).
Map row_of(const std::vector<MapCell>& cells) {
  Map map;
  map.grid = {0, 0, 1, 1, static_cast<int>(cells.size()), 1};
  map.cells = cells;
  map.planes = {{0, 0, 0, 0.01, 0}, {1, 0.5, 0, 0.01, 1}};
  return map;
}

MapCell cell(double x_m, double height_m, int label) {
  return {x_m, 0.5, height_m, 1e-4, 5, label, 1};
}

TEST_CASE("v-measure of a map: cells that are invalid or in no region do not count") {
  std::vector<MapCell> cells{cell(0.5, 0, 0), cell(1.5, 0, 0), cell(2.5, 0, 1), cell(3.5, 0, 0), MapCell{}};
  CHECK(v_measure(row_of(cells), Labels{0, 0, 1, -1, 1}) == Approx(1));
}

TEST_CASE("v-measure of a map: a cell without a label counts as one label of its own") {
  std::vector<MapCell> cells{cell(0.5, 0, 0), cell(1.5, 0, 0), cell(2.5, 0, -1), cell(3.5, 0, -1)};
  CHECK(v_measure(row_of(cells), Labels{0, 0, 1, 1}) == Approx(1));
  CHECK(v_measure(row_of(cells), Labels{0, 0, 0, 0}) < 0.01);
}

TEST_CASE("prediction: the other map's heights are compared with the planes of this one's labels") {
  const Map trained = row_of({cell(0.5, 0, 0), cell(1.5, 1.75, 1)});
  const Map other = row_of({cell(0.5, 0.03, 1), cell(1.6, 1.84, 0)});  // 3 cm off; 1 + 0.5 * 1.6 = 1.80, 4 cm off
  CHECK(prediction_rmse(trained, other) == Approx(std::sqrt((0.03 * 0.03 + 0.04 * 0.04) / 2)));
}

TEST_CASE("prediction: a cell of a surface of several planes is compared with its own plane") {
  Map trained = row_of({cell(0.5, 0, 0), cell(1.5, 1.75, 0)});
  trained.cells[1].plane = 1;
  const Map other = row_of({cell(0.5, 0.03, 0), cell(1.6, 1.84, 0)});
  CHECK(prediction_rmse(trained, other) == Approx(std::sqrt((0.03 * 0.03 + 0.04 * 0.04) / 2)));
}

TEST_CASE("prediction: cells that are invalid in either map, or whose label has no plane, do not count") {
  const Map trained = row_of({cell(0.5, 0, 0), MapCell{}, cell(2.5, 0, 0), cell(3.5, 0, 9), cell(4.5, 0, -1)});
  const Map other = row_of({cell(0.5, 0.02, 0), cell(1.5, 5, 0), MapCell{}, cell(3.5, 5, 0), cell(4.5, 5, 0)});
  CHECK(prediction_rmse(trained, other) == Approx(0.02));
}

TEST_CASE("prediction: no common cell is no number") {
  CHECK(std::isnan(prediction_rmse(row_of({cell(0.5, 0, 0), MapCell{}}), row_of({MapCell{}, cell(1.5, 0, 0)}))));
}

TEST_CASE("distance: to a segment's inside, to its ends, and to one of no length") {
  CHECK(distance_m(1, 2, {0, 0, 4, 0}) == Approx(2));
  CHECK(distance_m(-3, 4, {0, 0, 4, 0}) == Approx(5));
  CHECK(distance_m(7, 4, {0, 0, 4, 0}) == Approx(5));
  CHECK(distance_m(3, 4, {0, 0, 0, 0}) == Approx(5));
}

TEST_CASE("curb rates: half of a curb found is precise, and recalled as far as the tolerance reaches") {
  const std::vector<MapCurb> found{piece(0, 0, 1, 0)};
  const std::vector<Segment> truth{{0, 0, 2, 0}};
  const Rates rates = curb_rates(found, truth, 0.1, everywhere);
  CHECK(rates.precision == Approx(1));
  CHECK(rates.recall == Approx(22.0 / 40));  // samples every 5 cm, the last at 1.075 m
  CHECK(rates.f1 == Approx(2 * 1 * 0.55 / 1.55));
}

TEST_CASE("curb rates: a piece beside the curb counts up to the tolerance") {
  const std::vector<Segment> truth{{0, 0, 2, 0}};
  CHECK(curb_rates(std::vector{piece(0, 0.09, 2, 0.09)}, truth, 0.1, everywhere).f1 == Approx(1));
  CHECK(curb_rates(std::vector{piece(0, 0.11, 2, 0.11)}, truth, 0.1, everywhere).f1 == 0);
}

TEST_CASE("curb rates: long pieces weigh more than short ones") {
  const std::vector<MapCurb> found{piece(0, 0, 1.5, 0), piece(0, 1, 0.5, 1)};
  CHECK(curb_rates(found, std::vector<Segment>{{0, 0, 1.5, 0}}, 0.1, everywhere).precision == Approx(0.75));
}

TEST_CASE("curb rates: only samples that count are asked for") {
  const std::vector<MapCurb> found{piece(0, 0, 1, 0), piece(3, 5, 4, 5)};
  const Rates rates =
      curb_rates(found, std::vector<Segment>{{0, 0, 2, 0}}, 0.1, [](double x, double) { return x < 1; });
  CHECK(rates.precision == Approx(1));
  CHECK(rates.recall == Approx(1));
}

TEST_CASE("curb rates: nothing found or nothing to find scores 0") {
  const std::vector<Segment> truth{{0, 0, 2, 0}};
  CHECK(curb_rates({}, truth, 0.1, everywhere).f1 == 0);
  CHECK(curb_rates(std::vector{piece(0, 0, 1, 0)}, {}, 0.1, everywhere).f1 == 0);
}

}  // namespace
}  // namespace curbline::tools
