// Scores of labels, planes and curbs against the truth of a scene.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluation/scores.hpp"
#include "formats_support.hpp"

namespace curbline::tools {
namespace {

//           y
//    ______ 2 ______
//   | road  |  0.10 |   the step is at x = 2, all along y
//   |_______|_______|
//   0       2       4  x
Truth step_of(double height_m) {
  Truth truth;
  truth.planes = {{"road", {0, 0, 0}}, {"pavement", {height_m, 0, 0}}};
  truth.regions = {{"road", rectangle({0, -2}, {2, 2}), 0}, {"pavement", rectangle({2, -2}, {4, 2}), 1}};
  TruthCurb curb;
  curb.from = {2, -2};  // so that the road is to the left
  curb.to = {2, 2};
  curb.from_step_m = curb.to_step_m = -height_m;
  curb.kind = "step";
  truth.curbs = {curb};
  return truth;
}

std::vector<LabelledCell> cells_of(const Truth& truth, double last_x_m = 4) {
  std::vector<LabelledCell> cells;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const double x = 0.1 * i + 0.05, y = 0.1 * j - 1.95;
      if (x > last_x_m) continue;
      cells.push_back({x, y, {x, y, truth.terrain_height(x, y), 1e-4, 9, truth.plane_at(x, y), 1}});
    }
  }
  return cells;
}

Seen seen_in(const std::vector<LabelledCell>& cells) {
  Seen seen;
  for (const LabelledCell& cell : cells) seen.add(cell.x_m, cell.y_m);
  return seen;
}

MapCurb piece(double x_m, double y0_m, double y1_m, double height_m, const char* kind = "step_up") {
  return {x_m, y0_m, x_m, y1_m, height_m, 0.01, 1, kind};
}

const Truth truth = step_of(0.1);
const Seen everything = seen_in(cells_of(truth));

CurbScores scores_of(std::vector<MapCurb> curbs, const Truth& of = truth) {
  return score_curbs({{}, std::move(curbs), Point2{0, 0}}, of, everything);
}

TEST_CASE("scores: in JSON each has its own name") {
  CurbScores scores;
  for (std::size_t k = 0; k < scores.at.size(); ++k) {
    const double each = static_cast<double>(k);
    scores.at[k] = {0.05 + each, 0.10 + each, 0.15 + each, 0.20 + each};
  }
  scores.band = {BandRates{0.02, 0.04, 0.5, 0.6, 7, 8}, BandRates{0.04, 0.3, 0.7, 0.8, 9, 10}};
  scores.wrong_way = 0.01;
  scores.position_m = {0.011, 0.012};
  scores.height_m = {0.013, 0.014};
  scores.calibration = {21, 1.1, 0.71, 0.91};
  scores.position_calibration = {22, 1.2, 0.72, 0.92};
  const nlohmann::json bands = nlohmann::json::parse(R"([
    {"from_m": 0.02, "to_m": 0.04, "precision": 0.5, "recall": 0.6, "found_samples": 7, "true_samples": 8},
    {"from_m": 0.04, "to_m": 0.3, "precision": 0.7, "recall": 0.8, "found_samples": 9, "true_samples": 10}])");
  const nlohmann::json json = to_json(scores);
  CHECK(json.at("step_bands") == bands);
  REQUIRE(json.at("steps").size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    const StepRates& r = scores.at[k];
    const nlohmann::json rates{
        {"tolerance_m", r.tolerance_m}, {"precision", r.precision}, {"recall", r.recall}, {"f1", r.f1}};
    CHECK(json.at("steps")[k] == rates);
  }
  CHECK(json.at("wrong_way") == 0.01);
  CHECK(json.at("position_error_median_m") == 0.011);
  CHECK(json.at("position_error_95_m") == 0.012);
  CHECK(json.at("height_error_median_m") == 0.013);
  CHECK(json.at("height_error_95_m") == 0.014);
  const nlohmann::json heights{{"pieces", 21}, {"mean_square", 1.1}, {"within_1_sd", 0.71}, {"within_2_sd", 0.91}};
  CHECK(json.at("calibration") == heights);
  const nlohmann::json places{{"pieces", 22}, {"mean_square", 1.2}, {"within_1_sd", 0.72}, {"within_2_sd", 0.92}};
  CHECK(json.at("position_calibration") == places);
}

}  // namespace

