#include "reference/border.hpp"

#include <cmath>

namespace curbline::tools::reference {
namespace {

double step(const MapPlane& low, const MapPlane& high, double x, double y) {
  return high.height_m(x, y) - low.height_m(x, y);
}

/// Labels on the low and the high side of a border along `axis`, -1 for none.
struct Sides {
  int low = -1, high = -1;
  bool operator==(const Sides&) const = default;
  bool border() const { return low != high; }
};

/// Sides of the border between cell (i, j) and the next along x (axis 0) or y.
Sides sides(const Map& map, int i, int j, int axis) {
  const MapCell& a = map.cells[map.grid.at(i, j)];
  const MapCell& b = map.cells[axis == 0 ? map.grid.at(i + 1, j) : map.grid.at(i, j + 1)];
  return a.points > 0 && b.points > 0 ? Sides{a.label, b.label} : Sides{};
}

MapCurb make_curb(const Map& map, const Sides& sides, int axis, MapCurb curb) {
  curb.height_sd_m = curb.probability = 1;
  curb.kind = "crease";
  const MapPlane* low = plane_of(map, sides.low);
  const MapPlane* high = plane_of(map, sides.high);
  if (low == nullptr || high == nullptr) return curb;
  const double x = 0.5 * (curb.x0_m + curb.x1_m), y = 0.5 * (curb.y0_m + curb.y1_m);
  const double step_m = step(*low, *high, x, y);
  curb.height_m = (axis == 0 ? x : y) >= 0 ? step_m : -step_m;  // the side nearer to the origin is the near side
  curb.height_sd_m = std::hypot(low->sd_m, high->sd_m);
  // Planes that meet between the centres of the cells make a fold, wherever within the cells they do.
  const double dx = axis == 0 ? 0.5 * map.grid.dx_m : 0, dy = axis == 0 ? 0 : 0.5 * map.grid.dy_m;
  const bool meet = step(*low, *high, x - dx, y - dy) * step(*low, *high, x + dx, y + dy) <= 0;
  if (!meet && std::abs(step_m) > 2 * curb.height_sd_m) curb.kind = curb.height_m > 0 ? "step_up" : "step_down";
  return curb;
}

}  // namespace

MapCurb border_run(const Grid& g, int axis, int line, int first, int end) {
  if (axis == 0) {
    const double x = g.x0_m + (line + 1) * g.dx_m;
    return {x, g.y0_m + first * g.dy_m, x, g.y0_m + end * g.dy_m};
  }
  const double y = g.y0_m + (line + 1) * g.dy_m;
  return {g.x0_m + first * g.dx_m, y, g.x0_m + end * g.dx_m, y};
}

std::vector<MapCurb> borders(const Map& map) {
  const Grid& g = map.grid;
  std::vector<MapCurb> out;
  for (int axis = 0; axis < 2; ++axis) {
    const int lines = (axis == 0 ? g.rows : g.cols) - 1, length = axis == 0 ? g.cols : g.rows;
    for (int line = 0; line < lines; ++line) {
      const auto at = [&](int k) {
        return k >= length ? Sides{} : axis == 0 ? sides(map, line, k, 0) : sides(map, k, line, 1);
      };
      for (int first = 0; first < length;) {
        const Sides here = at(first);
        int end = first + 1;
        while (end < length && at(end) == here) ++end;
        if (here.border()) out.push_back(make_curb(map, here, axis, border_run(g, axis, line, first, end)));
        first = end;
      }
    }
  }
  return out;
}

}  // namespace curbline::tools::reference
