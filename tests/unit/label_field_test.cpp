// Beliefs against the Potts field enumerated in double precision, and the behaviour of the field over time: deferral,
// settling.
#include "curbline/labels/label_field.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "curbline/regions/link.hpp"
#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::fill;
using test::Noise;
using test::small_limits;
using test::small_settings;
using test::Stages;

/// A cell of a tiny map, by its position and height.
struct Site {
  int i, j;
  double height_m;
};

/// Three planes of 0, 8 and 4 cm, learned from the half of a map with y < 1.2 m. The sites form another map, with cells
/// in the other half only: no region is near them, so they may lie on any of the planes.
struct Tiny {
  explicit Tiny(const std::vector<Site>& all) : sites(all), settings(small_settings()), training(settings) {
    Noise noise;
    const auto height = [](double x, double) { return x < 0.8 ? 0.0 : x < 1.6 ? 0.08 : 0.04; };
    for (const Point& p : test::sample({0, 2.4, 0, 1.2}, 0.05, 0.005, noise, height)) training.dem.add(p);
    training.segment();
    training.mix();
    for (int l = 0; l < 3; ++l) REQUIRE(plane(l).alive());
    dem.init(settings.window, settings.planes.prior);
    field.init(settings.labels);
    for (const Site& site : sites) {
      dem.add({static_cast<float>(0.1 * site.i + 0.05), static_cast<float>(0.1 * site.j + 0.05),
               static_cast<float>(site.height_m), 1e-4f});
    }
  }
  int update(bool all = true) {
    return field.update(dem, training.mixture, all ? FieldScope::window : FieldScope::line, visits, counters);
  }
  const Plane& plane(int label) const { return training.mixture.plane(label); }

  std::vector<Site> sites;
  Settings settings;
  Stages<> training;
  Dem<small_limits> dem{};
  LabelField<small_limits> field{};
  LabelField<small_limits>::Visits visits{};
  Counters counters{};
};

/// Level of the plane of a label.
double height_of(const Tiny& tiny, int label) {
  return tiny.plane(label).z_m;
}

/// Student t with 2 degrees of freedom around the plane, up to a constant.
double log_node(const Tiny& tiny, const Site& site, int label) {
  const Plane& plane = tiny.plane(label);
  const Cell& cell = tiny.dem.cell(tiny.dem.slot(site.i, site.j));
  const double variance = static_cast<double>(plane.variance_m2 + tiny.settings.planes.prior.noise_m2 / cell.weight);
  const double residual =
      site.height_m - static_cast<double>(plane.height_m(0.1f * static_cast<float>(site.i) + 0.05f,
                                                         0.1f * static_cast<float>(site.j) + 0.05f));
  return -0.5 * std::log(variance) - 1.5 * std::log(1.0 + residual * residual / (2.0 * variance));
}

/// Marginals of the field, by summation over all labellings: [site][label].
std::vector<std::array<double, 3>> marginals_by_enumeration(const Tiny& tiny) {
  const auto n = tiny.sites.size();
  struct Pair {
    std::size_t a, b;
    double coupling;
  };
  std::vector<Pair> pairs;
  for_each_link(tiny.dem, tiny.settings.labels.link_reach, [&](const Link& link) {
    const auto index = [&](int slot) {
      return static_cast<std::size_t>(std::find_if(tiny.sites.begin(), tiny.sites.end(),
                                                   [&](const Site& s) { return tiny.dem.slot(s.i, s.j) == slot; }) -
                                      tiny.sites.begin());
    };
    pairs.push_back(
        {index(link.from), index(link.to), static_cast<double>(tiny.settings.labels.coupling) / link.distance});
  });
  std::vector<std::array<double, 3>> node(n), marginal(n, {0.0, 0.0, 0.0});
  for (std::size_t s = 0; s < n; ++s) {
    for (std::size_t l = 0; l < 3; ++l) node[s][l] = log_node(tiny, tiny.sites[s], static_cast<int>(l));
  }
  double total = 0.0;
  std::vector<std::size_t> label(n, 0);
  for (;;) {
    double log_weight = 0.0;
    for (std::size_t s = 0; s < n; ++s) log_weight += node[s][label[s]];
    for (const Pair& pair : pairs) log_weight += label[pair.a] == label[pair.b] ? pair.coupling : 0.0;
    const double weight = std::exp(log_weight - 10.0 * static_cast<double>(n));
    total += weight;
    for (std::size_t s = 0; s < n; ++s) marginal[s][label[s]] += weight;
    std::size_t s = 0;
    while (s < n && ++label[s] == 3) label[s++] = 0;
    if (s == n) break;
  }
  for (auto& m : marginal) {
    for (double& p : m) p /= total;
  }
  return marginal;
}

