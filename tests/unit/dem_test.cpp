// The rolling window as a ring in two dimensions: which cells are valid, and what they contain, after every move.
#include "curbline/map/dem.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "curbline/regions/link.hpp"
#include "support/terrain.hpp"

namespace curbline {
namespace {

constexpr Limits limits{.rows = 12, .cols = 16};
using Map = Dem<limits>;

WindowSettings moving() {
  return {.rows = 12, .cols = 16, .origin_x_m = 0.0f, .origin_y_m = -0.8f};
}

Map make_map(const WindowSettings& window) {
  Map dem;
  dem.init(window, PlanePrior{});
  return dem;
}

/// The cell at a position in the map.
int slot_at(const Map& dem, float x_m, float y_m) {
  const Map::Place place = dem.place_at(x_m, y_m);
  REQUIRE(place.inside());
  return dem.slot(place.i, place.j);
}

Point at(double x, double y, double z = 0.0, float variance = 1e-4f) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), variance};
}

/// The pose of a robot that heads along the map's x axis.
Transform standing_at(float x_m, float y_m) {
  Transform T_map_base;
  T_map_base.translation << x_m, y_m, 0.0f;
  return T_map_base;
}

/// A height that encodes a cell's row and column in the endless grid.
double name(int row, int col) {
  return 0.001 * (100 * row + col);
}

/// Adds one point in the middle of every cell.
void fill_names(Map& dem) {
  const int row0 = static_cast<int>(std::lround(dem.origin_x_m() / 0.1f)),
            col0 = static_cast<int>(std::lround(dem.origin_y_m() / 0.1f));
  for (int i = 0; i < dem.rows(); ++i) {
    for (int j = 0; j < dem.cols(); ++j)
      REQUIRE(dem.add(at(0.1 * (row0 + i) + 0.05, 0.1 * (col0 + j) + 0.05, name(row0 + i, col0 + j))));
  }
}

/// The window as a picture, one line a row: '#' valid, '.' not.
std::string picture(const Map& dem) {
  std::string rows;
  for (int i = 0; i < dem.rows(); ++i) {
    for (int j = 0; j < dem.cols(); ++j) rows += dem.cell(dem.slot(i, j)).valid() ? '#' : '.';
    rows += '\n';
  }
  return rows;
}

TEST_CASE("dem: what the points of a cell were found to share is no less, as evidence, than the ground's texture") {
  const PlanePrior prior;
  Map dem = make_map(moving());
  CHECK(dem.common_m2() == prior.common_m2());
  dem.set_common(4e-5f, 0.0f);
  CHECK(dem.common_m2() == 4e-5f);
  CHECK(dem.prior().common_m2() == Approx(4e-5f));
  dem.set_common(1e-6f, 2e-5f);
  CHECK(dem.common_m2() == 1e-6f);
  CHECK(dem.prior().common_m2() == Approx(prior.texture_m2));
  CHECK(dem.line_m2() == 2e-5f);
}

TEST_CASE("dem: every cell of the window has a slot of its own") {
  Map dem = make_map(moving());
  for (const auto& [x, y] : {std::pair{0.0f, 0.0f}, {7.3f, -3.1f}, {-55.0f, 20.0f}}) {
    dem.follow(standing_at(x, y), [](int) {});
    std::set<int> slots;
    for (int i = 0; i < dem.rows(); ++i) {
      for (int j = 0; j < dem.cols(); ++j) slots.insert(dem.slot(i, j));
    }
    CHECK(slots.size() == 12 * 16);
    CHECK(*slots.begin() >= 0);
    CHECK(*slots.rbegin() < Map::capacity);
  }
}

TEST_CASE("dem: after a move in any direction the cells that left are empty and all others are where they were") {
  const auto [blocks_x, blocks_y] = GENERATE(table<int, int>(
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {2, -1}, {-2, 3}, {0, 0}, {3, 0}, {0, -4}, {100, -77}}));
  Map dem = make_map(moving());
  dem.follow(standing_at(2.0f, -1.2f), [](int) {});
  fill_names(dem);
  std::map<std::pair<int, int>, int> slot_of;  // slots of the cells of the endless grid
  const int row0 = static_cast<int>(std::lround(dem.origin_x_m() / 0.1f)),
            col0 = static_cast<int>(std::lround(dem.origin_y_m() / 0.1f));
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 16; ++j) slot_of[{row0 + i, col0 + j}] = dem.slot(i, j);
  }
  dem.clear_touched();

  std::set<int> left;
  dem.follow(standing_at(2.0f + 0.4f * static_cast<float>(blocks_x), -1.2f + 0.4f * static_cast<float>(blocks_y)),
             [&](int slot) {
               CHECK(dem.cell(slot).valid());  // can still be read
               left.insert(slot);
             });

  std::string expected;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 16; ++j) {
      const std::pair<int, int> place{row0 + 4 * blocks_x + i, col0 + 4 * blocks_y + j};
      const bool stays = slot_of.count(place) > 0;
      expected += stays ? '#' : '.';
      if (stays) {
        CHECK(dem.slot(i, j) == slot_of[place]);
        CHECK(dem.cell(dem.slot(i, j)).height_m == Approx(name(place.first, place.second)).margin(1e-6));
        CHECK(left.count(dem.slot(i, j)) == 0);
        CHECK_FALSE(dem.touched(dem.slot(i, j)));
      } else {
        CHECK(left.count(dem.slot(i, j)) == 1);
        CHECK(dem.touched(dem.slot(i, j)));
      }
    }
    expected += '\n';
  }
  CHECK(picture(dem) == expected);
  CHECK(dem.origin_x_m() == Approx(0.1 * (row0 + 4 * blocks_x)).margin(1e-5));
  CHECK(dem.origin_y_m() == Approx(0.1 * (col0 + 4 * blocks_y)).margin(1e-5));
}

