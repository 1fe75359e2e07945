#include "curbline/curbs/passability.hpp"

#include <algorithm>

#include "curbline/math.hpp"

namespace curbline {

bool passable(const Plane& plane, const Mobility& mobility) {
  const SinCos most = sin_cos(mobility.max_slope_rad);
  const float slope2 = plane.slope_x * plane.slope_x + plane.slope_y * plane.slope_y;
  return plane.alive() && slope2 * most.cos * most.cos <= most.sin * most.sin;
}

bool passable(const Curb& curb, const Plane& near, const Plane& far, const Mobility& mobility) {
  if (!is_step(curb)) return passable(near, mobility) && passable(far, mobility);
  return magnitude(curb.height_m) + 2.0f * curb.height_sd_m <= mobility.max_step_m;
}

/// By the axes along which two convex shapes can be apart (separating axis theorem). The deviation of a line's place
/// grows from its middle to its ends, where it is twice as large.
bool crosses(const Curb& curb, float x_m, float y_m, float half_x_m, float half_y_m) {
  const float dx_m = 0.5f * (curb.x1_m - curb.x0_m), dy_m = 0.5f * (curb.y1_m - curb.y0_m);
  const float to_x_m = curb.x0_m + dx_m - x_m, to_y_m = curb.y0_m + dy_m - y_m;
  const float half_m2 = square(dx_m) + square(dy_m), along_m2 = to_x_m * dx_m + to_y_m * dy_m;
  const float along = half_m2 > 0.0f ? std::min(1.0f, magnitude(along_m2) / half_m2) : 0.0f;  // of half the piece
  const float beside_m = 2.0f * curb.position_sd_m * square_root(1.0f + 3.0f * square(along));
  return magnitude(to_x_m) <= half_x_m + magnitude(dx_m) + beside_m &&
         magnitude(to_y_m) <= half_y_m + magnitude(dy_m) + beside_m &&
         magnitude(dx_m * to_y_m - dy_m * to_x_m) <=
             half_x_m * magnitude(dy_m) + half_y_m * magnitude(dx_m) + beside_m * square_root(half_m2);
}

}  // namespace curbline