/// Largest difference between the field's beliefs and the enumerated ones.
double worst_difference(const Tiny& tiny) {
  const auto truth = marginals_by_enumeration(tiny);
  double worst = 0.0;
  for (std::size_t s = 0; s < tiny.sites.size(); ++s) {
    const auto belief = tiny.field.belief(tiny.dem, tiny.dem.slot(tiny.sites[s].i, tiny.sites[s].j));
    double sum = 0.0;
    for (std::size_t c = 0; c < belief.label.size(); ++c) {
      REQUIRE(belief.label[c] < 3);
      worst = std::max(worst, std::abs(static_cast<double>(belief.probability[c]) - truth[s][belief.label[c]]));
      sum += static_cast<double>(belief.probability[c]);
    }
    CHECK(sum == Approx(1.0).margin(1e-5));
  }
  return worst;
}

// A message is rounded to half of 1/32 nat. A belief sums at most four, each of which may contain half as much again
// from farther away: 0.09 nat, which changes a probability by a quarter of it at most.
constexpr double quantisation = 0.09 / 4;

TEST_CASE("label field: on a row of cells one pass gives the exact beliefs") {
  const auto tiny = std::make_unique<Tiny>(std::vector<Site>{{2, 17, 0.0},
                                                             {3, 17, 0.015},
                                                             {4, 17, 0.02},
                                                             {5, 17, 0.05},
                                                             {6, 17, 0.03},
                                                             {7, 17, 0.06},
                                                             {8, 17, 0.07},
                                                             {9, 17, 0.02}});
  tiny->update();
  CHECK(worst_difference(*tiny) < quantisation);
}

TEST_CASE("label field: on a column of cells one pass gives the exact beliefs") {
  const auto tiny = std::make_unique<Tiny>(std::vector<Site>{{5, 14, 0.0},
                                                             {5, 15, 0.015},
                                                             {5, 16, 0.02},
                                                             {5, 17, 0.05},
                                                             {5, 18, 0.03},
                                                             {5, 19, 0.06},
                                                             {5, 20, 0.07},
                                                             {5, 21, 0.02}});
  tiny->update();
  CHECK(worst_difference(*tiny) < quantisation);
}

TEST_CASE("label field: across gaps the coupling falls with the distance, and the beliefs stay exact") {
  const auto tiny = std::make_unique<Tiny>(
      std::vector<Site>{{1, 17, 0.0}, {3, 17, 0.02}, {6, 17, 0.025}, {7, 17, 0.06}, {17, 17, 0.05}, {23, 17, 0.03}});
  tiny->update();
  CHECK(worst_difference(*tiny) < quantisation);
}

TEST_CASE("label field: on a tree a second pass gives the exact beliefs") {
  const auto tiny = std::make_unique<Tiny>(std::vector<Site>{{3, 17, 0.05},
                                                             {4, 17, 0.0},
                                                             {5, 17, 0.02},
                                                             {5, 18, 0.03},
                                                             {5, 19, 0.02},
                                                             {6, 19, 0.07},
                                                             {7, 19, 0.05},
                                                             {5, 16, 0.01}});
  for (int pass = 0; pass < 3; ++pass) tiny->update();
  CHECK(worst_difference(*tiny) < quantisation);
}

TEST_CASE("label field: an isolated wrong cell is outvoted by its neighbours") {
  std::vector<Site> sites;
  for (int i = 8; i < 13; ++i) {
    for (int j = 15; j < 20; ++j) sites.push_back({i, j, i == 10 && j == 17 ? 0.023 : 0.0});
  }
  const auto alone = std::make_unique<Tiny>(std::vector<Site>{{10, 17, 0.023}});
  alone->update();
  const auto among = std::make_unique<Tiny>(sites);
  for (int pass = 0; pass < 3; ++pass) among->update();
  const auto label = [](const Tiny& tiny, int i, int j) { return tiny.field.label(tiny.dem.slot(i, j)); };
  CHECK(height_of(*alone, label(*alone, 10, 17)) == Approx(0.04).margin(1e-3));
  CHECK(label(*among, 10, 17) == label(*among, 8, 15));
  CHECK(height_of(*among, label(*among, 10, 17)) == Approx(0.0).margin(1e-3));
}

TEST_CASE("label field: a height far from all planes is still given the nearest, with finite beliefs") {
  const auto tiny = std::make_unique<Tiny>(std::vector<Site>{{5, 17, 1e6}, {6, 17, -1e6}});
  tiny->update();
  for (const int i : {5, 6}) {
    const auto belief = tiny->field.belief(tiny->dem, tiny->dem.slot(i, 17));
    for (const float p : belief.probability) CHECK(is_finite(p));
    CHECK(tiny->field.label(tiny->dem.slot(i, 17)) != no_label);
  }
}

