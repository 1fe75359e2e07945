// The curb ahead: of all curbs the one that a robot meets first. For those that brake or lift; as a CAN frame:
// can/curb_frames.hpp. Pure, no state: may be called from anywhere.
#pragma once

#include <optional>
#include <span>

#include "curbline/curbs/curb.hpp"
#include "curbline/pose.hpp"

namespace curbline {

/// Where it is nearest, in the base frame, x ahead and y left.
struct CurbAhead {
  float distance_m = 0.0f, lateral_m = 0.0f;
  float height_m = 0.0f, height_sd_m = 0.0f;
  CurbKind kind = CurbKind::crease;
  float probability = 0.0f;
};

/// The curb that a robot at a pose meets first when it drives straight on, curbs being in the map frame: in its base
/// frame, of those that reach into x >= 0 within half_width_m to either side, the one whose nearest point there has the
/// lowest x. A step before what is none: the gutter before a kerb does not hide it. O(curbs).
std::optional<CurbAhead> nearest_ahead(std::span<const Curb> curbs, const Pose& pose, float half_width_m);

}  // namespace curbline
