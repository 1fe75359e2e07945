#include "curbline/bend.hpp"

#include "curbline/math.hpp"

namespace curbline {

void BendTally::add(PlaneMoments cell, const Plane& plane, float mean_m2) {
  const float along_m = (cell.x - plane.x_m) * bend_.dx + (cell.y - plane.y_m) * bend_.dy;
  cell.z -= plane.height_m(cell.x, cell.y);
  cell.x = along_m;
  cell.y = square(along_m) - mean_m2;
  residuals_.add(cell);
}

}  // namespace curbline