TEST_CASE("seen: within a cell of a valid one, across 0 too") {
  Seen seen;
  seen.add(-0.05, 0.05);
  CHECK(seen(0.05, 0.05));
  CHECK(seen(-0.15, 0.15));
  CHECK_FALSE(seen(0.15, 0.05));
}

TEST_CASE("scores: perfect labels and curbs score 1 without error") {
  const PlaneScores planes = score_planes({{cells_of(truth)}, {}, {}}, truth);
  CHECK(planes.v == Approx(1));
  CHECK(planes.cell_rmse_m == Approx(0).margin(1e-9));
  CHECK(planes.plane_rmse_m == Approx(0).margin(1e-9));
  CHECK(planes.slope_rad.most == Approx(0).margin(1e-6));
  const CurbScores curbs = scores_of({piece(2, -2, 2, 0.1)});
  for (const StepRates& rates : curbs.at) CHECK(rates.f1 == Approx(1));
  CHECK(curbs.height_m.most == Approx(0).margin(1e-9));
  CHECK(curbs.position_m.most == Approx(0).margin(1e-9));
}

TEST_CASE("scores: a step counts from 1 cm on, and in the bands of 2 to 4 cm, and of 4 cm and more") {
  struct Expected {
    double height_m;
    bool counts, low, high;
  };
  for (const auto& [height_m, counts, low, high] : {Expected{0.009, false, false, false},
                                                    {0.011, true, false, false},
                                                    {0.019, true, false, false},
                                                    {0.021, true, true, false},
                                                    {0.039, true, true, false},
                                                    {0.041, true, false, true},
                                                    {0.3, true, false, true}}) {
    INFO(height_m);
    const CurbScores curbs = scores_of({piece(2, -2, 2, height_m)}, step_of(height_m));
    CHECK((curbs.at[0].recall == 1) == counts);
    for (const auto& [band, in] : {std::pair{curbs.band[0], low}, {curbs.band[1], high}}) {
      CHECK((band.truth > 0) == in);
      CHECK((band.found > 0) == in);
    }
  }
}

TEST_CASE("scores: errors are told as their median and the one that 95 of 100 do not exceed") {
  std::vector<double> errors;
  for (int i = 100; i >= 0; --i) errors.push_back(i);
  CHECK(errors_of(errors).median == 50);
  CHECK(errors_of(errors).most == 95);
  CHECK(std::isnan(errors_of({}).median));
}

TEST_CASE("scores: a step up told for one down is an error of height, and none of its deviation") {
  const CurbScores curbs = scores_of({piece(2, -2, 2, -0.1)});
  CHECK(curbs.height_m.median == Approx(0.2));
  CHECK(curbs.calibration.pieces == 0);
  CHECK(scores_of({piece(2, -2, 2, 0.11)}).calibration.pieces == 1);
}

TEST_CASE("scores: cells of half the usual size are as many parts as the planes") {
  std::vector<LabelledCell> fine;
  for (LabelledCell cell : cells_of(truth)) {
    for (const double dx : {-0.025, 0.025}) {
      for (const double dy : {-0.025, 0.025}) {
        fine.push_back(cell);
        fine.back().x_m += dx;
        fine.back().y_m += dy;
      }
    }
  }
  CHECK(score_planes({{fine}, {}, {}}, truth).v == Approx(1));
}

TEST_CASE("scores: a shadow across a road that is labelled as one plane leaves it one, and V 1") {
  std::vector<LabelledCell> cells = cells_of(truth);
  std::erase_if(cells, [](const LabelledCell& c) { return c.x_m < 2 && c.y_m > 0 && c.y_m < 0.3; });
  CHECK(score_planes({{cells}, {}, {}}, truth).v == Approx(1));
}

TEST_CASE("scores: ground goes on below what stands on it, but what stands there is not scored") {
  Truth with_wall = truth;
  with_wall.obstacles = {{"wall", rectangle({0, 0}, {2, 0.3})}};
  std::vector<LabelledCell> cells = cells_of(truth);
  for (LabelledCell& cell : cells) {
    if (with_wall.obstacle_at(cell.x_m, cell.y_m)) cell.cell.label = 7;
  }
  CHECK(score_planes({{cells}, {}, {}}, with_wall).v == Approx(1));
}

