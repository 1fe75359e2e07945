// Where cells lie while the window moves. What it does to their contents: dem_test.cpp.
#include "curbline/map/window.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>

namespace curbline {
namespace {

constexpr Limits limits{.rows = 16, .cols = 24, .planes = 4, .beams = 11};

/// A window whose corner is set by hand.
struct Moving : Window<limits> {
  explicit Moving(const WindowSettings& settings) { init(settings); }
  using Window::move;
  std::int32_t row = 0, col = 0;

  /// By rows and cols, both multiples of a block's side. Returns which places of the map stay: their cells' slots.
  std::map<std::pair<int, int>, int> move_by(int rows_on, int cols_on) {
    const Corner to{row + rows_on, col + cols_on};
    std::map<std::pair<int, int>, int> staying;
    for (int i = 0; i < rows(); ++i) {
      for (int j = 0; j < cols(); ++j) {
        if (row_stays(i, to) && col_stays(j, to)) staying[{row + i, col + j}] = slot(i, j);
      }
    }
    move(to);
    row = to.row;
    col = to.col;
    return staying;
  }
};

TEST_CASE("window: what a stage keeps under a cell's slot is that of the same place of the map after any move") {
  const int rows = GENERATE(16, 8), cols = GENERATE(24, 12);
  Moving window({.rows = rows, .cols = cols});
  std::mt19937 random(1);
  for (int move = 0; move < 200; ++move) {
    const int most = move % 10 == 0 ? 20 : 2;  // now and then beyond all that it holds
    std::uniform_int_distribution<int> blocks(-most, most);
    const int by_rows = blocks(random) * block_side, by_cols = blocks(random) * block_side;
    const auto staying = window.move_by(by_rows, by_cols);
    const int rows_kept = std::max(0, rows - std::abs(by_rows)), cols_kept = std::max(0, cols - std::abs(by_cols));
    CHECK(static_cast<int>(staying.size()) == rows_kept * cols_kept);
    std::set<int> slots;
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < cols; ++j) {
        slots.insert(window.slot(i, j));
        const auto kept = staying.find({window.row + i, window.col + j});
        if (kept != staying.end()) CHECK(kept->second == window.slot(i, j));
      }
    }
    CHECK(static_cast<int>(slots.size()) == rows * cols);  // no two cells share one
  }
}

TEST_CASE("window: a cell holds its near sides, not its far ones, and no place that is not a number") {
  Moving window({.rows = 16, .cols = 24, .cell_x_m = 0.25f, .cell_y_m = 0.5f});
  const auto cell = [&](float x_m, float y_m) {
    const auto place = window.place_within(x_m, y_m);
    return std::pair{place.i, place.j};
  };
  CHECK(cell(0.0f, 0.0f) == std::pair{0, 0});
  CHECK(cell(0.25f, 0.5f) == std::pair{1, 1});
  CHECK(cell(std::nextafter(0.25f, 0.0f), 0.0f) == std::pair{0, 0});
  CHECK(cell(3.99f, 11.99f) == std::pair{15, 23});
  for (const float outside : {-0.01f, 12.0f, std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
    CHECK(window.slot_within(outside, 1.0f) == -1);
    CHECK(window.slot_within(1.0f, outside) == -1);
  }
  CHECK(window.slot_within(4.0f, 1.0f) == -1);
}

}  // namespace
}  // namespace curbline
