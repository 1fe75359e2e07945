#include "curbline/curbs/passability.hpp"

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

}  // namespace curbline