TEST_CASE("scores: two pavements of one height on either side of a road are two") {
  Truth road = step_of(0.1);
  road.regions = {{"pavement", rectangle({0, -2}, {4, 2}), 1}, {"road", rectangle({1, -2}, {3, 2}), 0}};
  std::vector<LabelledCell> cells = cells_of(road);
  CHECK(score_planes({{cells}, {}, {}}, road).v < 0.9);
  for (LabelledCell& cell : cells) cell.cell.label += cell.x_m > 3;
  CHECK(score_planes({{cells}, {}, {}}, road).v == Approx(1));
}

TEST_CASE("scores: lawns of one height on either side of an edging narrower than a cell are two") {
  Truth edged = step_of(0.1);
  const Polygon edging{{1.90, -2}, {1.98, -2}, {2.28, 2}, {2.20, 2}};  // across the columns of cells
  edged.regions = {{"lawn", rectangle({0, -2}, {4, 2}), 0}, {"edging", edging, 1}};
  std::vector<LabelledCell> cells = cells_of(edged);
  for (LabelledCell& cell : cells) {
    if (cell.cell.label == 0 && cell.x_m > 1.94 + 0.075 * (cell.y_m + 2)) cell.cell.label = 2;
  }
  CHECK(score_planes({{cells}, {}, {}}, edged).v == Approx(1));
}

TEST_CASE("scores: what lies on the face of a step is no ground") {
  Truth splayed = step_of(0.1);
  splayed.planes.push_back({"face", {-1.9, 1, 0}});
  splayed.regions.push_back({"face", rectangle({1.9, -2}, {2, 2}), 2, true});
  std::vector<LabelledCell> cells = cells_of(splayed);
  for (LabelledCell& cell : cells) {
    if (splayed.plane_at(cell.x_m, cell.y_m) < 0) cell.cell.label = static_cast<int>(10 * cell.y_m) + 30;
  }
  const PlaneScores scores = score_planes({{cells}, {}, {}}, splayed);
  CHECK(scores.v == Approx(1));
  CHECK(scores.plane_rmse_m == Approx(0).margin(1e-9));
}

TEST_CASE("scores: labels so far apart that no window holds them are refused with the line of one") {
  std::vector<LabelledCell> cells = cells_of(truth);
  cells[2].y_m = 1e300;
  CHECK(testing::error_of([&] {
          score_planes({{cells}, {}, {}}, truth);
        }) == "labels.csv:4: y_m lies too far from that of the other rows; expected rows of one window");
}

TEST_CASE("scores: a window with one true plane says nothing of V, and does not count") {
  const PlaneScores planes = score_planes({{cells_of(truth, 1.9), cells_of(truth)}, {}, {}}, truth);
  CHECK(planes.v == Approx(1));
  CHECK(std::isnan(score_planes({{cells_of(truth, 1.9)}, {}, {}}, truth).v));
}

TEST_CASE("scores: a method without labels has no V") {
  std::vector<LabelledCell> cells = cells_of(truth);
  for (LabelledCell& cell : cells) cell.cell.label = -1;
  const PlaneScores planes = score_planes({{cells}, {}, {}}, truth);
  CHECK(std::isnan(planes.v));
  CHECK(std::isnan(planes.plane_rmse_m));
  CHECK(planes.cell_rmse_m == Approx(0).margin(1e-9));
}

TEST_CASE("scores: a plane that leans and lies too high has the errors that it has") {
  std::vector<LabelledCell> cells = cells_of(truth, 1.9);
  for (LabelledCell& cell : cells) cell.cell.height_m = 0.02 + 0.01 * (cell.x_m - 1.0);
  const PlaneScores planes = score_planes({{cells}, {}, {}}, truth);
  CHECK(planes.slope_rad.median == Approx(0.01).margin(1e-5));
  CHECK(planes.height_m.median == Approx(0.0195).margin(1e-6));  // the mean x of the cells is 0.95
}

