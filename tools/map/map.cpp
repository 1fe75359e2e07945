#include "map/map.hpp"

namespace curbline::tools {

MapCurb part_of(const MapCurb& curb, const Share& share) {
  const double dx = curb.x1_m - curb.x0_m, dy = curb.y1_m - curb.y0_m;
  MapCurb part = curb;
  part.x0_m = curb.x0_m + share.from * dx;
  part.y0_m = curb.y0_m + share.from * dy;
  part.x1_m = curb.x0_m + share.to * dx;
  part.y1_m = curb.y0_m + share.to * dy;
  return part;
}

const MapPlane* plane_of(const Map& map, int label) {
  for (const MapPlane& plane : map.planes) {
    if (plane.label == label) return &plane;
  }
  return nullptr;
}

}  // namespace curbline::tools
