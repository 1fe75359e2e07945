// When and from where cells were last seen.
#include "curbline/map/last_seen.hpp"

#include <catch2/catch.hpp>

namespace curbline {
namespace {

constexpr Limits limits{.rows = 8, .cols = 8};

TEST_CASE("last seen: sweeps, marks and what was followed begin anew each by itself") {
  LastSeen<limits> cells;
  cells.init(4.0f);
  cells.look_from(0.0f, 0.0f);
  CHECK_FALSE(cells.any_touched());
  cells.touch(9);
  CHECK((cells.touched(9) && cells.in_this_sweep(9) && cells.marked(9)));
  CHECK_FALSE((cells.touched(8) || cells.in_this_sweep(8) || cells.marked(8)));
  cells.begin_sweep();
  CHECK((cells.touched(9) && !cells.in_this_sweep(9) && cells.marked(9)));
  cells.begin_marking();
  CHECK((cells.touched(9) && !cells.marked(9)));
  cells.clear_touched();
  CHECK_FALSE((cells.touched(9) || cells.any_touched()));
  cells.touch(9);
  CHECK((cells.touched(9) && cells.in_this_sweep(9) && cells.marked(9) && cells.any_touched()));
}

TEST_CASE("last seen: a block has changed if any of its cells has") {
  for (int k = 0; k < block_side * block_side; ++k) {
    LastSeen<limits> cells;
    cells.init(4.0f);
    const int first = block_side;
    cells.touch(Window<limits>::slot_in_block(first, k));
    CHECK(cells.block_touched(first));
    CHECK_FALSE(cells.block_touched(0));
  }
}

TEST_CASE("last seen: a cell keeps the place from which it was seen, whatever begins anew") {
  LastSeen<limits> cells;
  cells.init(4.0f);
  cells.look_from(-2.0f, 1.0f);
  cells.touch(3);
  CHECK_FALSE(cells.from_several());
  cells.look_from(-1.0f, 1.0f);
  cells.begin_sweep();
  cells.begin_marking();
  cells.clear_touched();
  CHECK(cells.from_several());
  CHECK(cells.from(3).x_m == -2.0f);
  cells.touch(3);
  CHECK(cells.from(3).x_m == -1.0f);
  CHECK(cells.from(3).y_m == 1.0f);
}

}  // namespace
}  // namespace curbline
