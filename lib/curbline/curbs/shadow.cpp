#include "curbline/curbs/shadow.hpp"

#include <algorithm>

#include "curbline/math.hpp"
#include "curbline/planes/obstacles.hpp"

namespace curbline {

float move_before_shadow(LineFit::Segment& line, const Viewpoint& view, const Shadow& shadow) {
  if (!(shadow.above_m > std::min(shadow.drop_m, highest_step_m))) return 0.0f;
  const float away_m = line.normal_x * (0.5f * (line.x0_m + line.x1_m) - view.x_m) +
                       line.normal_y * (0.5f * (line.y0_m + line.y1_m) - view.y_m);
  // The edge is away_m / (1 + drop / (2 above)) away.
  const float seen_m = away_m * shadow.drop_m / (shadow.above_m + 0.5f * shadow.drop_m);
  const float width_m = std::clamp(seen_m, -shadow.gap_m, shadow.gap_m);
  line.x0_m -= 0.5f * width_m * line.normal_x;
  line.y0_m -= 0.5f * width_m * line.normal_y;
  line.x1_m -= 0.5f * width_m * line.normal_x;
  line.y1_m -= 0.5f * width_m * line.normal_y;
  return magnitude(width_m);
}

}  // namespace curbline
