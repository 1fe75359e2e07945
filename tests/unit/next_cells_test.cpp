// How far it is from cell to cell.
#include "curbline/map/next_cells.hpp"

#include <catch2/catch.hpp>
#include <set>

namespace curbline {
namespace {

constexpr Limits limits{.rows = 20, .cols = 4};

TEST_CASE("next cells: a cell that comes between two is the next of both, and one that leaves is none") {
  Window<limits> window;
  window.init({.rows = 20, .cols = 4});
  NextCells<limits> next;
  next.init();
  std::set<int> valid;
  const auto enter = [&](int i, int j) {
    next.enter(window, i, j, [&](int slot) { return valid.contains(slot); });
    valid.insert(window.slot(i, j));
  };
  constexpr int plus_x = 0, minus_x = 1, plus_y = 2;
  const int near = window.slot(2, 1), far = window.slot(8, 1);
  enter(2, 1);
  CHECK(next.distance(near, plus_x, max_link_reach) == 0);
  enter(8, 1);
  CHECK(next.distance(near, plus_x, 6) == 6);
  CHECK(next.distance(far, minus_x, 6) == 6);
  CHECK(next.distance(far, minus_x, 5) == 0);
  enter(5, 1);
  CHECK(next.distance(near, plus_x, max_link_reach) == 3);
  CHECK(next.distance(far, minus_x, max_link_reach) == 3);
  CHECK(next.distance(near, plus_y, max_link_reach) == 0);
  next.leave(window, window.slot(5, 1));
  CHECK(next.distance(near, plus_x, max_link_reach) == 0);  // what lies beyond leaves with it
  CHECK(next.distance(far, minus_x, max_link_reach) == 0);
}

}  // namespace
}  // namespace curbline
