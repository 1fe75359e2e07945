// The curb ahead: of all curbs the one that a robot meets first, for a controller that brakes or lifts its wheels. As a
// CAN frame: can/curb_frames.hpp. A function without state: may be called from anywhere.
#pragma once

#include <optional>
#include <span>

#include "curbline/curbs/curb.hpp"
#include "curbline/pose.hpp"

namespace curbline {

/// At its nearest point, in the base frame, x ahead and y left.
struct CurbAhead {
  float distance_m = 0.0f, lateral_m = 0.0f;
  float height_m = 0.0f, height_sd_m = 0.0f;
  CurbKind kind = CurbKind::crease;
  float probability = 0.0f;
};

/// The curb that a robot at `pose` meets first if it drives straight on; curbs are in the map frame. Of those that
/// reach into x >= 0 of its base frame, within half_width_m to either side, it is the one whose nearest point there has
/// the lowest x. Steps come before creases: the gutter before a curb does not hide it. O(curbs).
///
/// Nothing means that there is no curb, not that the way is clear: a wall, a step up higher than
/// CurbSettings::max_step_m (0.3 m) and ground that was not seen give nothing. Whether a robot may drive there,
/// Pipeline::passable() tells, cell by cell.
std::optional<CurbAhead> nearest_ahead(std::span<const Curb> curbs, const Pose& pose, float half_width_m);

}  // namespace curbline