TEST_CASE("dem: a window of the smallest cells that leaps across the world has left all that it knew") {
  WindowSettings window;
  window.cell_x_m = window.cell_y_m = 0.001f;
  window.origin_x_m = -1e5f;
  const auto dem = std::make_unique<Dem<Limits{}>>();
  dem->init(window, PlanePrior{});
  const auto nothing = [](int) { FAIL("no cell was valid"); };
  dem->follow(standing_at(-1e6f, 0.0f), nothing);
  REQUIRE(dem->add({dem->origin_x_m(), dem->origin_y_m(), 0.0f, 1e-4f}));
  int left = 0;
  dem->follow(standing_at(1.2e6f, 0.0f), [&](int) { ++left; });
  CHECK(left == 1);
}

TEST_CASE("dem: the ring survives a walk all around") {
  Map dem = make_map(moving());
  fill_names(dem);
  for (const auto& [x, y] :
       {std::pair{0.4f, 0.0f}, {0.8f, 0.4f}, {0.8f, 1.2f}, {0.4f, 1.2f}, {0.0f, 0.8f}, {0.0f, 0.0f}}) {
    dem.follow(standing_at(x, y), [](int) {});
  }
  // Two blocks of rows and three of columns have been out of the window.
  std::string expected;
  for (int i = 0; i < 12; ++i) expected += (i < 8 ? "................" : "............####") + std::string("\n");
  CHECK(picture(dem) == expected);
  CHECK(dem.cell(dem.slot(11, 15)).height_m == Approx(name(11, 7)).margin(1e-6));
}

TEST_CASE("dem: a small motion does not move the window") {
  Map dem = make_map(moving());
  fill_names(dem);
  dem.follow(standing_at(0.15f, -0.15f), [](int) { FAIL("no cell may leave"); });
  CHECK(dem.origin_x_m() == 0.0f);
  CHECK(dem.origin_y_m() == Approx(-0.8f));
}

TEST_CASE("dem: a pose that trembles by less than half a cell does not move the window to and fro") {
  Map dem = make_map(moving());
  dem.follow(standing_at(0.24f, 0.0f), [](int) {});  // the border of two blocks is at 0.2 m
  CHECK(dem.origin_x_m() == 0.0f);
  dem.follow(standing_at(0.26f, 0.0f), [](int) {});
  CHECK(dem.origin_x_m() == Approx(0.4f));
  fill_names(dem);
  for (const float x_m : {0.17f, 0.23f, 0.16f, 0.4f}) {
    dem.follow(standing_at(x_m, 0.0f), [](int) { FAIL("no cell may leave"); });
    CHECK(dem.origin_x_m() == Approx(0.4f));
  }
}

TEST_CASE("dem: the middle of the window keeps its place before the robot, whatever the heading") {
  WindowSettings window = moving();
  window.origin_x_m = 0.4f;  // the middle is 1 m ahead
  const double angle = GENERATE(0.0, 0.7, 1.6, 3.1, -2.2);
  Map dem = make_map(window);
  Transform T_map_base = standing_at(7.0f, -3.0f);
  T_map_base.rotation = make_transform(MountSettings{.yaw_rad = static_cast<float>(angle)}).rotation;
  dem.follow(T_map_base, [](int) {});
  CHECK(dem.origin_x_m() + 0.6f == Approx(7.0 + std::cos(angle)).margin(0.25));  // half a block and half a cell
  CHECK(dem.origin_y_m() + 0.8f == Approx(-3.0 + std::sin(angle)).margin(0.25));
}

TEST_CASE("dem: points above the ceiling are not taken, which rises with the robot unless the window is fixed") {
  WindowSettings window = moving();
  window.fixed = GENERATE(false, true);
  window.max_height_m = 0.5f;
  Map dem = make_map(window);
  CHECK(dem.add(at(0.05, 0.05, 0.5)));
  CHECK_FALSE(dem.add(at(0.05, 0.05, 0.51)));
  Transform T_map_base;
  T_map_base.translation.z() = 2.0f;
  dem.follow(T_map_base, [](int) { FAIL("no cell may leave"); });
  CHECK(dem.add(at(0.05, 0.05, 2.4)) == !window.fixed);
  CHECK_FALSE(dem.add(at(0.05, 0.05, 2.6)));
  CHECK(dem.surroundings().ceiling_m == (window.fixed ? 0.5f : 2.5f));
}

TEST_CASE("dem: a fixed window stays") {
  WindowSettings window = moving();
  window.fixed = true;
  Map dem = make_map(window);
  fill_names(dem);
  dem.follow(standing_at(100.0f, 100.0f), [](int) { FAIL("no cell may leave"); });
  CHECK(dem.add(at(0.05, 0.05)));
}

TEST_CASE("dem: a point goes to the cell that it lies in, with its offset from the centre") {
  Map dem = make_map(moving());
  REQUIRE(dem.add(at(0.38, -0.61, 0.2)));
  const Cell& cell = dem.cell(dem.slot(3, 1));
  CHECK(cell.valid());
  CHECK(cell.dx_m == Approx(0.03).margin(1e-6));
  CHECK(cell.dy_m == Approx(0.04).margin(1e-6));
  CHECK(dem.centroid_x_m(3, cell) == Approx(0.38).margin(1e-6));
  CHECK(dem.centroid_y_m(1, cell) == Approx(0.19).margin(1e-6));  // from the window's lowest corner
}