TEST_CASE("scores: cells with points of both sides of a curb do not tilt the plane of their label") {
  std::vector<LabelledCell> cells = cells_of(truth, 1.9);
  for (LabelledCell& cell : cells) {
    if (cell.x_m > 1.8 && cell.y_m > 0) cell.cell.height_m += 0.04;
  }
  const PlaneScores planes = score_planes({{cells}, {}, {}}, truth);
  CHECK(planes.slope_rad.median == Approx(0).margin(1e-5));
  CHECK(planes.height_m.median == Approx(0).margin(1e-6));
}

TEST_CASE("scores: rates by tolerance follow the distance") {
  const CurbScores curbs = scores_of({piece(2.12, -2, 2, 0.1)});
  CHECK(curbs.at[0].precision == 0);
  CHECK(curbs.at[1].recall == 0);
  CHECK(curbs.at[2].f1 == Approx(1));
  CHECK(curbs.position_m.median == Approx(0.12));
}

TEST_CASE("scores: half a curb has half the recall, and a piece in the open half the precision") {
  const CurbScores curbs = scores_of({piece(2, -2, 0, 0.1), piece(1, -2, 0, 0.1)});
  CHECK(curbs.at[0].recall == Approx(0.5).margin(0.02));
  CHECK(curbs.at[0].precision == Approx(0.5));
}

TEST_CASE("scores: where nothing was found there is no precision, and no F1") {
  const StepRates rates = scores_of({}).at[1];
  CHECK(rates.recall == 0);
  CHECK(std::isnan(rates.precision));
  CHECK(std::isnan(rates.f1));
  CHECK(scores_of({piece(1, -2, 2, 0.1)}).at[1].f1 == 0);
}

TEST_CASE("scores: creases are no steps, found or true") {
  CHECK(scores_of({piece(2, -2, 2, 0.1, "crease")}).at[1].recall == 0);
  Truth ramp = truth;
  ramp.curbs[0].kind = "crease";
  const CurbScores curbs = scores_of({piece(2, -2, 2, 0.1)}, ramp);
  CHECK(curbs.at[1].precision == 0);
  CHECK(std::isnan(curbs.at[1].recall));
}

TEST_CASE("scores: a step that the robot sees from one side only cannot be missed") {
  const Seen near_side = seen_in(cells_of(truth, 2.05));
  const CurbScores curbs = score_curbs({{}, {}, Point2{0, 0}}, truth, near_side);
  CHECK(std::isnan(curbs.at[1].recall));
}

TEST_CASE("scores: steps belong to the band of their own height") {
  const CurbScores low = scores_of({piece(2, -2, 2, 0.03)}, step_of(0.03));
  CHECK(low.band[0].recall == Approx(1));
  CHECK(low.band[0].precision == Approx(1));
  CHECK(low.band[1].truth == 0);
  CHECK(std::isnan(low.band[1].recall));
}

TEST_CASE("scores: the upper band has no end, and a quay of 1.5 m belongs to it") {
  const CurbScores quay = scores_of({piece(2, -2, 2, 1.5)}, step_of(1.5));
  CHECK(quay.band[1].recall == Approx(1));
  CHECK(quay.band[1].precision == Approx(1));
}

TEST_CASE("scores: up told as down is an error of twice the height, and told apart from steps that are missed") {
  const CurbScores down = scores_of({piece(2, -2, 2, -0.1, "step_down")});
  CHECK(down.height_m.median == Approx(0.2));
  CHECK(down.wrong_way == 1);
  CHECK(down.band[1].recall == Approx(1));
  CHECK(scores_of({piece(2, -2, 1, 0.1), piece(2, 1, 2, -0.1)}).wrong_way == Approx(0.25));
  CHECK(std::isnan(scores_of({piece(3, -2, 2, -0.1)}).wrong_way));  // where no step is, there is no way
}

TEST_CASE("scores: of a robot that drives, the near side of a curb lies to the right of its line") {
  const auto driving = [](MapCurb curb) { return score_curbs({{}, {curb}, {}}, truth, everything); };
  CHECK(driving(piece(2, 2, -2, 0.1)).wrong_way == 0);
  CHECK(driving(piece(2, -2, 2, -0.1, "step_down")).wrong_way == 0);
  CHECK(driving(piece(2, 2, -2, -0.1, "step_down")).wrong_way == 1);
  CHECK(driving(piece(2, 2, -2, -0.1, "step_down")).height_m.median == Approx(0.2));
}