//  ____       _|  an object on the road, as high as the pavement and higher
//      |_____| |___
TEST_CASE("label field: the ground below an obstacle is that of the cells around it, however high it is") {
  Stages<small_limits> stages(small_settings());
  const auto stands = [](double x, double y) { return x > 1.2 && x < 1.6 && y > 0.8 && y < 1.6; };
  fill(stages.dem, [&](double x, double y) {
    if (stands(x, y)) return 0.3 + (static_cast<int>(y * 100) % 10 < 5 ? -0.2 : 0.2);
    return x < 1.0 ? 0.10 : 0.0;
  });
  stages.settle();
  const auto road = stages.label_at(20, 2);
  CHECK(stages.label_at(2, 2) != road);
  int on_road = 0;
  for (int i = 12; i < 16; ++i) {
    for (int j = 8; j < 16; ++j) on_road += stages.label_at(i, j) == road;
  }
  CHECK(on_road == 4 * 8);
}

TEST_CASE(
    "label field: a cell that lies level is not given a plane along a flight of stairs that passes nearer to it") {
  Stages<small_limits> stages(small_settings());
  Noise noise;
  const auto height = [](double x, double) { return x < 1.2 ? 0.0 : 0.6 * (1.2 - x); };
  for (const Point& p : test::sample({0, 2.4, 0, 1.2}, 0.02, 0.005, noise, height)) stages.dem.add(p);
  stages.segment();
  stages.mix();
  const Label level = stages.mixture.region_label(stages.dem.slot(5, 5));
  const Label steep = stages.mixture.region_label(stages.dem.slot(20, 5));
  REQUIRE((level != no_label && steep != no_label && level != steep));
  const auto label = [&](double slope) {  // of a cell 2 cm lower than the level plane and 1 cm higher than the other
    Dem<small_limits> dem{};
    LabelField<small_limits> field{};
    const Settings settings = small_settings();
    dem.init(settings.window, settings.planes.prior);
    field.init(settings.labels);
    for (int k = 0; k < 25; ++k) {
      const double dx = 0.02 * (k % 5) - 0.04, dy = 0.02 * (k / 5) - 0.04;
      dem.add({static_cast<float>(1.25 + dx), static_cast<float>(1.85 + dy), static_cast<float>(-0.02 - slope * dx),
               1e-4f});
    }
    field.update(dem, stages.mixture, FieldScope::window, stages.work.visits(), stages.counters);
    return field.label(dem.slot(12, 18));
  };
  CHECK(label(0.0) == level);
  CHECK(label(0.6) == steep);
}

TEST_CASE("label field: two pavements of one height keep their labels apart") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  const auto street = [](double x, double) { return x < 0.8 || x > 1.6 ? 0.12 : 0.0; };
  for (const Point& p : test::sample({0, 2.4, 0, 2.4}, 0.05, 0.008, noise, street)) stages->dem.add(p);
  for (int pass = 0; pass < 5; ++pass) stages->infer(true);
  const auto left = stages->label_at(0, 0), right = stages->label_at(23, 0);
  CHECK(left != right);
  for (int j = 0; j < 24; ++j) {
    for (int i = 0; i < 8; ++i) CHECK(stages->label_at(i, j) == left);
    for (int i = 16; i < 24; ++i) CHECK(stages->label_at(i, j) == right);
  }
}

TEST_CASE("label field: without planes no cell has a label") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  stages->dem.add({1.0f, 1.0f, 0.0f, 1e-4f});
  stages->infer();
  CHECK(stages->label_at(10, 10) == no_label);
}

TEST_CASE("label field: with fewer planes than candidates the others are none, with probability nought") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  stages->infer(true);
  const auto belief = stages->field.belief(stages->dem, stages->dem.slot(3, 3));
  CHECK(belief.label[2] == no_label);
  CHECK(belief.probability[2] == 0.0f);
  CHECK(belief.probability[0] > 0.99f);
}

TEST_CASE("label field: a cell that left the window is forgotten") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double, double) { return 0.0; });
  stages->infer(true);
  REQUIRE(stages->label_at(4, 4) != no_label);
  stages->field.forget(stages->dem.slot(4, 4));
  CHECK(stages->label_at(4, 4) == no_label);
}

