// Faces of steps that lean, as those of splayed and battered curbs: they are regions of a scene, but no ground.
#pragma once

#include "simulator/boundary.hpp"

#include <vector>

namespace curbline::tools {

/// For each region whether it is a face: at 45 degrees or steeper, and, as far as it is visible, no wider than a curb
/// stone. (A wider one is higher than any step: a bank.)
std::vector<bool> faces_of(const std::vector<GroundRegion>& regions, const std::vector<Boundary>& pieces);

/// The pieces between regions that are no faces: where two such regions meet, and the middle line of each face that
/// parts two. A face's short ends are left out.
std::vector<Boundary> across_faces(const std::vector<GroundRegion>& regions, const std::vector<Boundary>& pieces,
                                   const std::vector<bool>& faces);

}  // namespace curbline::tools