TEST_CASE("dem: points outside the window are refused on all four sides") {
  Map dem = make_map(moving());
  for (const auto& [x, y] :
       {std::pair{-1e-4, 0.0}, {1.2001, 0.0}, {0.5, -0.8001}, {0.5, 0.8001}, {1e30, 0.0}, {0.5, -1e30}}) {
    CHECK_FALSE(dem.add(at(x, y)));
  }
  CHECK(dem.add(at(0.0, -0.8)));
  CHECK(dem.add(at(1.1999, 0.7999)));
}

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();

TEST_CASE("dem: NaN and infinity are refused in every coordinate of a point") {
  Map dem = make_map(moving());
  for (const float bad : {nan, infinity, -infinity}) {
    for (float Point::*value : {&Point::x_m, &Point::y_m, &Point::z_m}) {
      Point point = at(0.5, 0.0);
      point.*value = bad;
      CHECK_FALSE(dem.add(point));
    }
  }
  CHECK(picture(dem).find('#') == std::string::npos);
}

TEST_CASE("dem: a height that no map has is refused: its square would be infinite, and no plane fit") {
  Map dem = make_map(moving());
  CHECK_FALSE(dem.add(at(0.5, 0.0, -1e25)));
  CHECK_FALSE(dem.add(at(0.5, 0.0, 1.1e6)));
  CHECK(dem.add(at(0.5, 0.0, 0.9e6)));
}

TEST_CASE("dem: a variance that is negative or no number is refused") {
  Map dem = make_map(moving());
  CHECK_FALSE(dem.add(at(0.5, 0.0, 0.0, -1e-4f)));
  CHECK_FALSE(dem.add(at(0.5, 0.0, 0.0, nan)));
}

TEST_CASE("dem: an infinite variance is refused") {
  Map dem = make_map(moving());
  CHECK_FALSE(dem.add(at(0.5, 0.0, 0.0, infinity)));
}

TEST_CASE("dem: on ground without texture, points without noise are mapped, and do not poison their cell") {
  Map dem;
  PlanePrior prior;
  prior.texture_m2 = 0.0f;
  dem.init(moving(), prior);
  for (int k = 0; k < 2; ++k) CHECK(dem.add(at(0.05, 0.05, 0.3, 0.0f)));
  CHECK(dem.add(at(0.05, 0.05, 0.3, 1e-40f)));
  const Cell& cell = dem.cell(dem.slot(0, 8));
  CHECK(cell.valid());
  CHECK(cell.height_m == 0.3f);
}

TEST_CASE("dem: a point weighs the expected noise over its own plus the ground's") {
  Map dem = make_map(moving());
  const PlanePrior prior;
  dem.add(at(0.05, 0.05, 0.0, 3e-4f));
  CHECK(dem.cell(dem.slot(0, 8)).weight == Approx(prior.noise_m2 / (3e-4f + prior.texture_m2)));
}

TEST_CASE("dem: a point goes to the cell where the beams beside its own have it, and counts there where it lies") {
  Map dem = make_map(moving());
  Point point = at(0.11, 0.05, 0.3);
  point.shift_x_m = -0.02f;
  REQUIRE(dem.add(point));
  CHECK_FALSE(dem.cell(dem.slot(1, 8)).valid());
  const Cell& cell = dem.cell(dem.slot(0, 8));
  REQUIRE(cell.valid());
  CHECK(dem.centroid_x_m(0, cell) == Approx(0.11));
  CHECK(cell.height_m == 0.3f);
  point.shift_x_m = -0.12f;  // beyond the window
  CHECK_FALSE(dem.add(point));
}

TEST_CASE("dem: points that share their errors are worth fewer independent ones") {
  Map dem = make_map(moving());
  for (int k = 0; k < 9; ++k) dem.add(at(0.05, 0.05, 0.01 * k));
  const Cell& cell = dem.cell(dem.slot(0, 8));
  const PlaneMoments m = dem.moments(0, 8, cell);
  const float worth = 1.0f / (1.0f + PlanePrior{}.common_share * 8.0f);  // Kish: 1 / (1 + rho (n - 1))
  CHECK(m.points == Approx(9.0f * worth));
  CHECK(m.weight == Approx(cell.weight * worth));
  CHECK(m.zz == Approx(cell.scatter_m2 * worth));
  CHECK(m.cells == 1.0f);
}

TEST_CASE("dem: the next valid cell is found across gaps, up to the reach and the window's edge") {
  Map dem = make_map(moving());
  dem.add(at(0.25, -0.45));  // (2, 3)
  dem.add(at(0.85, -0.45));  // (8, 3)
  dem.add(at(0.25, 0.75));   // (2, 15)
  const int near = dem.slot(2, 3), ahead = dem.slot(8, 3), left = dem.slot(2, 15);
  constexpr int plus_x = 0, minus_x = 1, plus_y = 2, minus_y = 3;
  CHECK(dem.next_valid(near, plus_x, 10) == 6);
  CHECK(dem.next_valid(ahead, minus_x, 10) == 6);
  CHECK(dem.next_valid(near, plus_x, 6) == 6);
  CHECK(dem.next_valid(near, plus_x, 5) == 0);
  CHECK(dem.next_valid(near, plus_y, max_link_reach) == 12);
  CHECK(dem.next_valid(left, minus_y, max_link_reach) == 12);
  CHECK(dem.next_valid(left, plus_y, max_link_reach) == 0);
  CHECK(dem.next_valid(near, minus_x, max_link_reach) == 0);
  dem.add(at(0.55, -0.45));  // (5, 3), between
  CHECK(dem.next_valid(near, plus_x, 10) == 3);
  CHECK(dem.next_valid(ahead, minus_x, 10) == 3);
}