TEST_CASE("label field: once its messages stand, a line that touches nothing sends none") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  for (int line = 0; line < 48; ++line) stages->infer();
  const auto before = stages->counters.messages;
  stages->infer();
  CHECK(stages->counters.messages == before);
}

Belief belief_at(const Stages<>& stages, int i, int j) {
  return stages.field.belief(stages.dem, stages.dem.slot(i, j));
}

TEST_CASE("label field: the budget of messages is kept, what waits is counted and catches up") {
  Settings settings = small_settings();
  settings.labels.max_messages = 400;
  const auto bounded = std::make_unique<Stages<>>(settings), free = std::make_unique<Stages<>>(small_settings());
  for (auto* stages : {bounded.get(), free.get()}) {
    fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
    stages->segment();
    stages->mix();
  }
  free->label(true);
  bounded->label(false);
  CHECK(bounded->counters.messages <= 400);
  CHECK(bounded->counters.cells_deferred == 576 - 100);
  CHECK(belief_at(*bounded, 23, 23).label[0] == no_label);
  for (int call = 0; call < 20; ++call) bounded->infer();
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) CHECK(bounded->label_at(i, j) == free->label_at(i, j));
  }
  const auto deferred = bounded->counters.cells_deferred;
  bounded->infer();
  CHECK(bounded->counters.cells_deferred == deferred);
}

TEST_CASE("label field: a budget that is not given grows with the window, five messages for eight cells") {
  const int rows = GENERATE(12, 24);
  Settings settings = small_settings(rows, 24);
  settings.labels.max_messages.reset();
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double, double) { return 0.0; });
  stages->infer();
  CHECK(stages->counters.messages == 5u * static_cast<unsigned>(rows) * 24u / 8u);
}

/// Cells whose turn has not come yet.
int cells_without_candidates(const Stages<>& stages) {
  int without = 0;
  for (int i = 0; i < stages.dem.rows(); ++i) {
    for (int j = 0; j < stages.dem.cols(); ++j) without += belief_at(stages, i, j).label[0] == no_label;
  }
  return without;
}

TEST_CASE("label field: even the smallest budget reaches every cell in the end") {
  Settings settings = small_settings();
  settings.labels.max_messages = 4;
  REQUIRE(check(settings, Limits{}) == Status::ok);
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double, double) { return 0.0; });
  for (int call = 0; call < 2000; ++call) stages->infer();
  CHECK(cells_without_candidates(*stages) == 0);
}

TEST_CASE("label field: rows that every line changes take no more turns than others") {
  Settings settings = small_settings();
  settings.labels.max_messages = directions * 24 * 6;  // the messages of six rows
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double, double) { return 0.0; });
  for (int call = 0; call < 6; ++call) {
    for (int j = 0; j < 24; ++j) {
      for (int i = 0; i < 6; ++i)
        stages->dem.add({0.1f * static_cast<float>(i) + 0.05f, 0.1f * static_cast<float>(j) + 0.05f, 0.0f, 1e-4f});
    }
    stages->infer();
  }
  CHECK(cells_without_candidates(*stages) == 0);
}

//         ______
//  ______/            what has been level becomes two planes, as where something low has come to stand
TEST_CASE("label field: a cell that waits for its turn has the label that its region has come to have") {
  Settings settings = small_settings();
  settings.labels.max_messages = directions * 24;
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double, double) { return 0.0; });
  for (int call = 0; call < 100; ++call) stages->infer();
  for (int sweep = 0; sweep < 4; ++sweep) fill(stages->dem, [](double x, double) { return x < 1.2 ? 0.0 : 0.12; });
  stages->infer();
  REQUIRE(stages->counters.cells_deferred > 0);
  int of_region = 0;
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) {
      const Label region = stages->mixture.region_label(stages->dem.slot(i, j));
      REQUIRE(region != no_label);
      of_region += stages->label_at(i, j) == region;
    }
  }
  CHECK(of_region >= 21 * 24);  // of the others it is the turn, beside cells that have still to change
}

TEST_CASE("label field: a cell that waits for its turn has a label, also if it hears of the cells before it") {
  Settings settings = small_settings();
  settings.labels.max_messages = 5 * directions * 24;
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double, double) { return 0.0; });
  for (int call = 0; call < 4; ++call) {
    stages->infer();
    for (int i = 0; i < 24; ++i) {
      for (int j = 0; j < 24; ++j) REQUIRE(stages->label_at(i, j) != no_label);
    }
  }
}

