#include "map/map.hpp"

#include <cmath>

namespace curbline::tools {

bool is_step(const MapCurb& curb) {
  return curb.kind.starts_with("step");
}

MapCurb part_of(const MapCurb& curb, const Share& share) {
  const double dx = curb.x1_m - curb.x0_m, dy = curb.y1_m - curb.y0_m;
  MapCurb part = curb;
  part.x0_m = curb.x0_m + share.from * dx;
  part.y0_m = curb.y0_m + share.from * dy;
  part.x1_m = curb.x0_m + share.to * dx;
  part.y1_m = curb.y0_m + share.to * dy;
  const double off = 0.5 * (share.from + share.to) - 0.5;  // of its middle from the curb's middle
  part.height_m = curb.height_m + off * curb.rise_m;
  part.height_sd_m = std::hypot(curb.height_sd_m, off * curb.rise_sd_m);
  part.position_sd_m = curb.position_sd_m * std::sqrt(1 + 12 * off * off);  // as for a fitted line
  part.rise_m = (share.to - share.from) * curb.rise_m;
  part.rise_sd_m = (share.to - share.from) * curb.rise_sd_m;
  if (is_step(curb)) part.kind = part.height_m < 0 ? "step_down" : "step_up";
  return part;
}

const MapPlane* plane_of(const Map& map, int label) {
  for (const MapPlane& plane : map.planes) {
    if (plane.label == label) return &plane;
  }
  return nullptr;
}

void move(Map& map, const Point3& by) {
  map.grid.x0_m += by.x;
  map.grid.y0_m += by.y;
  for (MapCell& cell : map.cells) {
    cell.x_m += by.x;
    cell.y_m += by.y;
    cell.height_m += by.z;
  }
  for (MapPlane& plane : map.planes) plane.z0_m += by.z - plane.sx * by.x - plane.sy * by.y;
  for (MapCurb& curb : map.curbs) {
    curb.x0_m += by.x;
    curb.y0_m += by.y;
    curb.x1_m += by.x;
    curb.y1_m += by.y;
  }
}

}  // namespace curbline::tools