TEST_CASE("dem: after any drive the distances to neighbours are those that a search finds") {
  Map dem = make_map(moving());
  test::Noise noise(3);
  float x = 0.0f, y = 0.0f;
  for (int step = 0; step < 200; ++step) {
    for (int k = 0; k < 6; ++k) dem.add(at(x - 0.2 + 1.6 * noise.uniform(), y - 1.0 + 2.0 * noise.uniform()));
    x += static_cast<float>(0.2 * noise.normal());
    y += static_cast<float>(0.2 * noise.normal());
    dem.follow(standing_at(x, y), [](int) {});
    dem.for_each_valid([&](int i, int j, int s) {
      for (int d = 0; d < directions; ++d) {
        int g = 0, a = i, b = j;
        do {
          ++g;
          a += step_i[static_cast<std::size_t>(d)];
          b += step_j[static_cast<std::size_t>(d)];
        } while (a >= 0 && b >= 0 && a < dem.rows() && b < dem.cols() && !dem.cell(dem.slot(a, b)).valid());
        const bool found = a >= 0 && b >= 0 && a < dem.rows() && b < dem.cols() && g <= max_link_reach;
        REQUIRE(dem.next_valid(s, d, max_link_reach) == (found ? g : 0));
      }
    });
  }
}

TEST_CASE("dem: the slot of a neighbour follows from the cell's own and the distance, wherever the ring begins") {
  WindowSettings window = moving();
  if (GENERATE(false, true)) window.rows = 8, window.cols = 12;
  Map dem = make_map(window);
  for (const float x_m : {0.0f, 0.4f, -1.2f}) {
    dem.follow(standing_at(x_m, 2.0f * x_m), [](int) {});
    for (int i = 0; i < dem.rows(); ++i) {
      for (int a = 0; a < dem.rows(); ++a)
        CHECK(dem.slot_beside(dem.slot(i, 2), direction(0, a < i ? -1 : 1), std::abs(a - i)) == dem.slot(a, 2));
    }
    for (int j = 0; j < dem.cols(); ++j) {
      for (int b = 0; b < dem.cols(); ++b)
        CHECK(dem.slot_beside(dem.slot(3, j), direction(1, b < j ? -1 : 1), std::abs(b - j)) == dem.slot(3, b));
    }
  }
}

TEST_CASE("dem: each pair of neighbours is linked once, with its distance") {
  Map dem = make_map(moving());
  for (const auto& [x, y] : {std::pair{0.05, -0.75}, {0.15, -0.75}, {0.45, -0.75}, {0.15, -0.55}}) dem.add(at(x, y));
  std::map<std::pair<std::size_t, std::size_t>, int> links;
  for_each_link(dem, 3, [&](const Link& link) {
    CHECK(links.count({link.from, link.to}) == 0);
    links[{link.from, link.to}] = link.distance;
  });
  const auto slot = [&](int i, int j) { return static_cast<std::size_t>(dem.slot(i, j)); };
  CHECK(links.size() == 3);
  CHECK(links[{slot(0, 0), slot(1, 0)}] == 1);
  CHECK(links[{slot(1, 0), slot(4, 0)}] == 3);
  CHECK(links[{slot(1, 0), slot(1, 2)}] == 2);
}

TEST_CASE("dem: a link goes on to the ground behind what stands on it, within reach and wherever the ring begins") {
  Map dem = make_map(moving());
  for (int moves = 0; moves < 6; ++moves) {
    dem.follow(standing_at(0.4f * static_cast<float>(moves), 0.4f * static_cast<float>(moves)), [](int) {});
    const auto see = [&](int i, int j, double z) {
      const double x = static_cast<double>(dem.origin_x_m()) + 0.1 * i + 0.05;
      const double y = static_cast<double>(dem.origin_y_m()) + 0.1 * j + 0.05;
      REQUIRE(dem.add(at(x, y, z)));
    };
    for (const int n : {5, 6, 8, 9}) {
      const bool post = n == 6 || n == 8;
      for (const double z : {0.0, 0.4}) see(n, 2, post ? z : 0.0), see(2, n, post ? z : 0.0);
    }
    int links = 0;
    for_each_link(dem, 4, [&](const Link& link) {
      const bool along_x = link.axis == 0;
      if (link.from != (along_x ? dem.slot(5, 2) : dem.slot(2, 5))) return;
      ++links;
      const auto posts = [&](int slot) { return dem.steep(dem.cell(slot)); };
      CHECK(beyond_obstacle(dem, link, 4, posts) == (along_x ? dem.slot(9, 2) : dem.slot(2, 9)));
      CHECK(beyond_obstacle(dem, link, 3, posts) == -1);
    });
    CHECK(links == 2);
  }
}

TEST_CASE("dem: what was touched is told until it is cleared") {
  Map dem = make_map(moving());
  dem.add(at(0.05, 0.05));
  CHECK(dem.touched(dem.slot(0, 8)));
  CHECK_FALSE(dem.touched(dem.slot(0, 9)));
  CHECK(dem.block_touched(dem.slot(0, 8)));
  CHECK_FALSE(dem.block_touched(dem.slot(0, 4)));
  dem.clear_touched();
  CHECK_FALSE(dem.touched(dem.slot(0, 8)));
  CHECK_FALSE(dem.block_touched(dem.slot(0, 8)));
}

