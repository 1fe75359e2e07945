#include "map/left_behind.hpp"

#include <algorithm>
#include <cmath>

namespace curbline::tools {
namespace {

/// A side of what is still ahead, when the window's side has moved. Behind the window that begins a cell inside it: a
/// curb has ground on both sides, and is lost when one side is. Where the window comes back, curbs are found anew.
double ahead(double side, double before, double now, double inward) {
  if (now == before) return side;
  const bool leaves = (now > before) == (inward > 0);
  return leaves ? now + inward : std::copysign(LeftBehind::infinite, -inward);
}

}  // namespace

void LeftBehind::follow(const Grid& grid, std::span<const MapCurb> last_found) {
  if (grid.x0_m == grid_.x0_m && grid.y0_m == grid_.y0_m) return;
  const Bounds from = grid_.bounds(), to = grid.bounds(), before = ahead_;
  grid_ = grid;
  ahead_ = {ahead(before.x0, from.x0, to.x0, grid.dx_m), ahead(before.y0, from.y0, to.y0, grid.dy_m),
            ahead(before.x1, from.x1, to.x1, -grid.dx_m), ahead(before.y1, from.y1, to.y1, -grid.dy_m)};
  for (const MapCurb& c : last_found) {
    const Point2 start{c.x0_m, c.y0_m}, end{c.x1_m, c.y1_m};
    const Share unkept = share_in(before, start, end), still = share_in(ahead_, start, end);
    keep(c, unkept.from, still.any() ? std::min(unkept.to, still.from) : unkept.to);
    if (still.any()) keep(c, std::max(unkept.from, still.to), unkept.to);
  }
}

/// Unless the part is too short for a row of cells.
void LeftBehind::keep(const MapCurb& curb, double from, double to) {
  const double length_m = std::hypot(curb.x1_m - curb.x0_m, curb.y1_m - curb.y0_m);
  if ((to - from) * length_m > 0.25 * grid_.dx_m) curbs_.push_back(part_of(curb, {from, to}));
}

}  // namespace curbline::tools
