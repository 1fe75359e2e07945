#include "curbline/curbs/curb_ahead.hpp"

#include "curbline/frames.hpp"
#include "curbline/math.hpp"

namespace curbline {
namespace {

struct At {
  float x_m, y_m;
};

/// Clips a segment to where a distance, linear along it and given at both ends, is at least 0. False if nothing is
/// left.
bool keep_side(At& a, At& b, float distance_a, float distance_b) {
  if (!(distance_a >= 0.0f) && !(distance_b >= 0.0f)) return false;
  const float part = distance_a / (distance_a - distance_b);  // of the way from a, if the ends are on different sides
  const At crossing{a.x_m + part * (b.x_m - a.x_m), a.y_m + part * (b.y_m - a.y_m)};
  if (!(distance_a >= 0.0f)) a = crossing;
  if (!(distance_b >= 0.0f)) b = crossing;
  return true;
}

}  // namespace

std::optional<CurbAhead> nearest_ahead(std::span<const Curb> curbs, const Pose& pose, float half_width_m) {
  const SinCos ahead = heading(make_transform(pose));
  const auto in_base = [&](float x_m, float y_m) {
    const float dx = x_m - pose.x_m, dy = y_m - pose.y_m;
    return At{ahead.cos * dx + ahead.sin * dy, ahead.cos * dy - ahead.sin * dx};
  };
  std::optional<CurbAhead> nearest;
  for (const bool steps : {true, false}) {
    for (const Curb& curb : curbs) {
      if (is_step(curb) != steps) continue;
      At a = in_base(curb.x0_m, curb.y0_m), b = in_base(curb.x1_m, curb.y1_m);
      const bool on_the_way = keep_side(a, b, a.x_m, b.x_m) &&
                              keep_side(a, b, half_width_m - a.y_m, half_width_m - b.y_m) &&
                              keep_side(a, b, half_width_m + a.y_m, half_width_m + b.y_m);
      const At& at = a.x_m <= b.x_m ? a : b;
      if (!on_the_way || (nearest && nearest->distance_m <= at.x_m)) continue;
      nearest = CurbAhead{at.x_m, at.y_m, curb.height_m, curb.height_sd_m, curb.kind, curb.probability};
    }
    if (nearest) break;
  }
  return nearest;
}

}  // namespace curbline