TEST_CASE("dem: a latency found to be greater corrects heights, those of this sweep separately") {
  Map dem = make_map(moving());
  const auto add = [&](double x, float growth_m_s) {
    Point point = at(x, 0.05, 0.1);
    point.growth_m_s = growth_m_s;
    REQUIRE(dem.add(point));
  };
  const auto height_m = [&](int i) { return dem.cell(dem.slot(i, 8)).height_m; };
  add(0.05, 0.10f);
  add(0.15, 0.36f);
  add(0.15, 0.24f);  // seen twice: their mean growth counts
  dem.begin_sweep();
  add(0.25, -0.50f);
  dem.delay({0.010f, 0.004f, 0.0f}, {-2.0f, 0.5f});
  CHECK(height_m(0) == Approx(0.1 + 0.004 * 0.1).margin(1e-5));
  CHECK(height_m(1) == Approx(0.1 + 0.004 * 0.3).margin(1e-5));
  CHECK(height_m(2) == Approx(0.1 - 0.010 * 0.5).margin(1e-5));
}

Map seen_two_metres_ahead() {
  Map dem = make_map(moving());
  dem.look_from(-1.95f, 0.05f);
  return dem;
}

/// A point of the cell at (0.05, 0.05), by a tilt that turns at this rate.
void add_ahead(Map& dem, float rate_rad_s) {
  Point point = at(0.05, 0.05, 0.1);
  point.growth_m_s = -rate_rad_s * 2.0f;
  REQUIRE(dem.add(point));
}

TEST_CASE("dem: where growths of upward and downward sweeps cancel, each latency corrects by those of its direction") {
  constexpr float rate_rad_s = 0.5f;
  Map dem = seen_two_metres_ahead();
  const int slot = slot_at(dem, 0.05f, 0.05f);
  for (int point = 0; point < 3; ++point) add_ahead(dem, -rate_rad_s);
  dem.begin_sweep();
  add_ahead(dem, rate_rad_s);
  CHECK(dem.growth_m_s(slot) == Approx(0.5).margin(1e-3));
  CHECK(dem.growths_m_s(slot, {-rate_rad_s, 0.5f}).before == Approx(-0.25).margin(1e-3));
  CHECK(dem.growths_m_s(slot, {-rate_rad_s, 0.5f}).last == Approx(0.75).margin(1e-3));
  dem.delay({0.1f, -0.004f, 0.004f}, {-rate_rad_s, 0.5f});
  CHECK(dem.cell(slot).height_m == Approx(0.1 - 0.004).margin(1e-5));
  dem.begin_sweep();  // upward again
  dem.delay({0.1f, 0.004f, -0.004f}, {rate_rad_s, 0.5f});
  CHECK(dem.cell(slot).height_m == Approx(0.1 - 0.008).margin(1e-5));
}

TEST_CASE("dem: growths are divided between upward and downward sweeps, however much faster one of them is") {
  constexpr float down_rad_s = 0.25f, up_rad_s = -0.75f;
  Map dem = seen_two_metres_ahead();
  for (int point = 0; point < 3; ++point) add_ahead(dem, down_rad_s);
  add_ahead(dem, up_rad_s);
  const BySweep growth_m_s = dem.growths_m_s(slot_at(dem, 0.05f, 0.05f), {up_rad_s, 0.25f});
  CHECK(growth_m_s.now + growth_m_s.before == Approx(0.75 * -0.5).margin(1e-3));
  CHECK(growth_m_s.last == Approx(0.25 * 1.5).margin(1e-3));
}

TEST_CASE("dem: of ground that was seen upward and downward for long, a new sweep's latency moves what it saw itself") {
  constexpr float rate_rad_s = 0.5f;
  Map dem = seen_two_metres_ahead();
  for (const float rate : {1.0f, -1.0f, 1.0f, -1.0f, 1.0f, -1.0f, 1.0f, -1.0f}) add_ahead(dem, rate * rate_rad_s);
  dem.begin_sweep();
  add_ahead(dem, rate_rad_s);
  dem.delay({0.009f, 0.0f, 0.0f}, {-rate_rad_s, 0.5f});
  CHECK(dem.cell(slot_at(dem, 0.05f, 0.05f)).height_m == Approx(0.1 - 0.001).margin(1e-4));
}

TEST_CASE("dem: a lean corrects heights by how far ahead a cell's points lay when they were seen, in the mean") {
  Map dem = make_map(moving());
  dem.look_from(-1.0f, 0.05f, {0.0f, 1.0f});
  for (int k = 0; k < 3; ++k) REQUIRE(dem.add(at(0.05, 0.05, 0.1)));
  dem.look_from(-0.5f, 0.05f, {1.0f, 0.0f});  // the laser points along y
  REQUIRE(dem.add(at(0.05, 0.05, 0.1)));
  REQUIRE(dem.add(at(0.05, 0.35, 0.1)));
  const int both = slot_at(dem, 0.05f, 0.05f), second = slot_at(dem, 0.05f, 0.35f);
  CHECK(dem.ahead_m(0.05f, 0.35f) == Approx(0.3));
  CHECK(dem.farther_m(both, 0.05f, 0.05f) == Approx(0.0 - 0.75 * 1.05).margin(2e-3));
  CHECK(dem.farther_m(second, 0.05f, 0.35f) == Approx(0.0).margin(2e-3));
  dem.lean(0.01f);
  CHECK(dem.cell(both).height_m == Approx(0.1 - 0.01 * 0.75 * 1.05).margin(2e-5));
  CHECK(dem.cell(second).height_m == Approx(0.1 - 0.003).margin(2e-5));
}

