#include <cmath>

#include "peers/peers.hpp"
#include "reference/border.hpp"

namespace curbline::tools::peers {
namespace {

/// Height of the cell after a border minus that of the cell before it, 0 if that is not a curb.
double step_m(const reference::Dem& dem, int i, int j, int axis) {
  const reference::DemCell& a = dem.cells[dem.grid.at(i, j)];
  const reference::DemCell& b = dem.cells[axis == 0 ? dem.grid.at(i + 1, j) : dem.grid.at(i, j + 1)];
  if (a.points == 0 || b.points == 0) return 0;
  const double step = b.height_m - a.height_m;
  return std::abs(step) >= least_step_m && std::abs(step) <= most_step_m ? step : 0;
}

}  // namespace

std::vector<MapCurb> gradient_curbs(const reference::Dem& dem) {
  const Grid& g = dem.grid;
  std::vector<MapCurb> out;
  for (int axis = 0; axis < 2; ++axis) {
    const int lines = (axis == 0 ? g.rows : g.cols) - 1, length = axis == 0 ? g.cols : g.rows;
    for (int line = 0; line < lines; ++line) {
      const auto at = [&](int k) { return axis == 0 ? step_m(dem, line, k, 0) : step_m(dem, k, line, 1); };
      for (int first = 0; first < length;) {
        const double here = at(first);
        double sum = here;
        int end = first + 1;
        for (; end < length && at(end) * here > 0; ++end) sum += at(end);
        if (here != 0) {
          MapCurb curb = reference::border_run(g, axis, line, first, end);
          const double across = axis == 0 ? curb.x0_m : curb.y0_m;
          curb.height_m = (across >= 0 ? sum : -sum) / (end - first);  // the side nearer to the origin is the near side
          curb.probability = 1;
          curb.kind = curb.height_m > 0 ? "step_up" : "step_down";
          out.push_back(curb);
        }
        first = end;
      }
    }
  }
  return out;
}

}  // namespace curbline::tools::peers