TEST_CASE("label field: a cell that waits for its turn has no obstacle's label") {
  Settings settings = small_settings();
  settings.labels.max_messages = directions * 24;
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double x, double y) { return x > 1.4 && x < 2.0 && y > 0.8 && y < 1.4 ? 0.35 : 0.0; });
  for (int call = 0; call < 24; ++call) {
    stages->infer();
    for (int i = 15; i < 19; ++i) {
      for (int j = 9; j < 13; ++j) {
        const Label label = stages->label_at(i, j);
        REQUIRE((label == no_label || stages->mixture.ground(label)));
      }
    }
  }
}

TEST_CASE("label field: a row that every line changes does not starve the others") {
  Settings settings = small_settings();
  settings.labels.max_messages = directions * 24;  // the messages of one row
  const auto stages = std::make_unique<Stages<>>(settings);
  fill(stages->dem, [](double, double) { return 0.0; });
  for (int call = 0; call < 2000; ++call) {
    for (int j = 0; j < 24; ++j) stages->dem.add({0.05f, 0.1f * static_cast<float>(j) + 0.05f, 0.0f, 1e-4f});
    stages->infer();
  }
  CHECK(cells_without_candidates(*stages) == 0);
}

TEST_CASE("label field: a budget that is not given starves no cell, of the smallest window either") {
  Settings settings = small_settings(4, GENERATE(4, 24));
  settings.labels.max_messages.reset();
  const auto stages = std::make_unique<Stages<>>(settings);
  for (int call = 0; call < 20; ++call) {  // each line changes all cells
    fill(stages->dem, [](double, double) { return 0.0; });
    stages->infer();
  }
  CHECK(cells_without_candidates(*stages) == 0);
}

TEST_CASE("label field: on a map that no longer changes the kept field comes to where whole passes end") {
  const auto lines = std::make_unique<Stages<>>(small_settings()), whole = std::make_unique<Stages<>>(small_settings());
  Noise noise;
  const auto points = test::sample({0, 2.4, 0, 2.4}, 0.06, 0.02, noise,
                                   [](double x, double y) { return x + 0.5 * y < 1.7 ? 0.02 * x : 0.07; });
  for (auto* stages : {lines.get(), whole.get()}) {
    for (const Point& p : points) stages->dem.add(p);
  }
  for (int pass = 0; pass < 20; ++pass) whole->infer(true);
  for (int line = 0; line < 240; ++line) lines->infer();
  float worst = 0.0f;
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) {
      const int slot = whole->dem.slot(i, j);
      if (!whole->dem.cell(slot).valid()) continue;
      CHECK(lines->label_at(i, j) == whole->label_at(i, j));
      const auto a = lines->field.belief(lines->dem, slot), b = whole->field.belief(whole->dem, slot);
      for (std::size_t c = 0; c < a.label.size(); ++c)
        worst = std::max(worst, std::abs(a.probability[c] - b.probability[c]));
    }
  }
  CHECK(worst < static_cast<float>(quantisation));
}

TEST_CASE("label field: no cell has the label of a dead plane, from the line on in which it dies") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  // Two patches out of reach of each other until the ground between them is seen.
  const auto see = [&](double from, double to) {
    test::fill(stages->dem, [=](double x, double) { return x < from || x > to ? std::nan("") : 0.0; });
  };
  see(0.0, 0.6);
  see(1.7, 2.4);
  for (int line = 0; line < 3; ++line) stages->infer();
  REQUIRE(stages->label_at(2, 12) != stages->label_at(20, 12));
  see(0.6, 1.7);
  stages->infer();
  for (int i = 0; i < 24; ++i) {
    for (int j = 0; j < 24; ++j) {
      REQUIRE(stages->label_at(i, j) != no_label);
      CHECK(stages->mixture.plane(stages->label_at(i, j)).alive());
    }
  }
}

TEST_CASE("label field: what turns out to be no ground is left to the ground beside it in the same line, and back") {
  const auto stages = std::make_unique<Stages<>>(small_settings());
  // A veil for a laser 1 m up, a slope for a higher one.
  test::fill(stages->dem, [](double x, double) { return x < 1.2 || x > 1.8 ? 0.0 : 1.0 - x / 1.8; });
  const auto own_labels = [&](float laser_m) {
    stages->view.z_m = laser_m;
    stages->dem.add({0.05f, 0.05f, 0.0f, 1e-4f});
    stages->infer();
    const Label of_slope = stages->mixture.region_label(stages->dem.slot(15, 12));
    REQUIRE(of_slope != no_label);
    int own = 0;
    for (int j = 0; j < 24; ++j) own += stages->label_at(15, j) == of_slope;
    return own;
  };
  CHECK(own_labels(3.0f) == 24);
  CHECK(own_labels(1.0f) == 0);
  CHECK(own_labels(3.0f) == 24);
}

}  // namespace
}  // namespace curbline