TEST_CASE("dem: ground farther ahead than 30 m counts as there, for a lean as for what it is compared with") {
  Map dem = make_map(moving());
  dem.look_from(-100.0f, 0.05f);
  REQUIRE(dem.add(at(0.05, 0.05, 0.1)));
  const int slot = slot_at(dem, 0.05f, 0.05f);
  CHECK(dem.farther_m(slot, 0.05f, 0.05f) == Approx(0.0).margin(2e-3));
  dem.look_from(-20.0f, 0.05f);
  CHECK(dem.farther_m(slot, 0.05f, 0.05f) == Approx(20.05 - 30.0).margin(2e-3));
}

TEST_CASE("dem: a cell that has left the window knows nothing of how far ahead it lay") {
  Map dem = make_map(moving());
  dem.look_from(-3.0f, 0.05f);
  REQUIRE(dem.add(at(0.05, 0.05, 0.1)));
  dem.follow(standing_at(50.0f, 0.0f), [](int) {});
  dem.follow(standing_at(0.0f, 0.0f), [](int) {});
  dem.look_from(-1.0f, 0.05f);
  REQUIRE(dem.add(at(0.05, 0.05, 0.1)));
  CHECK(dem.farther_m(slot_at(dem, 0.05f, 0.05f), 0.05f, 0.05f) == Approx(0.0).margin(2e-3));
}

TEST_CASE("dem: a cell that no sweep has seen for long is of an earlier one, however many have been") {
  Map dem = make_map(moving());
  REQUIRE(dem.add(at(0.05, 0.05)));
  const int slot = slot_at(dem, 0.05f, 0.05f);
  REQUIRE_FALSE(dem.mapped_before(slot));
  for (int sweep = 1; sweep <= 300; ++sweep) {
    dem.begin_sweep();
    INFO(sweep);
    CHECK(dem.mapped_before(slot));
  }
}

TEST_CASE("dem: a cell knows from where it was seen last, in the window's frame, through sweeps and marks") {
  Map dem = make_map(moving());
  Viewpoint now{7.0f, 8.0f, 1.1f, 4.0f, 4.0f};
  now.localisation_steps = true;
  dem.look_from(-2.0f, 1.0f);
  REQUIRE(dem.add(at(0.05, 0.05)));
  CHECK_FALSE(dem.seen_from_several());
  dem.look_from(-1.0f, 1.0f);
  REQUIRE(dem.add(at(0.15, 0.05)));
  dem.begin_sweep();
  dem.begin_marking();
  dem.clear_touched();
  dem.look_from(0.0f, 1.0f);
  REQUIRE(dem.seen_from_several());
  const auto seen_from = [&](float x_m) { return dem.seen_from(slot_at(dem, x_m, 0.05f), now); };
  CHECK(seen_from(0.05f).x_m == Approx(-2.0));
  CHECK(seen_from(0.15f).x_m == Approx(-1.0));
  CHECK(seen_from(0.15f).y_m == Approx(1.0 + 0.8));
  CHECK(seen_from(0.15f).z_m == now.z_m);
  CHECK(seen_from(0.15f).end_x_m == now.end_x_m);
  CHECK(seen_from(0.15f).localisation_steps);
  REQUIRE(dem.add(at(0.05, 0.05)));
  CHECK(seen_from(0.05f).x_m == Approx(0.0));
  CHECK_FALSE(dem.mapped_before(slot_at(dem, 0.05f, 0.05f)));
  CHECK(dem.mapped_before(slot_at(dem, 0.15f, 0.05f)));
}

TEST_CASE("dem: a cell knows from where it was seen as long as it stays in a window, however much longer than wide") {
  const bool along_x = GENERATE(true, false);
  Map dem = make_map({.rows = along_x ? 12 : 4, .cols = along_x ? 4 : 12, .origin_x_m = 0.0f, .origin_y_m = 0.0f});
  const auto drive_to = [&](float m) {
    const float x_m = along_x ? m : 0.0f, y_m = along_x ? 0.0f : m;
    dem.follow(standing_at(x_m, y_m), [](int) {});
    dem.look_from(x_m, y_m);
  };
  drive_to(0.0f);
  REQUIRE(dem.add(along_x ? at(1.15, 0.05) : at(0.05, 1.15)));
  for (int k = 1; k <= 100; ++k) drive_to(0.01f * static_cast<float>(k));
  const Viewpoint from = dem.seen_from(slot_at(dem, along_x ? 1.15f : 0.05f, along_x ? 0.05f : 1.15f), {});
  CHECK((along_x ? from.x_m + dem.origin_x_m() : from.y_m + dem.origin_y_m()) == Approx(0.0).margin(0.05));
}

TEST_CASE("dem: ground from before marking began is found along rows and columns, the nearest first") {
  Map dem = make_map(moving());
  const auto nearest = [&](float x_m, float y_m, int reach) {
    const auto place = dem.nearest_unmarked(dem.place_at(x_m, y_m), reach);
    return place.inside() ? dem.slot(place.i, place.j) : -1;
  };
  REQUIRE(dem.add(at(0.05, 0.05)));
  REQUIRE(dem.add(at(0.35, 0.25)));
  const int corner = slot_at(dem, 0.05f, 0.05f), further = slot_at(dem, 0.35f, 0.25f);
  dem.begin_marking();
  REQUIRE(dem.add(at(0.15, 0.05)));
  CHECK(nearest(0.05f, 0.05f, 0) == corner);
  CHECK(nearest(0.15f, 0.05f, 1) == corner);
  CHECK(nearest(0.35f, 0.05f, 3) == further);  // two cells away, not three
  CHECK(nearest(0.35f, 0.05f, 1) == -1);
  dem.begin_sweep();
  CHECK(nearest(0.15f, 0.05f, 0) == -1);  // marks outlast a sweep
  REQUIRE(dem.add(at(0.05, 0.05)));
  CHECK(nearest(0.05f, 0.05f, 0) == -1);
  dem.begin_marking();
  CHECK(nearest(0.15f, 0.05f, 0) == slot_at(dem, 0.15f, 0.05f));
}

