// The shadow of a step down. A ray that grazes its edge, `above` below the laser and `away` from it, meets the lower
// plane farther by the share drop / above of `away`. A vertical face lies wholly in the shadow, at its near end; so
// does any that falls more steeply than the ray. There are points between the planes all the same: readings that mix
// both, on the ray, as if the face were as wide as the shadow. Either way, face hidden or in view, as many points are
// missing as the shadow is wide, so a step down is always placed at the near end. For a face in view, wider than its
// shadow, that is half a shadow before its middle, and still on the face. Cost: 30 operations a curb; a function
// without state.
#pragma once

#include "curbline/curbs/line_fit.hpp"
#include "curbline/point.hpp"

namespace curbline {

struct Shadow {
  float drop_m;   ///< of the step
  float above_m;  ///< the laser, above the upper plane
  float gap_m;    ///< between the planes as seen: no shadow is wider
};

/// Moves a line from the middle of a shadow to the edge that casts it, and returns the shadow's width. Returns 0 and
/// leaves the line unless the laser is above the upper plane by more than the drop, or than any curb is high: a robot's
/// is, and a cloud whose origin is not its laser shows no shadows.
float move_before_shadow(LineFit::Segment& line, const Viewpoint& view, const Shadow& shadow);

}  // namespace curbline
