// The shadow of a step down. A ray that grazes its edge, `above` below the laser and `away` from it, meets the lower
// plane farther away by drop / above of that. A vertical face lies wholly in the shadow, at its near end; so does any
// that falls more steeply than the ray. Points are seen between the planes all the same: readings that mix both, on the
// ray, as if the face were as wide as the shadow. Of the points that both planes would hold, as many are missing as
// the shadow is wide, whether a face is hidden or seen: a step down is always taken to stand at the near end. Of a face
// that is seen, wider than its shadow, that is half a shadow before the middle, and still on the face. Cost: 30
// operations a curb; a pure function.
#pragma once

#include "curbline/line_fit.hpp"
#include "curbline/point.hpp"

namespace curbline {

struct Shadow {
  float drop_m;   ///< of the step
  float above_m;  ///< the laser, above the upper plane
  float gap_m;    ///< between the planes as they are seen: no shadow is wider
};

/// Moves a line from the middle of a shadow to the edge that casts it, and returns how wide the shadow is. 0, and the
/// line stays, unless the laser is above the upper plane by more than the drop: a robot's is, and a cloud whose heights
/// are not from its laser tells nothing of shadows.
float move_before_shadow(LineFit::Segment& line, const Viewpoint& view, const Shadow& shadow);

}  // namespace curbline