//   2 |  /      the true step goes on past the robot on its right, the piece found on its left
//     | /
//   0 |/
//     /  the robot at x = 1.97
//  -4
TEST_CASE("scores: the far side of a curb is that of its own line, though the true step turns the other to the robot") {
  MapCurb found = piece(2, 0, 2, -0.1, "step_down");
  found.x0_m = 1.98;
  found.x1_m = 2.02;
  CHECK(score_curbs({{}, {found}, Point2{1.97, -4}}, truth, everything).height_m.median == Approx(0).margin(1e-9));
}

TEST_CASE("scores: calibration is by each piece's own sd, and by length") {
  // 3 m deviate by half an sd, 1 m by one and a half
  const Calibration c = scores_of({piece(2, -2, 1, 0.105), piece(2, 1, 2, 0.085)}).calibration;
  CHECK(c.pieces == 2);
  CHECK(c.mean_square == Approx((3 * 0.25 + 2.25) / 4));
  CHECK(c.within_1_sd == Approx(0.75));
  CHECK(c.within_2_sd == Approx(1));
}

TEST_CASE("scores: positions are calibrated by the distance of each piece's middle") {
  MapCurb half = piece(2.01, -2, 1, 0.1), three_halves = piece(1.97, 1, 2, 0.1);
  half.position_sd_m = three_halves.position_sd_m = 0.02;
  const Calibration c = scores_of({half, three_halves, piece(2.05, -2, 2, 0.1)}).position_calibration;
  CHECK(c.pieces == 2);  // the third states no sd
  CHECK(c.mean_square == Approx((3 * 0.25 + 2.25) / 4));
}

TEST_CASE("scores: of a step that grows along the way what counts is how high it is beside a piece") {
  Truth growing = step_of(0.1);
  growing.curbs[0].from_step_m = 0.0;  // 5 cm in the middle
  const Calibration c = scores_of({piece(2, -0.01, 0.01, 0.05)}, growing).calibration;
  CHECK(c.mean_square == Approx(0).margin(1e-9));
  const Seen upper_half = seen_in([] {
    std::vector<LabelledCell> cells = cells_of(truth);
    std::erase_if(cells, [](const LabelledCell& cell) { return cell.y_m < 0; });
    return cells;
  }());
  CHECK(match_steps({{}, {}, {}}, growing, upper_half).at(0).step_m == Approx(0.075).margin(0.003));
}

TEST_CASE("scores: a curb's match is of what could be seen of it") {
  const Seen half = seen_in([] {
    std::vector<LabelledCell> cells = cells_of(truth);
    std::erase_if(cells, [](const LabelledCell& cell) { return cell.y_m > 0; });
    return cells;
  }());
  const auto matches = match_steps({{}, {piece(2.02, -2, -1, 0.09)}, {}}, truth, half);
  REQUIRE(matches.size() == 1);
  CHECK(matches[0].visible_m == Approx(2).margin(0.15));
  CHECK(matches[0].covered == Approx(0.5).margin(0.06));
  CHECK(matches[0].position_error_m == Approx(0.02));
  CHECK(matches[0].height_m == Approx(0.09));
}

TEST_CASE("detections: a step is seen when both sides are, found when it is told of, and only its first time counts") {
  Detections detections(truth);
  const Bounds window{0, -2, 4, 2};
  const std::vector<MapCurb> told{piece(2, -0.1, 0.1, 0.1)};
  detections.observe(1, {0, 0}, window, seen_in(cells_of(truth, 2.05)), {});
  CHECK_FALSE(detections.of_curbs()[0].seen_s);
  detections.observe(2, {0, 0}, window, everything, {});
  detections.observe(5, {0.5, 0}, window, everything, told);
  detections.observe(7, {1.5, 0}, window, everything, told);
  REQUIRE(detections.of_curbs()[0].found_s);
  CHECK(*detections.of_curbs()[0].seen_s == 2);
  CHECK(*detections.of_curbs()[0].found_s == 5);
  CHECK(detections.of_curbs()[0].distance_m == Approx(1.5).margin(0.02));
}

}  // namespace curbline::tools