TEST_CASE("dem: ground that changes is known again as soon after a day as after a minute") {
  Map dem = make_map(moving());
  const auto see = [&](int points, double height_m) {
    for (int k = 0; k < points; ++k) REQUIRE(dem.add(at(0.05, 0.05, height_m + (k % 2 == 0 ? 0.01 : -0.01))));
  };
  const Cell& cell = dem.cell(slot_at(dem, 0.05f, 0.05f));
  see(1'000'000, 0.0);
  CHECK(cell.height_m == Approx(0.0).margin(1e-4));
  CHECK(cell.variance_m2({0.0f, 0.0f}) == Approx(0.8e-4).epsilon(0.01));  // each point weighs 0.8
  see(2'000, 0.05);  // a plank is laid down, less than the spread by which a cell has two surfaces
  CHECK(cell.height_m == Approx(0.05).margin(0.002));
}

TEST_CASE("dem: a cell that comes into the window has no growth left of the one that was in its place") {
  Map dem = make_map(moving());
  Point point = at(0.05, 0.05);
  point.growth_m_s = 2.0f;
  REQUIRE(dem.add(point));
  const int slot = slot_at(dem, 0.05f, 0.05f);
  dem.follow(standing_at(4.8f, 0.0f), [](int) {});
  REQUIRE(slot_at(dem, 4.85f, 0.05f) == slot);
  CHECK(dem.growth_m_s(slot) == 0.0f);
}

TEST_CASE("dem: the mean growth of many points follows what little each of them changes") {
  Map dem = make_map(moving());
  test::Noise lot(3);
  const auto add = [&](int points, float growth_m_s) {
    for (int k = 0; k < points; ++k) {
      Point point = at(0.05, 0.05, 0.01 * lot.normal());
      point.growth_m_s = growth_m_s;
      REQUIRE(dem.add(point));
    }
  };
  add(400, 1.0f);
  add(2000, 0.8f);
  CHECK(dem.growth_m_s(slot_at(dem, 0.05f, 0.05f)) == Approx(0.804).margin(0.02));
}

TEST_CASE("dem: a point that float cannot weigh against others is not taken") {
  Map dem = make_map(moving());
  CHECK_FALSE(dem.add(at(0.05, 0.05, 0.0, 1e38f)));
  CHECK_FALSE(dem.add(at(0.05, 0.05, 0.0, 1e6f)));
  CHECK(dem.add(at(0.05, 0.05, 0.0, 1.0f)));
}

TEST_CASE("dem: a growth that no servo makes is not kept") {
  Map dem = make_map(moving());
  Point point = at(0.05, 0.05);
  point.growth_m_s =
      GENERATE(1e6f, -1e6f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN());
  REQUIRE(dem.add(point));
  CHECK(dem.growth_m_s(slot_at(dem, 0.05f, 0.05f)) == 0.0f);
}

TEST_CASE("dem: a window smaller than its limits uses the rows and columns it was given") {
  Map dem = make_map({.rows = 8, .cols = 4, .origin_x_m = 0.0f, .origin_y_m = 0.0f});
  dem.follow(standing_at(1.2f, 0.4f), [](int) {});
  fill_names(dem);
  CHECK(picture(dem) == "####\n####\n####\n####\n####\n####\n####\n####\n");
  dem.follow(standing_at(1.6f, 0.4f), [](int) {});
  CHECK(picture(dem) == "####\n####\n####\n####\n....\n....\n....\n....\n");
}

/// Calls visit(dem) for windows as large as the limits and smaller ones, with various starts of their rings. About
/// every second cell is valid.
template <typename Visit>
void for_each_ring(Visit&& visit) {
  test::Noise noise(5);
  for (const auto& [rows, cols] : {std::pair{12, 16}, {8, 12}, {4, 4}}) {
    for (int blocks_x = -3; blocks_x <= 3; ++blocks_x) {
      for (int blocks_y = -4; blocks_y <= 4; ++blocks_y) {
        Map dem = make_map({.rows = rows, .cols = cols, .origin_x_m = 0.0f, .origin_y_m = -0.8f});
        dem.follow(standing_at(0.4f * static_cast<float>(blocks_x), 0.4f * static_cast<float>(blocks_y)), [](int) {});
        for (int n = 0; n < rows * cols; ++n) {
          const double i = rows * noise.uniform(), j = cols * noise.uniform();
          dem.add(at(static_cast<double>(dem.origin_x_m()) + 0.1 * i, static_cast<double>(dem.origin_y_m()) + 0.1 * j));
        }
        INFO(rows << " x " << cols << " moved by " << blocks_x << ", " << blocks_y);
        visit(std::as_const(dem));
      }
    }
  }
}

TEST_CASE("dem: along a row or a column the valid cells are visited in order, wherever the ring begins") {
  for_each_ring([](const Map& dem) {
    for (const int axis : {0, 1}) {
      const bool along_x = axis == 0;
      for (int line = 0; line < (along_x ? dem.cols() : dem.rows()); ++line) {
        std::vector<std::pair<int, int>> expected, visited;
        for (int k = 0; k < (along_x ? dem.rows() : dem.cols()); ++k) {
          const int slot = along_x ? dem.slot(k, line) : dem.slot(line, k);
          if (dem.cell(slot).valid()) expected.emplace_back(k, slot);
        }
        dem.for_each_valid_along(axis, line, [&](int k, int slot) { visited.emplace_back(k, slot); });
        REQUIRE(visited == expected);
      }
    }
  });
}

TEST_CASE("dem: the cells of a block are found from its first, wherever the ring begins") {
  for_each_ring([](const Map& dem) {
    for (int i = 0; i < dem.rows(); i += block_side) {
      for (int j = 0; j < dem.cols(); j += block_side) {
        for (int k = 0; k < block_side * block_side; ++k)
          REQUIRE(Map::slot_in_block(dem.slot(i, j), k) == dem.slot(i + k / block_side, j + k % block_side));
      }
    }
  });
}

TEST_CASE("dem: every point that is taken lies in the surroundings, of the smallest cells far away too") {
  const auto [origin_m, cell_m] =
      GENERATE(table<float, float>({{0.0f, 0.1f}, {-0.8f, 0.1f}, {1e5f, 0.001f}, {-1e5f, 0.001f}, {1e5f, 0.03f}}));
  const auto [rows, cols] = GENERATE(table<int, int>({{12, 16}, {8, 12}}));
  const float moved = GENERATE(0.0f, 1.0f, -2.0f);
  Map dem = make_map(
      {.rows = rows, .cols = cols, .cell_x_m = cell_m, .cell_y_m = cell_m, .origin_x_m = origin_m, .origin_y_m = 0.0f});
  dem.follow(standing_at(moved * block_side * cell_m, -moved * block_side * cell_m), [](int) {});
  const Bounds around = dem.surroundings();
  // Around both ends of the window, and in between.
  const auto places_m = [](float low_m, float high_m) {
    std::vector<float> out;
    for (const float end_m : {low_m, high_m}) {
      float below_m = end_m, above_m = end_m;
      for (int n = 0; n < 6; ++n) {
        out.insert(out.end(), {below_m, above_m});
        below_m = std::nextafter(below_m, -infinity), above_m = std::nextafter(above_m, infinity);
      }
    }
    for (int n = 1; n < 8; ++n) out.push_back(low_m + 0.125f * static_cast<float>(n) * (high_m - low_m));
    return out;
  };
  int taken = 0;
  for (const float x_m : places_m(dem.origin_x_m(), dem.origin_x_m() + static_cast<float>(rows) * cell_m)) {
    for (const float y_m : places_m(dem.origin_y_m(), dem.origin_y_m() + static_cast<float>(cols) * cell_m)) {
      for (const float shift_m : {0.0f, 0.6f * cell_m, -0.6f * cell_m}) {
        Point point{x_m, y_m, 0.0f, 1e-4f};
        point.shift_x_m = shift_m, point.shift_y_m = -shift_m;
        if (!dem.add(point)) continue;
        ++taken;
        REQUIRE(around.hold(point.place_x_m(), point.place_y_m(), point.z_m));
      }
    }
  }
  CHECK(taken > 100);
}

TEST_CASE("dem: level cells are kept whole from sweep to sweep, changed ones by a quarter") {
  const auto points_after = [](float second_m) {
    Map dem = make_map(moving());
    const int s = slot_at(dem, 0.55f, 0.05f);
    for (int k = 0; k < 8; ++k) REQUIRE(dem.add(at(0.55, 0.05, k % 2 == 0 ? 0.0 : static_cast<double>(second_m))));
    dem.begin_sweep();
    REQUIRE(dem.add(at(0.55, 0.05, 0.0)));
    REQUIRE(dem.add(at(0.55, 0.05, 0.0)));
    return dem.cell(s).points;
  };
  CHECK(points_after(0.01f) == 10.0f);
  CHECK(points_after(0.2f) == Approx(2.0 + 2.0));
}

TEST_CASE("dem: a cell holds more than a plane by what its heights spread beyond noise, never by how little they do") {
  const auto mixed = [](double sd, double slope_m2) {
    Map dem = make_map(moving());
    for (int k = 0; k < 20; ++k) REQUIRE(dem.add(at(0.55, 0.05, k % 2 == 0 ? -sd : sd)));
    return dem.mixed(dem.cell(slot_at(dem, 0.55f, 0.05f)), static_cast<float>(slope_m2));
  };
  CHECK_FALSE(mixed(0.0, 0.0));
  CHECK_FALSE(mixed(0.011, 0.0));
  CHECK(mixed(0.02, 0.0));
  CHECK_FALSE(mixed(0.02, 4e-4));  // as much as the plane's slope causes
}

TEST_CASE("dem: what lies beyond the window's end is not found on its other side") {
  const auto found = [](double x, double y, double from_x, double from_y) {
    Map dem = make_map(moving());
    REQUIRE(dem.add(at(x, y)));
    dem.begin_marking();
    return dem.nearest_unmarked(dem.place_at(static_cast<float>(from_x), static_cast<float>(from_y)), 5).inside();
  };
  CHECK(found(0.35, 0.05, 0.05, 0.05));
  CHECK_FALSE(found(1.15, 0.05, 0.05, 0.05));
  CHECK_FALSE(found(0.05, 0.05, 1.15, 0.05));
  CHECK_FALSE(found(0.05, 0.75, 0.05, -0.75));
  CHECK_FALSE(found(0.05, -0.75, 0.05, 0.75));
}

}  // namespace
}  // namespace curbline
